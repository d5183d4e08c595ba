//! The guide of the filter.

use imaging::{Plane, Rgb8};
use spec::Guided;

/// Radius of the methods' windows, pixels.
pub const RADIUS_PX: usize = 50;

/// ε of the methods, in squares of the guide's 0..=1.
pub const REGULARIZATION: f64 = 1e-3;

/// Largest radius: the fast variant keeps a row of coefficients for each row of a window.
pub const RADIUS_MAX: usize = 255;

/// A guide: codes and their scale.
#[derive(Debug, Clone)]
pub struct Guide {
    pub(super) channels: [Plane<u8>; 3],
    /// `I = scale · code + offset`; the offset cancels out.
    pub(super) scale: f64,
    pub(super) radius_px: usize,
    pub(super) regularization: f64,
}

impl Guide {
    /// The picture as guide, `I = code / 255`, with the methods' radius and ε.
    #[must_use]
    pub fn new(picture: &Rgb8) -> Self {
        Self {
            channels: picture.to_planes(),
            scale: 1.0 / 255.0,
            radius_px: RADIUS_PX,
            regularization: REGULARIZATION,
        }
    }

    /// Sets the scale of `I = scale · code + offset`, above 0.
    #[must_use]
    pub fn scaled(self, scale: f64) -> Self {
        Self { scale, ..self }
    }

    /// Sets the radius, clamped to 0..=[`RADIUS_MAX`], and ε, above 0.
    #[must_use]
    pub fn window(self, radius_px: usize, regularization: f64) -> Self {
        Self {
            radius_px: radius_px.min(RADIUS_MAX),
            regularization,
            ..self
        }
    }

    /// Sets the radius and ε of a method.
    #[must_use]
    pub(crate) fn with_parameters(self, parameters: &Guided) -> Self {
        self.window(parameters.guide_radius_px, parameters.guide_eps)
    }

    /// The larger of green and blue.
    pub(crate) fn brighter(&self) -> Plane<u8> {
        let [_, green, blue] = &self.channels;
        let mut brighter = green.clone();
        for (code, &blue) in brighter.data_mut().iter_mut().zip(blue.data()) {
            *code = (*code).max(blue);
        }
        brighter
    }

    /// The planes of red, green and blue.
    #[must_use]
    pub fn channels(&self) -> &[Plane<u8>; 3] {
        &self.channels
    }
}

/// `M⁻¹ v` of a symmetric 3 × 3 matrix, given as `[11, 12, 13, 22, 23, 33]`, by its adjugate.
#[inline(always)]
pub(super) fn solve([m11, m12, m13, m22, m23, m33]: [f64; 6], [v1, v2, v3]: [f64; 3]) -> [f64; 3] {
    let a11 = m22 * m33 - m23 * m23;
    let a12 = m13 * m23 - m12 * m33;
    let a13 = m12 * m23 - m13 * m22;
    let a22 = m11 * m33 - m13 * m13;
    let a23 = m12 * m13 - m11 * m23;
    let a33 = m11 * m22 - m12 * m12;
    let inverse = 1.0 / (m11 * a11 + m12 * a12 + m13 * a13);
    [
        (a11 * v1 + a12 * v2 + a13 * v3) * inverse,
        (a12 * v1 + a22 * v2 + a23 * v3) * inverse,
        (a13 * v1 + a23 * v2 + a33 * v3) * inverse,
    ]
}
