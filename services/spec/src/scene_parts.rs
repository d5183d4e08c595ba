//! What scenes can have beside their picture.

use std::collections::BTreeMap;

/// Something that not every scene has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum ScenePart {
    /// The distance of each pixel.
    Range,
    /// The object that each pixel shows.
    Instances,
    /// Normals and findings of the surfaces that a procedural scene is made of.
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

/// What a scene has.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct SceneParts {
    /// Whether it has a range or z-depth.
    pub range: bool,
    /// Whether it has an instance mask.
    pub instances: bool,
    /// Whether its surfaces are known.
    pub surfaces: bool,
    /// Whether it brings its own camera.
    pub camera: bool,
}

impl SceneParts {
    /// What every procedural scene has.
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

/// What is known of uploaded scenes where a description is checked.
#[derive(Debug, Clone)]
pub enum Uploads {
    /// Nothing: they are believed to exist and to have every part.
    Unknown,
    /// These exist, by id, and no others.
    Known(BTreeMap<String, SceneParts>),
}
