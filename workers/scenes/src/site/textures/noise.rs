//! Seeded noise over space: gradient noise with its analytic slope (Perlin 2002; derivative after Quilez 2008), sums of
//! its octaves, and scattered dots. The lattice hash uses integers only, so it is portable.

use imaging::vectorized;

use crate::site::dots::put_dots;
use crate::site::lanes::{LANES, Lane, Lane3, clamp01, floor, mix};
use crate::site::lattice::{GRADIENT_UNIT, NoiseSample, gradient, lattice};

/// Sample points of noise. A point's noise depends on its position and footprint only.
#[derive(Clone, Copy)]
pub(crate) struct NoisePoints<'a> {
    /// Position in meters.
    pub(crate) position: &'a Lane3,
    /// Length of a pixel on the surface, m.
    pub(crate) footprint: &'a Lane,
    /// The smallest footprint.
    pub(crate) finest: f32,
}

/// Octaves of gradient noise; each has about twice the frequency and half the weight of the one before.
#[derive(Clone, Copy)]
pub(crate) struct Octaves {
    /// Lattice cells per meter of the first octave, per axis.
    pub(crate) per_meter: [f32; 3],
    pub(crate) count: usize,
    pub(crate) key: u32,
}

impl Octaves {
    /// The same frequency along every axis.
    pub(crate) fn even(per_meter: f32, count: usize, key: u32) -> Self {
        Self {
            per_meter: [per_meter; 3],
            count,
            key,
        }
    }
}

/// One octave of a sum.
#[derive(Clone, Copy)]
struct Octave {
    per_meter: [f32; 3],
    fastest: f32,
    weight: f32,
    key: u32,
}

impl NoisePoints<'_> {
    /// The sum of the octaves. An octave fades out as its cells shrink to two pixels, where it would alias.
    pub(crate) fn noise(&self, octaves: Octaves) -> NoiseSample {
        self.sum::<true>(octaves)
    }

    /// Values of [`NoisePoints::noise`] without slopes, in about half the time.
    pub(crate) fn values(&self, octaves: Octaves) -> Lane {
        self.sum::<false>(octaves).value
    }

    fn sum<const SLOPE: bool>(&self, octaves: Octaves) -> NoiseSample {
        let mut sum = NoiseSample::default();
        let (position, footprint) = (self.position, self.footprint);
        let (mut weight, mut per_meter) = (1.0, octaves.per_meter);
        for number in 0..octaves.count {
            let fastest = per_meter[0].max(per_meter[1]).max(per_meter[2]);
            if fastest * self.finest >= 0.5 {
                break;
            }
            let shuffled = 0x9e37_79b9u32.wrapping_mul(number as u32 + 1);
            let octave = Octave {
                per_meter,
                fastest,
                weight,
                key: octaves.key.wrapping_add(shuffled),
            };
            vectorized!(add_octave::<SLOPE>(&mut sum, position, footprint, octave));
            weight *= 0.5;
            // Not exactly 2: lattice planes of successive octaves must not coincide.
            per_meter = per_meter.map(|f| f * 2.03);
        }
        sum
    }

    /// Dots of up to `radius` (as a share of a cell, below 0.5), at most one per cell and in `share` of the cells.
    pub(crate) fn dots(&self, per_meter: f32, radius: f32, share: f32, key: u32) -> NoiseSample {
        let mut dots = NoiseSample::default();
        if per_meter * self.finest < 0.5 {
            let (position, footprint) = (self.position, self.footprint);
            let shape = (per_meter, radius, share);
            vectorized!(put_dots(&mut dots, position, footprint, shape, key));
        }
        dots
    }
}

#[inline(always)]
fn add_octave<const SLOPE: bool>(sum: &mut NoiseSample, position: &Lane3, footprint: &Lane, octave: Octave) {
    let Octave {
        per_meter,
        fastest,
        weight,
        key,
    } = octave;
    // Every octave has a shifted lattice: a flat surface must not coincide with a lattice plane, where the noise is
    // poor.
    let shift = [key & 0xff, key >> 8 & 0xff, key >> 16 & 0xff].map(|bits| 0.3 + bits as f32 * (0.4 / 255.0));
    for i in 0..LANES {
        let p = [
            position[0][i] * per_meter[0] + shift[0],
            position[1][i] * per_meter[1] + shift[1],
            position[2][i] * per_meter[2] + shift[2],
        ];
        let cell = p.map(floor);
        let f = [p[0] - cell[0], p[1] - cell[1], p[2] - cell[2]];
        let (low, high) = (lattice(cell, key), lattice(cell.map(|c| c + 1.0), key));
        let u = f.map(|t| t * t * t * (t * (t * 6.0 - 15.0) + 10.0));
        // Value and gradient on an edge of the cell along x, and the difference of the values at its ends.
        let edge = |y: u32, z: u32, from_y: f32, from_z: f32| {
            let a = evaluate_corner([low[0], y, z], [f[0], from_y, from_z]);
            let b = evaluate_corner([high[0], y, z], [f[0] - 1.0, from_y, from_z]);
            (blend(a, b, u[0]), b[0] - a[0])
        };
        let (c00, d00) = edge(low[1], low[2], f[1], f[2]);
        let (c10, d10) = edge(high[1], low[2], f[1] - 1.0, f[2]);
        let (c01, d01) = edge(low[1], high[2], f[1], f[2] - 1.0);
        let (c11, d11) = edge(high[1], high[2], f[1] - 1.0, f[2] - 1.0);
        let (c0, c1) = (blend(c00, c10, u[1]), blend(c01, c11, u[1]));
        let c = blend(c0, c1, u[2]);
        let seen = clamp01(2.0 - 4.0 * fastest * footprint[i]) * (weight * 1.4 * GRADIENT_UNIT);
        sum.value[i] += seen * c[0];
        if SLOPE {
            let du = f.map(|t| 30.0 * t * t * (t * (t - 2.0) + 1.0));
            let along_x = mix(mix(d00, d10, u[1]), mix(d01, d11, u[1]), u[2]);
            let along_y = mix(c10[0] - c00[0], c11[0] - c01[0], u[2]);
            let along_z = c1[0] - c0[0];
            sum.slope[0][i] += seen * per_meter[0] * (c[1] + du[0] * along_x);
            sum.slope[1][i] += seen * per_meter[1] * (c[2] + du[1] * along_y);
            sum.slope[2][i] += seen * per_meter[2] * (c[3] + du[2] * along_z);
        }
    }
}

/// Value and gradient at a corner of the cell.
#[inline(always)]
fn evaluate_corner(corner: [u32; 3], away: [f32; 3]) -> [f32; 4] {
    let g = gradient(corner);
    let value = g[0] * away[0] + g[1] * away[1] + g[2] * away[2];
    [value, g[0], g[1], g[2]]
}

#[inline(always)]
fn blend(a: [f32; 4], b: [f32; 4], t: f32) -> [f32; 4] {
    [
        mix(a[0], b[0], t),
        mix(a[1], b[1], t),
        mix(a[2], b[2], t),
        mix(a[3], b[3], t),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::site::lanes::ZEROS;

    fn sample(position: [f32; 3], octaves: Octaves) -> (f32, [f32; 3]) {
        let position = position.map(|p| [p; LANES]);
        let place = NoisePoints {
            position: &position,
            footprint: &[1e-6; LANES],
            finest: 1e-6,
        };
        let noise = place.noise(octaves);
        assert_eq!(noise.value, place.values(octaves));
        (noise.value[0], noise.slope.map(|lane| lane[0]))
    }

    #[test]
    fn the_slope_is_the_derivative_of_the_value() {
        let octaves = Octaves {
            per_meter: [1.7, 0.6, 2.3],
            count: 2,
            key: 7,
        };
        let (step, at) = (1e-3, [0.37f32, -2.2, 1.91]);
        let (_, slope) = sample(at, octaves);
        for axis in 0..3 {
            let (mut before, mut after) = (at, at);
            before[axis] -= step;
            after[axis] += step;
            let difference = (sample(after, octaves).0 - sample(before, octaves).0) / (2.0 * step);
            assert!(
                (difference - slope[axis]).abs() < 0.02,
                "axis {axis}: {difference} {}",
                slope[axis]
            );
        }
    }

    #[test]
    fn gradients_at_neighboring_corners_have_nothing_in_common() {
        let gradient_at = |x: u32, y: u32, z: u32| {
            let corner = lattice([x as f32, y as f32, z as f32], 5);
            gradient(corner).map(|part| part * GRADIENT_UNIT)
        };
        let (mut mean, mut alike, mut count) = ([0.0f64; 3], [0.0f64; 9], 0.0);
        for x in 0..24 {
            for y in 0..24 {
                for z in 0..24 {
                    let current = gradient_at(x, y, z);
                    let neighbors = [(x + 1, y, z), (x, y + 1, z), (x, y, z + 1)];
                    for (n, (x, y, z)) in neighbors.into_iter().enumerate() {
                        let other = gradient_at(x, y, z);
                        for axis in 0..3 {
                            alike[3 * n + axis] += f64::from(current[axis]) * f64::from(other[axis]);
                        }
                    }
                    (0..3).for_each(|axis| mean[axis] += f64::from(current[axis]));
                    count += 1.0;
                }
            }
        }
        // Four standard errors: a component has the variance 1/3, a product 1/9.
        assert!(
            mean.iter()
                .all(|m| (m / count).abs() < 4.0 / (3.0 * count).sqrt())
        );
        assert!(
            alike
                .iter()
                .all(|a| (a / count).abs() < 4.0 / (9.0 * count).sqrt())
        );
    }

    #[test]
    fn noise_finer_than_two_pixels_is_left_out() {
        let position = [[0.3; LANES], [0.4; LANES], [0.7; LANES]];
        let place = NoisePoints {
            position: &position,
            footprint: &[0.3; LANES],
            finest: 0.3,
        };
        assert_eq!(place.noise(Octaves::even(2.0, 3, 1)).value, ZEROS);
        assert!(place.noise(Octaves::even(0.9, 1, 1)).value[0] != 0.0);
    }
}
