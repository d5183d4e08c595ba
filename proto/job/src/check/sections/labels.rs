//! Labels: user-defined scalars.

use serde_json::{Map, Number, Value};

use crate::check::{Checker, Location, constant, whole};
use crate::node::{Node, float};
use crate::schema::{MAX_LABEL_KEY, MAX_LABEL_TEXT, MAX_LABELS, Shape};

impl Checker<'_> {
    pub(crate) fn check_labels(&mut self, location: &Location, map: &Map<String, Value>) -> Option<Node> {
        if map.len() > MAX_LABELS {
            let message = format!(
                "{location} has {} entries; must be at most {MAX_LABELS}",
                map.len()
            );
            self.refuse(|| {
                location
                    .error(message)
                    .limit(format!("at most {MAX_LABELS} entries"))
            });
            return None;
        }
        let mut labels = Vec::new();
        for (key, value) in map {
            let location = location.field(key);
            if key.is_empty()
                || key.len() > MAX_LABEL_KEY
                || !key
                    .chars()
                    .all(|letter: char| letter.is_ascii_alphanumeric() || "_.-".contains(letter))
            {
                let limit = format!("1 to {MAX_LABEL_KEY} of A-Z a-z 0-9 _ . -");
                self.refuse(|| {
                    location
                        .error(format!("{location}: the name must be {limit}"))
                        .limit(limit)
                });
            }
            if let Some(node) = self.check(&location, &Shape::Scalar, true, value) {
                labels.push((key.clone(), node));
            }
        }
        Some(Node::Object(labels))
    }

    /// Checks a label. A whole number is stored the same way, whether written 2 or 2.0; beyond 64 bits its digits are lost in
    /// reading, so it is refused.
    pub(crate) fn check_scalar(&mut self, location: &Location, value: &Value) -> Option<Node> {
        match value {
            Value::Bool(_) => Some(Node::Constant(value.clone())),
            Value::Number(number) if number.as_f64().is_some_and(|size| !is_kept_exactly(number, size)) => {
                self.refuse_range(
                    location,
                    value,
                    "-9223372036854775808 to 18446744073709551615; write it as text to keep all digits",
                )
            }
            Value::Number(number) => Some(match (whole(value).and_then(constant), number.as_f64()) {
                (Some(whole), _) => whole,
                (None, float_value) => Node::Constant(float(float_value?)),
            }),
            Value::String(text) if text.chars().count() <= MAX_LABEL_TEXT => {
                Some(Node::Constant(value.clone()))
            }
            Value::String(_) => {
                self.refuse_range(location, value, &format!("at most {MAX_LABEL_TEXT} characters"))
            }
            _ => self.refuse_kind(location, &Shape::Scalar, true, value),
        }
    }
}

/// Whether no digit of a number was lost in reading: integers of 64 bits, and smaller fractions.
fn is_kept_exactly(number: &Number, size: f64) -> bool {
    /// The first numbers beyond 64 bits.
    const BEYOND: (f64, f64) = (-9_223_372_036_854_775_808.0, 18_446_744_073_709_551_616.0);
    number.is_i64() || number.is_u64() || (size > BEYOND.0 && size < BEYOND.1)
}
