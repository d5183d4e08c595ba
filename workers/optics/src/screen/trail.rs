//! A ray as a line of the picture.

use imaging::vector::DVec3;

/// The projection of a segment of a ray into the picture.
pub(super) struct Trail {
    pub(super) origin: DVec3,
    pub(super) direction: DVec3,
    /// Distances along the ray at its start and end.
    pub(super) ends: [f64; 2],
    /// Columns and rows there.
    pub(super) places: [[f64; 2]; 2],
    /// 1/z there.
    pub(super) inverse: [f64; 2],
}

impl Trail {
    pub(super) fn place(&self, share: f64) -> [f64; 2] {
        [0, 1].map(|i| self.places[0][i] + share * (self.places[1][i] - self.places[0][i]))
    }

    pub(super) fn inverse_at(&self, share: f64) -> f64 {
        self.inverse[0] + share * (self.inverse[1] - self.inverse[0])
    }

    /// Distance along the ray at a share of its picture.
    pub(super) fn distance(&self, share: f64) -> f64 {
        let part = share * self.inverse[1] / self.inverse_at(share);
        self.ends[0] + part * (self.ends[1] - self.ends[0])
    }

    /// The inverse of [`Trail::distance`].
    pub(super) fn share(&self, distance: f64) -> f64 {
        let part = (distance - self.ends[0]) / (self.ends[1] - self.ends[0]);
        part * self.inverse[0] / (part * self.inverse[0] + (1.0 - part) * self.inverse[1])
    }

    /// Distance from the camera at a share.
    pub(super) fn range(&self, share: f64) -> f64 {
        (self.origin + self.direction * self.distance(share)).length()
    }

    /// The interval of shares within a frame.
    pub(super) fn within(&self, (width, height): (usize, usize)) -> Option<[f64; 2]> {
        let mut shares = [0.0f64, 1.0];
        for (i, count) in [width, height].into_iter().enumerate() {
            let (from, step) = (self.places[0][i], self.places[1][i] - self.places[0][i]);
            let ends = [-0.5 - from, count as f64 - 0.5 - from];
            if step == 0.0 {
                if ends[0] > 0.0 || ends[1] < 0.0 {
                    return None;
                }
                continue;
            }
            let (a, b) = (ends[0] / step, ends[1] / step);
            shares = [shares[0].max(a.min(b)), shares[1].min(a.max(b))];
        }
        (shares[0] <= shares[1]).then_some(shares)
    }
}
