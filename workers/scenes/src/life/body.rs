//! Surfaces of animals and plants.

use crate::site::chance::Dice;
use crate::site::finish::{Finish, Material};

/// Skin, shell or leaf.
#[derive(Debug, Clone, Copy)]
pub(super) struct Body {
    /// Albedo of the upper side.
    pub(super) color: [f32; 3],
    pub(super) gloss: f32,
    /// Brightness of the underside relative to that.
    pub(super) belly: f32,
}

impl Body {
    pub(super) fn finish(self, dice: Dice) -> Finish {
        let Self { color, gloss, belly } = self;
        Finish::new(Material::Body { color, gloss, belly }, dice)
    }
}
