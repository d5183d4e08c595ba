//! Reads the values of a page out of records, leaves of the description in one pass.

use std::collections::BTreeSet;
use std::fmt;

use serde::de::{Deserializer, IgnoredAny, MapAccess, Visitor};
use serde_json::{Map, Value, json};
use spec::{Leaf, LeafKind};

use crate::query::filter::{Bind, raised};
use crate::query::leaf_tree::LeafTree;
use crate::query::record_value::{RecordValue, number};

/// The values that a page needs from each record.
#[derive(Default)]
pub(crate) struct Wanted {
    leaves: Vec<Leaf>,
    members: Members,
}

/// The position of a value in [`Read`].
pub(crate) enum Place {
    Leaf(usize, LeafKind),
    Member(RecordValue),
}

impl Wanted {
    /// Adds a value and returns its place.
    pub(crate) fn add(&mut self, found: &RecordValue) -> Place {
        if let RecordValue::Leaf(leaf) = found {
            self.leaves.push(leaf.clone());
            return Place::Leaf(self.leaves.len() - 1, leaf.kind);
        }
        self.members.add(found);
        Place::Member(found.clone())
    }

    pub(crate) fn reader(self) -> Reader {
        Reader {
            leaves: LeafTree::new(&self.leaves),
            members: self.members,
        }
    }
}

/// Reads selected values of records. A page reads a hundred records; parsing them completely would take half of its time.
pub(crate) struct Reader {
    leaves: LeafTree,
    members: Members,
}

/// The selected values of a record.
pub(crate) struct Read {
    leaves: Vec<Option<Bind>>,
    members: Value,
}

impl Reader {
    pub(crate) fn read(&self, record: &str) -> Result<Read, serde_json::Error> {
        Ok(Read {
            leaves: self
                .leaves
                .read(&mut serde_json::Deserializer::from_str(record))?,
            members: self.members.read(record)?,
        })
    }
}

impl Read {
    /// The value, as pages have it.
    pub(crate) fn value(&self, place: &Place) -> Value {
        match place {
            Place::Member(found) => found.read(&self.members),
            Place::Leaf(index, kind) => match &self.leaves[*index] {
                Some(Bind::Number(value)) => number(*value),
                Some(Bind::Whole(value)) if *kind == LeafKind::Large => json!(raised(*value)),
                Some(Bind::Whole(value)) => json!(value),
                Some(Bind::Text(text)) => json!(text),
                None => Value::Null,
            },
        }
    }
}

/// Members of a record.
#[derive(Default)]
struct Members(BTreeSet<&'static str>);

impl Members {
    fn add(&mut self, found: &RecordValue) {
        let member = match found {
            RecordValue::Leaf(_) => return,
            RecordValue::Metric { .. } => "measurements",
            RecordValue::Warned => "warnings",
            RecordValue::Artifact(_) => "artifacts",
            RecordValue::Label(_) => "parameters",
        };
        self.0.insert(member);
    }

    /// A record with these members alone.
    fn read(&self, record: &str) -> Result<Value, serde_json::Error> {
        if self.0.is_empty() {
            return Ok(Value::Null);
        }
        serde_json::Deserializer::from_str(record).deserialize_map(self)
    }
}

impl<'de> Visitor<'de> for &Members {
    type Value = Value;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a record")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut all: A) -> Result<Value, A::Error> {
        let mut members = Map::new();
        while let Some(name) = all.next_key::<String>()? {
            if self.0.contains(name.as_str()) {
                members.insert(name, all.next_value()?);
            } else {
                all.next_value::<IgnoredAny>()?;
            }
        }
        Ok(Value::Object(members))
    }
}
