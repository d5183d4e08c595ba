//! Collections of uploaded scenes: a description holds the ids of their scenes, so that a job stays what it was when a
//! collection grows.

use std::collections::BTreeSet;

use serde_json::{Map, Value, json};

use super::{Checker, Place};
use crate::invalid::{FieldError, quote};

/// The kind of scene that is a collection.
pub(super) const KIND: &str = "collection";

impl Checker<'_> {
    /// The object of a collection with the ids of its scenes: `{"grid": […]}` of them with `each`, else a choice. None of other
    /// objects, and where the ids are there already.
    pub(super) fn with_scenes(
        &mut self,
        at: &Place,
        kind: &str,
        map: &Map<String, Value>,
    ) -> Option<Map<String, Value>> {
        let name = map.get("name")?.as_str()?;
        if kind != KIND || self.trusting || map.contains_key("id") {
            return None;
        }
        let Some(ids) = self.vocabulary.collections.get(name) else {
            let known: Vec<String> = self.vocabulary.collections.keys().cloned().collect();
            let (at, value) = (at.field("name"), Value::from(name));
            let message = format!(
                "{at} {} is not a collection of uploaded scenes here",
                quote(&value)
            );
            self.refuse(|| {
                FieldError::new(&at.pointer, message)
                    .value(&value)
                    .allowed(known, name)
            });
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

/// The names of all collections that a description may mean, without a check of anything else.
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
