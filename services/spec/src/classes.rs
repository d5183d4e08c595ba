//! The classes of the objects in an uploaded scene, in the form of COCO's panoptic annotations.

use serde::{Deserialize, Serialize};

/// Which class each object of a scene has.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Classes {
    /// The classes by ascending id; some may have no object in this scene.
    pub categories: Vec<SceneCategory>,
    /// The objects whose class is known, by ascending number.
    pub segments_info: Vec<Segment>,
}

/// A class of objects.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct SceneCategory {
    /// Its code in the semantic mask.
    pub id: u8,
    /// What it is called.
    pub name: String,
}

/// An object of a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Segment {
    /// Its number in the instance mask.
    pub id: u16,
    /// Its class.
    pub category_id: u8,
}

impl Classes {
    /// Class of an object; none if it is not known.
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

    /// The same classes, and of the objects only those that `keep` is true of.
    #[must_use]
    pub fn only(mut self, keep: impl Fn(u16) -> bool) -> Self {
        self.segments_info.retain(|segment| keep(segment.id));
        self
    }
}
