//! Seeded noise over space: gradient noise with its analytic slope (Perlin 2002; derivative after Quilez 2008),
//! sums of its octaves, and scattered dots. The lattice is hashed with integers, so it is the same everywhere.

use imaging::simd::vectorised;

use super::dots::put_dots;
use super::lanes::{LANES, Lane, Lane3, ZEROS, clamp01, floor};

/// Noise values, about -1..1 and 0 on average, and their slopes per metre.
#[derive(Clone, Copy)]
pub(crate) struct Noise {
    pub(crate) value: Lane,
    pub(crate) slope: Lane3,
}

const STILL: Noise = Noise {
    value: ZEROS,
    slope: [ZEROS; 3],
};

/// Where noise is asked for. A point's noise depends on its own position and footprint only.
#[derive(Clone, Copy)]
pub(crate) struct Place<'a> {
    /// Position in metres.
    pub(crate) position: &'a Lane3,
    /// Length in metres that a pixel covers on the surface.
    pub(crate) footprint: &'a Lane,
    /// The smallest footprint.
    pub(crate) finest: f32,
}

/// Octaves of gradient noise; each has about twice the frequency and half the weight of the one before.
#[derive(Clone, Copy)]
pub(crate) struct Octaves {
    /// Lattice cells per metre of the first octave, per axis.
    pub(crate) per_metre: [f32; 3],
    pub(crate) count: usize,
    pub(crate) key: u32,
}

impl Octaves {
    /// The same frequency along every axis.
    pub(crate) fn even(per_metre: f32, count: usize, key: u32) -> Self {
        Self {
            per_metre: [per_metre; 3],
            count,
            key,
        }
    }
}

/// One octave of a sum.
#[derive(Clone, Copy)]
struct Octave {
    per_metre: [f32; 3],
    fastest: f32,
    weight: f32,
    key: u32,
}

impl Place<'_> {
    /// Sums octaves. An octave fades out as its cells come down to two pixels, where it would alias.
    pub(crate) fn noise(&self, octaves: Octaves) -> Noise {
        let mut sum = STILL;
        let (position, footprint) = (self.position, self.footprint);
        self.each_octave(octaves, |octave| {
            vectorised(
                #[inline(always)]
                || add_octave::<true>(&mut sum, position, footprint, octave),
            );
        });
        sum
    }

    /// The values of [`Place::noise`] alone, in about half the time.
    pub(crate) fn values(&self, octaves: Octaves) -> Lane {
        let mut sum = STILL;
        let (position, footprint) = (self.position, self.footprint);
        self.each_octave(octaves, |octave| {
            vectorised(
                #[inline(always)]
                || add_octave::<false>(&mut sum, position, footprint, octave),
            );
        });
        sum.value
    }

    fn each_octave(&self, octaves: Octaves, mut add: impl FnMut(Octave)) {
        let mut weight = 1.0;
        let mut per_metre = octaves.per_metre;
        for number in 0..octaves.count {
            let fastest = per_metre[0].max(per_metre[1]).max(per_metre[2]);
            if fastest * self.finest >= 0.5 {
                break;
            }
            let key = octaves
                .key
                .wrapping_add(0x9e37_79b9u32.wrapping_mul(number as u32 + 1));
            add(Octave {
                per_metre,
                fastest,
                weight,
                key,
            });
            weight *= 0.5;
            // Not exactly 2: lattice planes of successive octaves must not coincide.
            per_metre = per_metre.map(|f| f * 2.03);
        }
    }

    /// Dots of up to `radius` (as a share of a cell, below 0.5), at most one per cell and in `share` of the cells.
    pub(crate) fn dots(&self, per_metre: f32, radius: f32, share: f32, key: u32) -> Noise {
        let mut dots = STILL;
        if per_metre * self.finest < 0.5 {
            let (position, footprint) = (self.position, self.footprint);
            vectorised(
                #[inline(always)]
                || put_dots(&mut dots, position, footprint, per_metre, radius, share, key),
            );
        }
        dots
    }
}

#[inline(always)]
pub(crate) fn hash(x: u32, y: u32, z: u32) -> u32 {
    let mut h = x ^ y ^ z;
    h = (h ^ (h >> 15)).wrapping_mul(0x2c1b_3c6d);
    h = (h ^ (h >> 12)).wrapping_mul(0x297a_2d39);
    h ^ (h >> 15)
}

/// A lattice coordinate, a whole number, as the integer that is hashed.
#[inline(always)]
pub(crate) fn lattice(below: f32) -> u32 {
    // 1.5 * 2^23 shifts the integer into the mantissa.
    (below + 12_582_912.0).to_bits()
}

pub(crate) const PRIMES: [u32; 3] = [0x9e37_79b1, 0x85eb_ca77, 0xc2b2_ae3d];

/// The gradient at a corner, in parts of [`GRADIENT_UNIT`]: the hash, and it again without its top ten and twenty bits, as
/// signed numbers.
#[inline(always)]
pub(super) fn gradient(x: u32, y: u32, z: u32) -> [f32; 3] {
    let h = hash(x, y, z);
    let part = |bits: u32| bits as i32 as f32;
    [part(h), part(h << 10), part(h << 20)]
}

/// A component of a gradient reaches from -1 to 1 after multiplication with this.
pub(super) const GRADIENT_UNIT: f32 = 1.0 / 2_147_483_648.0;

#[inline(always)]
fn add_octave<const SLOPE: bool>(sum: &mut Noise, position: &Lane3, footprint: &Lane, octave: Octave) {
    let Octave {
        per_metre,
        fastest,
        weight,
        key,
    } = octave;
    // Every octave has a lattice of its own: a flat surface must not lie in a lattice plane, where the noise is poor.
    let shift = [key & 0xff, key >> 8 & 0xff, key >> 16 & 0xff].map(|bits| 0.3 + bits as f32 * (0.4 / 255.0));
    for i in 0..LANES {
        let p = [
            position[0][i] * per_metre[0] + shift[0],
            position[1][i] * per_metre[1] + shift[1],
            position[2][i] * per_metre[2] + shift[2],
        ];
        let cell = p.map(floor);
        let f = [p[0] - cell[0], p[1] - cell[1], p[2] - cell[2]];
        let low = [
            lattice(cell[0]).wrapping_mul(PRIMES[0]) ^ key,
            lattice(cell[1]).wrapping_mul(PRIMES[1]),
            lattice(cell[2]).wrapping_mul(PRIMES[2]),
        ];
        let high = [
            lattice(cell[0] + 1.0).wrapping_mul(PRIMES[0]) ^ key,
            lattice(cell[1] + 1.0).wrapping_mul(PRIMES[1]),
            lattice(cell[2] + 1.0).wrapping_mul(PRIMES[2]),
        ];
        let u = f.map(|t| t * t * t * (t * (t * 6.0 - 15.0) + 10.0));
        // Value and gradient at the corner (a, b, c).
        let corner = |x: u32, y: u32, z: u32, a: f32, b: f32, c: f32| {
            let g = gradient(x, y, z);
            [
                g[0] * (f[0] - a) + g[1] * (f[1] - b) + g[2] * (f[2] - c),
                g[0],
                g[1],
                g[2],
            ]
        };
        let blend = |a: [f32; 4], b: [f32; 4], t: f32| {
            if SLOPE {
                [
                    a[0] + (b[0] - a[0]) * t,
                    a[1] + (b[1] - a[1]) * t,
                    a[2] + (b[2] - a[2]) * t,
                    a[3] + (b[3] - a[3]) * t,
                ]
            } else {
                [a[0] + (b[0] - a[0]) * t, 0.0, 0.0, 0.0]
            }
        };
        let c000 = corner(low[0], low[1], low[2], 0.0, 0.0, 0.0);
        let c100 = corner(high[0], low[1], low[2], 1.0, 0.0, 0.0);
        let c010 = corner(low[0], high[1], low[2], 0.0, 1.0, 0.0);
        let c110 = corner(high[0], high[1], low[2], 1.0, 1.0, 0.0);
        let c001 = corner(low[0], low[1], high[2], 0.0, 0.0, 1.0);
        let c101 = corner(high[0], low[1], high[2], 1.0, 0.0, 1.0);
        let c011 = corner(low[0], high[1], high[2], 0.0, 1.0, 1.0);
        let c111 = corner(high[0], high[1], high[2], 1.0, 1.0, 1.0);
        let (c00, c10) = (blend(c000, c100, u[0]), blend(c010, c110, u[0]));
        let (c01, c11) = (blend(c001, c101, u[0]), blend(c011, c111, u[0]));
        let (c0, c1) = (blend(c00, c10, u[1]), blend(c01, c11, u[1]));
        let c = blend(c0, c1, u[2]);
        let seen = clamp01(2.0 - 4.0 * fastest * footprint[i]) * (weight * 1.4 * GRADIENT_UNIT);
        sum.value[i] += seen * c[0];
        if SLOPE {
            let du = f.map(|t| 30.0 * t * t * (t * (t - 2.0) + 1.0));
            let along_x = {
                let (a, b) = (c100[0] - c000[0], c110[0] - c010[0]);
                let (d, e) = (c101[0] - c001[0], c111[0] - c011[0]);
                let (low, high) = (a + (b - a) * u[1], d + (e - d) * u[1]);
                low + (high - low) * u[2]
            };
            let along_y = (c10[0] - c00[0]) + ((c11[0] - c01[0]) - (c10[0] - c00[0])) * u[2];
            let along_z = c1[0] - c0[0];
            sum.slope[0][i] += seen * per_metre[0] * (c[1] + du[0] * along_x);
            sum.slope[1][i] += seen * per_metre[1] * (c[2] + du[1] * along_y);
            sum.slope[2][i] += seen * per_metre[2] * (c[3] + du[2] * along_z);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(position: [f32; 3], octaves: Octaves) -> (f32, [f32; 3]) {
        let position = position.map(|p| [p; LANES]);
        let place = Place {
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
            per_metre: [1.7, 0.6, 2.3],
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
    fn gradients_at_neighbouring_corners_have_nothing_in_common() {
        let at = |x: u32, y: u32, z: u32| {
            let [a, b, c] = gradient(
                lattice(x as f32).wrapping_mul(PRIMES[0]) ^ 5,
                lattice(y as f32).wrapping_mul(PRIMES[1]),
                lattice(z as f32).wrapping_mul(PRIMES[2]),
            );
            [a, b, c].map(|part| part * GRADIENT_UNIT)
        };
        let (mut mean, mut alike, mut count) = ([0.0f64; 3], [0.0f64; 9], 0.0);
        for x in 0..24 {
            for y in 0..24 {
                for z in 0..24 {
                    let here = at(x, y, z);
                    for (n, there) in [at(x + 1, y, z), at(x, y + 1, z), at(x, y, z + 1)]
                        .iter()
                        .enumerate()
                    {
                        for axis in 0..3 {
                            alike[3 * n + axis] += f64::from(here[axis]) * f64::from(there[axis]);
                        }
                    }
                    (0..3).for_each(|axis| mean[axis] += f64::from(here[axis]));
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
        let place = Place {
            position: &position,
            footprint: &[0.3; LANES],
            finest: 0.3,
        };
        assert_eq!(place.noise(Octaves::even(2.0, 3, 1)).value, ZEROS);
        assert!(place.noise(Octaves::even(0.9, 1, 1)).value[0] != 0.0);
    }
}
