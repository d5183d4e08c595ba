//! SurfaceRows of animals and plants.

use crate::site::chance::Choices;
use crate::site::finish::{Material, SurfaceFinish};

/// Skin, shell or leaf.
#[derive(Debug, Clone, Copy)]
pub(super) struct Skin {
    /// Albedo of the upper side.
    pub(super) color: [f32; 3],
    pub(super) gloss: f32,
    /// Brightness of the underside relative to that.
    pub(super) belly: f32,
}

impl Skin {
    pub(super) fn finish(self, dice: Choices) -> SurfaceFinish {
        let Self { color, gloss, belly } = self;
        SurfaceFinish::new(Material::Body { color, gloss, belly }, dice)
    }
}
