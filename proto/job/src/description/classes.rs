//! Object classes of an uploaded scene, in the format of COCO's panoptic annotations.

use serde::{Deserialize, Serialize};

/// The class of each object of a scene.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Classes {
    /// Classes by ascending id; some may have no object in this scene.
    pub categories: Vec<SceneCategory>,
    /// Objects with a known class, by ascending number.
    pub segments_info: Vec<Segment>,
}

/// A class of objects.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct SceneCategory {
    /// Code in the semantic mask.
    pub id: u8,
    /// Name of the class.
    pub name: String,
}

/// An object of a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Segment {
    /// Number in the instance mask.
    pub id: u16,
    /// Id of its class.
    pub category_id: u8,
}

impl Classes {
    /// Class of an object; `None` if unknown.
    #[must_use]
    pub fn class_of(&self, number: u16) -> Option<u8> {
        let found = self
            .segments_info
            .binary_search_by_key(&number, |segment| segment.id);
        Some(self.segments_info[found.ok()?].category_id)
    }

    /// Name of a class.
    #[must_use]
    pub fn name(&self, id: u8) -> Option<&str> {
        let found = self.categories.binary_search_by_key(&id, |category| category.id);
        Some(&self.categories[found.ok()?].name)
    }

    /// The same classes, with only the objects for which `keep` is true.
    #[must_use]
    pub fn only(mut self, keep: impl Fn(u16) -> bool) -> Self {
        self.segments_info.retain(|segment| keep(segment.id));
        self
    }
}
