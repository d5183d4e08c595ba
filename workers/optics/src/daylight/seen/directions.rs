//! Directions over a hemisphere, evenly by the cosine from its normal.

use imaging::vector::DVec3;

/// The golden angle.
const TURN: f64 = 2.399_963_229_728_653;

/// The directions about a normal.
pub(super) struct Directions {
    /// Cosine from the normal, and both parts across it.
    pub(super) parts: Vec<[f64; 3]>,
}

impl Directions {
    pub(super) fn new(count: usize) -> Self {
        let part = |k: usize| {
            let cosine = (1.0 - (k as f64 + 0.5) / count as f64).sqrt();
            let across = (1.0 - cosine * cosine).sqrt();
            let (sine, turned) = (TURN * k as f64).sin_cos();
            [cosine, across * turned, across * sine]
        };
        Self {
            parts: (0..count).map(part).collect(),
        }
    }

    /// Direction k about a unit vector.
    pub(super) fn about(&self, k: usize, normal: DVec3) -> DVec3 {
        let [first, second] = across(normal);
        let [ahead, along, aside] = self.parts[k];
        normal * ahead + first * along + second * aside
    }
}

/// The axes of the frame of Duff et al. (2017) about a unit vector.
pub(super) fn across(normal: DVec3) -> [DVec3; 2] {
    let DVec3 { x, y, z } = normal;
    let sign = if z >= 0.0 { 1.0 } else { -1.0 };
    let a = -1.0 / (sign + z);
    let b = x * y * a;
    [
        DVec3::from([1.0 + sign * x * x * a, sign * b, -sign * x]),
        DVec3::from([b, sign + y * y * a, -y]),
    ]
}
