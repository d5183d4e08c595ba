//! The light of one moment of a frame, as it reaches the window of the camera.

use imaging::{Plane, Rgb};
use optics::chain::Layers;

/// The light of a moment before its camera.
pub(crate) struct Light {
    /// The parts of the image; `scattered` is all of it.
    pub(crate) layers: Layers,
    /// Airlight of lamps, a part of the backscatter; `None` without.
    pub(crate) airlight: Option<Rgb<f32>>,
    /// Opacity of clouds and snow; `None` if none were drawn.
    pub(crate) mask: Option<Plane<f32>>,
}
