//! Table of the procedural families, one module each.

use crate::site::Site;
use crate::{open_water, pipeline, shaft, structure};

/// A procedural family.
#[derive(Debug, Clone, Copy)]
pub struct SceneFamily {
    /// Name in job descriptions.
    pub name: &'static str,
    /// Short description.
    pub about: &'static str,
    /// Builds the site of a seed. The second argument is the buried share of a pipe's diameter.
    pub(crate) site: fn(u64, Option<f32>) -> Site,
}

const TABLE: [SceneFamily; 4] = [
    SceneFamily {
        name: "structure",
        about: "piles, braced legs, pipes, plates and beams on a rippled seabed",
        site: structure::site,
    },
    SceneFamily {
        name: "shaft",
        about: "flooded shafts and tunnels with their lining, mud on the floor, ladders, pipes and cables",
        site: shaft::site,
    },
    SceneFamily {
        name: "pipeline",
        about: "a coated pipe on its supports with field joints, weld seams, anodes and damage",
        site: pipeline::site,
    },
    SceneFamily {
        name: "open-water",
        about: "posts, mooring lines, buoys, hanging crates and cables in mid-water, without a bottom",
        site: open_water::site,
    },
];

/// Names of the procedural families.
pub const FAMILIES: &[&str] = &{
    let mut names = [""; TABLE.len()];
    let mut row = 0;
    while row < names.len() {
        names[row] = TABLE[row].name;
        row += 1;
    }
    names
};

impl SceneFamily {
    /// Returns the family of this name.
    #[must_use]
    pub fn parse(name: &str) -> Option<Self> {
        TABLE.into_iter().find(|family| family.name == name)
    }
}
