//! The surfaces of living things.

use crate::site::chance::Dice;
use crate::site::finish::{Finish, Material};

/// Skin, shell or leaf.
#[derive(Debug, Clone, Copy)]
pub(super) struct Body {
    /// Albedo of what faces up.
    pub(super) color: [f32; 3],
    pub(super) gloss: f32,
    /// How many times as bright it is underneath.
    pub(super) belly: f32,
}

impl Body {
    pub(super) fn finish(self, dice: Dice) -> Finish {
        let Self { color, gloss, belly } = self;
        Finish::new(Material::Body { color, gloss, belly }, dice)
    }
}
