//! Optional parts of scenes.

use std::collections::BTreeMap;

/// An optional part of a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum ScenePart {
    /// The distance of each pixel.
    Range,
    /// The object that each pixel shows.
    Instances,
    /// Normals and findings of the surfaces of a procedural scene.
    Surfaces,
}

impl ScenePart {
    /// All parts.
    pub const ALL: [Self; 3] = [Self::Range, Self::Instances, Self::Surfaces];

    /// The part with its article, for messages.
    #[must_use]
    pub fn describe(self) -> &'static str {
        match self {
            Self::Range => "a range",
            Self::Instances => "an instance mask",
            Self::Surfaces => "the surfaces of a procedural scene",
        }
    }
}

/// The parts of a scene.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct SceneParts {
    /// Has a range or z-depth.
    pub range: bool,
    /// Has an instance mask.
    pub instances: bool,
    /// Has known surfaces.
    pub surfaces: bool,
    /// Has a camera.
    pub camera: bool,
}

impl SceneParts {
    /// The parts of every procedural scene.
    pub const PROCEDURAL: Self = Self {
        range: true,
        instances: true,
        surfaces: true,
        camera: false,
    };

    /// Whether the scene has this part.
    #[must_use]
    pub fn has(self, part: ScenePart) -> bool {
        match part {
            ScenePart::Range => self.range,
            ScenePart::Instances => self.instances,
            ScenePart::Surfaces => self.surfaces,
        }
    }
}

/// Known uploaded scenes.
#[derive(Debug, Clone)]
pub enum Uploads {
    /// No information: all scenes are assumed to exist with every part.
    Unknown,
    /// The only existing scenes, by id.
    Known(BTreeMap<String, SceneParts>),
}
