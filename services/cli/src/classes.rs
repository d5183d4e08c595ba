//! The classes of the objects in a scene: those that all procedural scenes share, or those that came with an upload.

use std::collections::{BTreeSet, HashMap};

use client::{Client, ImageRow};
use scenes::categories::CATEGORIES;

use crate::exit::Failure;

/// Columns from which the classes of an image follow.
pub const COLUMNS: [&str; 2] = ["scene.kind", "scene.id"];

/// Codes and names of classes.
pub type Named = BTreeSet<(u8, String)>;

/// The classes of scenes; each scene is requested once.
pub struct SceneClasses<'a> {
    client: &'a Client,
    known: HashMap<String, Named>,
}

impl<'a> SceneClasses<'a> {
    pub fn new(client: &'a Client) -> Self {
        Self {
            client,
            known: HashMap::new(),
        }
    }

    /// Adds the classes of an image, from its row of columns.
    pub fn add(&mut self, row: &ImageRow, all: &mut Named) -> Result<(), Failure> {
        let id = row.text("scene.id").unwrap_or_default();
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
        let classes = self.client.scene(id)?.and_then(|scene| scene.classes);
        let categories = classes.into_iter().flat_map(|classes| classes.categories);
        Ok(categories.map(|category| (category.id, category.name)).collect())
    }
}

fn procedural() -> Named {
    let fixed = CATEGORIES.iter();
    fixed
        .map(|(category, name)| (*category as u8, (*name).to_owned()))
        .collect()
}
