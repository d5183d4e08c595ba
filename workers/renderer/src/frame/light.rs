//! The light of one moment of a frame at the window of the camera.

use imaging::{Plane, Rgb};
use optics::chain::Layers;

/// The light of a moment in front of the camera.
pub(crate) struct Light {
    /// The components of the image; `scattered` is their sum.
    pub(crate) layers: Layers,
    /// Airlight of lamps, included in the backscatter; `None` without lamps.
    pub(crate) airlight: Option<Rgb<f32>>,
    /// Opacity of clouds and snow; `None` if none were drawn.
    pub(crate) mask: Option<Plane<f32>>,
}
