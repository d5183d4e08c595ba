//! Contents of a procedural scene: growth, animals, ropes, bubbles, scour and grain.

use serde::Deserialize;
use spec_derive::Described;

/// Growth, animals, ropes and bubbles within 8 m of a scene's usual view. Growth attaches to structures and stones.
#[derive(Debug, Clone, Copy, Default, PartialEq, Deserialize, Described)]
#[serde(deny_unknown_fields)]
pub struct Life {
    /// clusters of mussels on surfaces
    #[field(within(0.0, 100.0), default = 0, unit = "1/m²")]
    pub mussels: f64,
    /// tufts of tube worms on surfaces
    #[field(within(0.0, 100.0), default = 0, unit = "1/m²")]
    pub worms: f64,
    /// plants that hang from surfaces
    #[field(within(0.0, 100.0), default = 0, unit = "1/m²")]
    pub weed: f64,
    /// number of loose ropes
    #[field(within(0, 16), default = 0)]
    pub ropes: usize,
    /// number of fish
    #[field(within(0.0, 5.0), default = 0, unit = "1/m³")]
    pub fish: f64,
    /// number of jellyfish
    #[field(within(0.0, 2.0), default = 0, unit = "1/m³")]
    pub jellyfish: f64,
    /// number of rising bubbles
    #[field(within(0.0, 50.0), default = 0, unit = "1/m³")]
    pub bubbles: f64,
}

/// The bottom of a scene.
#[derive(Debug, Clone, Copy, Default, PartialEq, Deserialize, Described)]
#[serde(deny_unknown_fields)]
pub struct Ground {
    /// depth of the scour pits around foundations, in foundation diameters
    #[field(within(0.0, 2.0), default = 0)]
    pub scour: f64,
    /// buried share of a pipe's diameter; drawn from the seed by default
    #[field(within(0.0, 1.0))]
    pub burial: Option<f64>,
    /// strength of the fine texture of grains and shells on sand and stones
    #[field(within(0.0, 1.0), default = 0)]
    pub grain: f64,
}
