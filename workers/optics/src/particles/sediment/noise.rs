//! Smooth noise over space: values at the corners of a lattice, joined smoothly, in three octaves (Perlin 1985).

/// Weights of the octaves; their sum is 1, so that values are within −1..1.
const WEIGHTS: [f64; 3] = [0.58, 0.28, 0.14];
/// Cells of an octave over those of the one before; not 2, to keep lattice planes from coinciding.
const FINER: f64 = 2.17;

/// Noise of mean 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Noise {
    key: u64,
}

impl Noise {
    pub(super) fn new(key: u64) -> Self {
        Self { key }
    }

    /// Its value at a point in cells of the first octave.
    pub(super) fn at(&self, place: [f64; 3]) -> f64 {
        let (mut sum, mut scale) = (0.0, 1.0);
        for (octave, weight) in (0u64..).zip(WEIGHTS) {
            let key = self.key.wrapping_add(octave.wrapping_mul(0x9e37_79b9_7f4a_7c15));
            sum += weight * lattice(key, place.map(|v| v * scale));
            scale *= FINER;
        }
        sum
    }
}

fn lattice(key: u64, place: [f64; 3]) -> f64 {
    let cell = place.map(f64::floor);
    // 6t⁵ − 15t⁴ + 10t³ (Perlin 2002).
    let share = [0, 1, 2].map(|i| {
        let t: f64 = place[i] - cell[i];
        t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
    });
    let corner = |x: i64, y: i64, z: i64| {
        let [a, b, c] = cell.map(|v| v as i64 as u64);
        let mut h = key
            ^ a.wrapping_add(x as u64).wrapping_mul(0x9e37_79b9_7f4a_7c15)
            ^ b.wrapping_add(y as u64).wrapping_mul(0xc2b2_ae3d_27d4_eb4f)
            ^ c.wrapping_add(z as u64).wrapping_mul(0x1656_67b1_9e37_79f9);
        // The finalizer of SplitMix64 (Steele, Lea, Flood 2014).
        h = (h ^ (h >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        h = (h ^ (h >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((h ^ (h >> 31)) >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    let mix = |a: f64, b: f64, t: f64| a + (b - a) * t;
    let along = |y: i64, z: i64| mix(corner(0, y, z), corner(1, y, z), share[0]);
    let across = |z: i64| mix(along(0, z), along(1, z), share[1]);
    mix(across(0), across(1), share[2])
}
