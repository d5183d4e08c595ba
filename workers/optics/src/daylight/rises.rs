//! Cosines between the rays of a row and a direction.

use super::gaze::Gaze;

/// The rays of a row against a unit vector: `(x u + level)/sqrt(u² + square)`, in f64, since the window of the sky has a steep edge.
#[derive(Clone, Copy)]
pub(super) struct Row {
    inverse_focal: f64,
    cx: f64,
    across: f64,
    level: f64,
    square: f64,
}

impl Row {
    pub(super) fn new(gaze: &Gaze, y: usize) -> Self {
        Self::toward(gaze, y, gaze.up)
    }

    /// The rays against any unit vector in camera axes.
    pub(super) fn toward(gaze: &Gaze, y: usize, [x, down, ahead]: [f64; 3]) -> Self {
        let v = (y as f64 - gaze.camera.cy) / gaze.camera.focal_px;
        Self {
            inverse_focal: 1.0 / gaze.camera.focal_px,
            cx: gaze.camera.cx,
            across: x,
            level: down * v + ahead,
            square: v * v + 1.0,
        }
    }
}

impl Row {
    #[inline(always)]
    fn cosine(self, x: usize) -> f64 {
        let u = (f64::from(x as i32) - self.cx) * self.inverse_focal;
        (self.across * u + self.level) / (u * u + self.square).sqrt()
    }
}

#[inline(always)]
pub(super) fn rises_of(row: Row, rises: &mut [f32]) {
    for (x, rise) in rises.iter_mut().enumerate() {
        *rise = row.cosine(x) as f32;
    }
}

/// 1 − cos of the angles, with all digits of f32 close to the direction.
#[inline(always)]
pub(super) fn versines_of(row: Row, versines: &mut [f32]) {
    for (x, versine) in versines.iter_mut().enumerate() {
        *versine = (1.0 - row.cosine(x)).max(0.0) as f32;
    }
}
