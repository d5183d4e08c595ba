//! Values of a record that also have a column. Pages show the values of the record, which has a digest; filters and orders use the
//! columns.

use serde_json::{Value, json};
use spec::{Leaf, LeafKind};

/// The position of a column's value in a record.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum RecordValue {
    Leaf(Leaf),
    Metric {
        subject: String,
        metric: String,
    },
    Warned,
    /// The digest of the artifact of a kind.
    Artifact(String),
    /// The label of a name.
    Label(String),
}

impl RecordValue {
    pub(crate) fn is_label(&self) -> bool {
        matches!(self, Self::Label(_))
    }

    /// The value, as pages have it.
    pub(crate) fn read(&self, record: &Value) -> Value {
        match self {
            Self::Leaf(leaf) => leaf_of(leaf, record).unwrap_or_default(),
            Self::Metric { subject, metric } => {
                let value = record["measurements"][subject][metric].as_f64();
                value.map(number).unwrap_or_default()
            }
            Self::Warned => json!(record["warnings"].as_array().is_some_and(|all| !all.is_empty())),
            Self::Label(name) => record["parameters"]["labels"][name].clone(),
            Self::Artifact(kind) => {
                let all = record["artifacts"].as_array();
                let entry = all.and_then(|all| all.iter().find(|entry| entry["kind"] == **kind));
                entry.map(|entry| entry["digest"].clone()).unwrap_or_default()
            }
        }
    }
}

fn leaf_of(leaf: &Leaf, record: &Value) -> Option<Value> {
    let value = leaf.find(record)?;
    match leaf.kind {
        LeafKind::Number => value.as_f64().map(number),
        LeafKind::Whole => value.as_i64().map(Value::from),
        LeafKind::Large => value.as_u64().map(Value::from),
        LeafKind::Text => value.as_str().map(Value::from),
        LeafKind::Length => value.as_array().map(|items| json!(items.len())),
    }
}

/// Whole ones read better as whole numbers, and were returned so when all numbers were doubles.
pub(crate) fn number(number: f64) -> Value {
    if number.fract() == 0.0 && number.abs() < 9e15 {
        json!(number as i64)
    } else {
        json!(number)
    }
}
