//! Seeded noise over space: gradient noise with its analytic slope (Perlin 2002; derivative after Quilez 2008),
//! sums of its octaves, and scattered dots. The lattice is hashed with integers, so it is the same everywhere.

use imaging::simd::vectorised;

use super::lanes::{LANES, Lane, Lane3, ZEROS, clamp01, floor};

/// Noise values, about -1..1 and 0 on average, and their slopes per metre.
#[derive(Clone, Copy)]
pub(super) struct Noise {
    pub value: Lane,
    pub slope: Lane3,
}

/// Where noise is asked for.
pub(super) struct Site<'a> {
    /// Position in metres.
    pub position: &'a Lane3,
    /// Length in metres that a pixel covers on the surface.
    pub footprint: &'a Lane,
    /// The smallest footprint.
    pub finest: f32,
}

/// Octaves of gradient noise.
#[derive(Clone, Copy)]
pub(super) struct Octaves {
    /// Lattice cells per metre of the first octave, per axis.
    pub per_metre: [f32; 3],
    /// Octaves; each has twice the frequency and half the weight of the one before.
    pub count: usize,
    pub key: u32,
}

impl Octaves {
    /// The same frequency along every axis.
    pub(super) fn even(per_metre: f32, count: usize, key: u32) -> Self {
        Self {
            per_metre: [per_metre; 3],
            count,
            key,
        }
    }
}

impl Site<'_> {
    /// Sums octaves. An octave fades out as its cells come down to two pixels, where it would alias.
    pub(super) fn noise(&self, octaves: Octaves) -> Noise {
        let mut sum = Noise {
            value: ZEROS,
            slope: [ZEROS; 3],
        };
        let mut weight = 1.0;
        let mut per_metre = octaves.per_metre;
        for octave in 0..octaves.count {
            let fastest = per_metre[0].max(per_metre[1]).max(per_metre[2]);
            if fastest * self.finest >= 0.5 {
                break;
            }
            let key = octaves
                .key
                .wrapping_add(0x9e37_79b9u32.wrapping_mul(octave as u32 + 1));
            let (position, footprint) = (self.position, self.footprint);
            vectorised(
                #[inline(always)]
                || add_octave(&mut sum, position, footprint, per_metre, (weight, fastest), key),
            );
            weight *= 0.5;
            // Not exactly 2: lattice planes of successive octaves must not coincide.
            per_metre = per_metre.map(|f| f * 2.03);
        }
        sum
    }

    /// Dots of up to `radius` (as a share of a cell, below 0.5), at most one per cell and in `share` of the cells.
    pub(super) fn dots(&self, per_metre: f32, radius: f32, share: f32, key: u32) -> Noise {
        let mut dots = Noise {
            value: ZEROS,
            slope: [ZEROS; 3],
        };
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
fn hash(x: u32, y: u32, z: u32) -> u32 {
    let mut h = x ^ y ^ z;
    h = (h ^ (h >> 15)).wrapping_mul(0x2c1b_3c6d);
    h = (h ^ (h >> 12)).wrapping_mul(0x297a_2d39);
    h ^ (h >> 15)
}

/// The lattice coordinate below, as the integer that is hashed.
#[inline(always)]
fn lattice(below: f32) -> u32 {
    // 1.5 * 2^23 shifts the integer into the mantissa.
    (below + 12_582_912.0).to_bits()
}

const PRIMES: [u32; 3] = [0x9e37_79b1, 0x85eb_ca77, 0xc2b2_ae3d];

#[inline(always)]
fn gradient(h: u32) -> [f32; 3] {
    let part = |shift: u32| ((h >> shift) & 0x3ff) as i32 as f32 * (2.0 / 1023.0) - 1.0;
    [part(0), part(10), part(20)]
}

#[inline(always)]
fn add_octave(
    sum: &mut Noise,
    position: &Lane3,
    footprint: &Lane,
    per_metre: [f32; 3],
    (weight, fastest): (f32, f32),
    key: u32,
) {
    for i in 0..LANES {
        let p = [
            position[0][i] * per_metre[0],
            position[1][i] * per_metre[1],
            position[2][i] * per_metre[2],
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
        let du = f.map(|t| 30.0 * t * t * (t * (t - 2.0) + 1.0));
        // Value and gradient at the corner (a, b, c).
        let corner = |x: u32, y: u32, z: u32, a: f32, b: f32, c: f32| {
            let g = gradient(hash(x, y, z));
            [
                g[0] * (f[0] - a) + g[1] * (f[1] - b) + g[2] * (f[2] - c),
                g[0],
                g[1],
                g[2],
            ]
        };
        let blend = |a: [f32; 4], b: [f32; 4], t: f32| {
            [
                a[0] + (b[0] - a[0]) * t,
                a[1] + (b[1] - a[1]) * t,
                a[2] + (b[2] - a[2]) * t,
                a[3] + (b[3] - a[3]) * t,
            ]
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
        let along_x = {
            let (a, b) = (c100[0] - c000[0], c110[0] - c010[0]);
            let (d, e) = (c101[0] - c001[0], c111[0] - c011[0]);
            let (low, high) = (a + (b - a) * u[1], d + (e - d) * u[1]);
            low + (high - low) * u[2]
        };
        let along_y = (c10[0] - c00[0]) + ((c11[0] - c01[0]) - (c10[0] - c00[0])) * u[2];
        let along_z = c1[0] - c0[0];
        let seen = weight * clamp01(2.0 - 4.0 * fastest * footprint[i]);
        sum.value[i] += seen * 1.4 * c[0];
        sum.slope[0][i] += seen * 1.4 * per_metre[0] * (c[1] + du[0] * along_x);
        sum.slope[1][i] += seen * 1.4 * per_metre[1] * (c[2] + du[1] * along_y);
        sum.slope[2][i] += seen * 1.4 * per_metre[2] * (c[3] + du[2] * along_z);
    }
}

#[inline(always)]
fn put_dots(
    dots: &mut Noise,
    position: &Lane3,
    footprint: &Lane,
    per_metre: f32,
    radius: f32,
    share: f32,
    key: u32,
) {
    for i in 0..LANES {
        let p = [
            position[0][i] * per_metre,
            position[1][i] * per_metre,
            position[2][i] * per_metre,
        ];
        let cell = p.map(floor);
        let h = hash(
            lattice(cell[0]).wrapping_mul(PRIMES[0]) ^ key,
            lattice(cell[1]).wrapping_mul(PRIMES[1]),
            lattice(cell[2]).wrapping_mul(PRIMES[2]),
        );
        let jitter = gradient(h).map(|g| 0.5 + g * (0.5 - radius));
        let kind = (hash(h, key, 1) >> 8) as i32 as f32 * (1.0 / 16_777_216.0);
        let size = radius * (0.45 + 0.55 * kind / share);
        let away = [
            p[0] - cell[0] - jitter[0],
            p[1] - cell[1] - jitter[1],
            p[2] - cell[2] - jitter[2],
        ];
        let near = (away[0] * away[0] + away[1] * away[1] + away[2] * away[2]) / (size * size);
        let inside = clamp01(1.0 - near);
        let seen = clamp01(2.0 - 4.0 * per_metre * footprint[i]) * if kind < share { 1.0 } else { 0.0 };
        let steep = if near < 1.0 {
            -4.0 * near * per_metre / (size * size)
        } else {
            0.0
        };
        dots.value[i] = seen * inside * (2.0 - inside);
        for axis in 0..3 {
            dots.slope[axis][i] = seen * steep * away[axis];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(position: [f32; 3], octaves: Octaves) -> (f32, [f32; 3]) {
        let position = position.map(|p| [p; LANES]);
        let site = Site {
            position: &position,
            footprint: &[1e-6; LANES],
            finest: 1e-6,
        };
        let noise = site.noise(octaves);
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
    fn noise_finer_than_two_pixels_is_left_out() {
        let position = [[0.3; LANES], [0.4; LANES], [0.7; LANES]];
        let site = Site {
            position: &position,
            footprint: &[0.3; LANES],
            finest: 0.3,
        };
        assert_eq!(site.noise(Octaves::even(2.0, 3, 1)).value, ZEROS);
        assert!(site.noise(Octaves::even(0.9, 1, 1)).value[0] != 0.0);
    }
}
