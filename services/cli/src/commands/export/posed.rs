//! Which uploaded scenes came with the pose of their camera.

use std::collections::{BTreeSet, HashMap};

use cli::exit::Failure;
use cli::images::Question;
use cli::remote::{Remote, encode};

/// Most scenes that an error names.
const MAX_NAMED: usize = 3;

/// Whether scenes have a pose; each is asked for once.
pub(super) struct PosedScenes<'a> {
    remote: &'a Remote,
    known: HashMap<String, bool>,
}

impl<'a> PosedScenes<'a> {
    pub(super) fn new(remote: &'a Remote) -> Self {
        Self {
            remote,
            known: HashMap::new(),
        }
    }

    pub(super) fn contains(&mut self, id: &str) -> Result<bool, Failure> {
        if let Some(posed) = self.known.get(id) {
            return Ok(*posed);
        }
        let scene = self.remote.find(&format!("/v1/scenes/{}", encode(id)))?;
        let posed = scene.is_some_and(|scene| !scene["world_from_camera"].is_null());
        self.known.insert(id.to_owned(), posed);
        Ok(posed)
    }

    /// The scenes without a pose among those of the images that a filter takes, as a list for people; none if there are none.
    pub(super) fn without(&mut self, dataset: &str, filter: &str) -> Result<Option<String>, Failure> {
        let fields = ["scene.id".to_owned()];
        let question = Question {
            dataset: Some(dataset),
            filter,
            order_by: None,
            fields: &fields,
            limit: usize::MAX,
        };
        let mut ids = BTreeSet::new();
        question.pages(self.remote, |rows| {
            ids.extend(
                rows.iter()
                    .filter_map(|row| Some(row["scene.id"].as_str()?.to_owned())),
            );
            Ok(())
        })?;
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
