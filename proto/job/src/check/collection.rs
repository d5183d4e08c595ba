//! Collections of uploaded scenes. A description contains the ids of their scenes, so that a job does not change when
//! a collection grows.

use std::collections::BTreeSet;

use serde_json::{Map, Value, json};

use super::{Checker, Location};
use crate::invalid::quote;

pub(super) const KIND: &str = "collection";

impl Checker<'_> {
    /// Returns the object of a collection with the ids of its scenes: `{"grid": […]}` with `each`, else a choice.
    /// `None` for other objects and if the ids are present.
    pub(super) fn expand_collection(
        &mut self,
        location: &Location,
        kind: &str,
        map: &Map<String, Value>,
    ) -> Option<Map<String, Value>> {
        let name = map.get("name")?.as_str()?;
        if kind != KIND || map.contains_key("id") {
            return None;
        }
        let Some(ids) = self.vocabulary.collections.get(name) else {
            let known: Vec<String> = self.vocabulary.collections.keys().cloned().collect();
            let (location, value) = (location.field("name"), Value::from(name));
            let message = format!("{location} {} is not a collection of this service", quote(&value));
            self.refuse(|| location.error(message).value(&value).allowed(known, name));
            return None;
        };
        let law = if map.get("each") == Some(&Value::Bool(false)) {
            "choice"
        } else {
            "grid"
        };
        let mut map = map.clone();
        map.insert("id".to_owned(), json!({law: ids}));
        Some(map)
    }
}

/// The names of all collections that a description may mention, without further checks.
pub(crate) fn named(description: &Value) -> BTreeSet<String> {
    match description {
        Value::Array(items) => items.iter().flat_map(named).collect(),
        Value::Object(map) => {
            let is_one = map.get("kind").and_then(Value::as_str) == Some(KIND);
            let name = map.get("name").and_then(Value::as_str).filter(|_| is_one);
            let inside = map.values().flat_map(named);
            name.map(str::to_owned).into_iter().chain(inside).collect()
        }
        _ => BTreeSet::new(),
    }
}
