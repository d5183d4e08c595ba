//! Water in layers of range.

use imaging::{Plane, Rgb};

/// The parts of an underwater image in linear light, not clamped.
#[derive(Debug, Clone, PartialEq)]
pub struct Layers<T = f32> {
    /// D: light of the scene that arrives unscattered.
    pub direct: Rgb<T>,
    /// F: light that arrives scattered forward. In the simplified form: the change by gathering, which may be negative.
    pub forward_scatter: Rgb<T>,
    /// B: the veil.
    pub backscatter: Rgb<T>,
    /// The image.
    pub scattered: Rgb<T>,
    /// Pixels without a valid range.
    pub holes: u64,
}

/// One channel of [`Layers`].
pub(super) struct Band<T> {
    pub(super) direct: Plane<T>,
    pub(super) forward: Plane<T>,
    pub(super) veil: Plane<T>,
    pub(super) image: Plane<T>,
}

pub(super) fn layers<T>([r, g, b]: [Band<T>; 3], holes: u64) -> Layers<T> {
    let join = |planes| Rgb::new(planes).expect("bands of one frame");
    Layers {
        direct: join([r.direct, g.direct, b.direct]),
        forward_scatter: join([r.forward, g.forward, b.forward]),
        backscatter: join([r.veil, g.veil, b.veil]),
        scattered: join([r.image, g.image, b.image]),
        holes,
    }
}
