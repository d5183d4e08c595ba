//! Uploaded scenes that have the pose of their camera.

use std::collections::{BTreeSet, HashMap};

use cli::exit::Failure;
use client::{Client, ImageQuery};

/// Most scenes that an error names.
const MAX_NAMED: usize = 3;

/// Whether scenes have a pose; each scene is requested once.
pub(crate) struct PosedScenes<'a> {
    client: &'a Client,
    known: HashMap<String, bool>,
}

impl<'a> PosedScenes<'a> {
    pub(crate) fn new(client: &'a Client) -> Self {
        Self {
            client,
            known: HashMap::new(),
        }
    }

    pub(crate) fn contains(&mut self, id: &str) -> Result<bool, Failure> {
        if let Some(posed) = self.known.get(id) {
            return Ok(*posed);
        }
        let scene = self.client.scene(id)?;
        let posed = scene.is_some_and(|scene| scene.world_from_camera.is_some());
        self.known.insert(id.to_owned(), posed);
        Ok(posed)
    }

    /// A list for people of the scenes without a pose among the images that a filter matches; `None` if there are none.
    pub(crate) fn list_unposed(&mut self, dataset: &str, filter: &str) -> Result<Option<String>, Failure> {
        let fields = ["scene.id".to_owned()];
        let query = ImageQuery {
            dataset: Some(dataset),
            filter,
            order_by: None,
            fields: &fields,
            limit: usize::MAX,
        };
        let mut ids = BTreeSet::new();
        for rows in self.client.image_pages(query) {
            ids.extend(
                rows?
                    .iter()
                    .filter_map(|row| row.text("scene.id").map(str::to_owned)),
            );
        }
        let mut lacking = Vec::new();
        for id in ids {
            if !self.contains(&id)? {
                lacking.push(id);
            }
        }
        let more = match lacking.len().saturating_sub(MAX_NAMED) {
            0 => String::new(),
            more => format!(" and {more} more"),
        };
        lacking.truncate(MAX_NAMED);
        Ok((!lacking.is_empty()).then(|| format!("`{}`{more}", lacking.join("`, `"))))
    }
}
