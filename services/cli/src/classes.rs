//! The classes of the objects in a scene: those that all procedural scenes share, or those that came with an upload.

use std::collections::{BTreeSet, HashMap};

use scenes::categories::CATEGORIES;
use serde_json::Value;
use spec::SceneCategory;

use crate::exit::Failure;
use crate::remote::{Remote, encode};

/// Columns from which the classes of an image follow.
pub const COLUMNS: [&str; 2] = ["scene.kind", "scene.id"];

/// Codes and names of classes.
pub type Named = BTreeSet<(u8, String)>;

/// The classes of scenes, each asked for once.
pub struct SceneClasses<'a> {
    remote: &'a Remote,
    known: HashMap<String, Named>,
}

impl<'a> SceneClasses<'a> {
    pub fn new(remote: &'a Remote) -> Self {
        Self {
            remote,
            known: HashMap::new(),
        }
    }

    /// Adds the classes of an image, from its row of columns.
    pub fn add(&mut self, row: &Value, all: &mut Named) -> Result<(), Failure> {
        let id = row["scene.id"].as_str().unwrap_or_default();
        if !self.known.contains_key(id) {
            let classes = if id.is_empty() {
                procedural()
            } else {
                self.uploaded(id)?
            };
            self.known.insert(id.to_owned(), classes);
        }
        all.extend(self.known[id].iter().cloned());
        Ok(())
    }

    fn uploaded(&self, id: &str) -> Result<Named, Failure> {
        let scene = self.remote.find(&format!("/v1/scenes/{}", encode(id)))?;
        let categories = scene.and_then(|scene| scene.pointer("/classes/categories").cloned());
        let categories: Option<Vec<SceneCategory>> =
            serde_json::from_value(categories.unwrap_or_default()).ok();
        let named = categories.into_iter().flatten();
        Ok(named.map(|category| (category.id, category.name)).collect())
    }
}

fn procedural() -> Named {
    let fixed = CATEGORIES.iter();
    fixed
        .map(|(category, name)| (*category as u8, (*name).to_owned()))
        .collect()
}
