//! The columns of a record: every scalar of the description by its path, and the results of the frame.
//!
//! A leaf common to several kinds of one object, such as the intensity of a light, occurs once. Three numbers are
//! three leaves, `….r`, `.g`, `.b` or `.x`, `.y`, `.z`; two are `….across` and `.down`. The length of a list is `LIST.count`, and its elements are
//! `LIST.N` or `LIST.N.FIELD`.

use serde_json::Value;

use crate::described::Described;
use crate::frame::Frame;
use crate::results::RESULTS;
use crate::schema::{EXACT, Field, Shape};

/// A scalar of a record.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Leaf {
    /// Name in queries.
    pub name: String,
    /// JSON pointer in the record; for a field of a list element, relative to the element.
    pub pointer: String,
    /// Type of the value.
    pub kind: LeafKind,
    /// Unit of a number.
    pub unit: Option<&'static str>,
    /// Meaning.
    pub doc: &'static str,
}

/// The name of the water, from a preset or a user-defined water.
const WATER: &str = "water.optics";
const OWN_WATER: &str = "/parameters/water/optics/name";

impl Leaf {
    /// The JSON value of this leaf in a record.
    #[must_use]
    pub fn find<'a>(&self, record: &'a Value) -> Option<&'a Value> {
        self.pointers().find_map(|pointer| value_at(record, pointer))
    }

    /// Possible locations in a record, as JSON pointers; the first present one counts.
    pub fn pointers(&self) -> impl Iterator<Item = &str> {
        let own_water = (self.name == WATER).then_some(OWN_WATER);
        std::iter::once(self.pointer.as_str()).chain(own_water)
    }
}

/// The value at a JSON pointer without `~` escapes. `Value::pointer` allocates two strings per step, which took half
/// of the time of an import.
fn value_at<'a>(record: &'a Value, pointer: &str) -> Option<&'a Value> {
    let mut parts = pointer.split('/').skip(1);
    parts.try_fold(record, |value, part| match value {
        Value::Object(fields) => fields.get(part),
        Value::Array(items) => items.get(part.parse::<usize>().ok()?),
        _ => None,
    })
}

/// Type of a leaf.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LeafKind {
    /// A number.
    Number,
    /// A whole number that a double holds exactly.
    Whole,
    /// A whole number up to 2^64 − 1.
    Large,
    /// A string.
    Text,
    /// A list, represented by its length.
    Length,
}

/// A list of a description.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct List {
    /// Name in queries.
    pub name: String,
    /// JSON pointer in the record.
    pub pointer: String,
    /// The leaves of its elements by name; the name is empty for scalar elements.
    pub element: Vec<Leaf>,
}

/// All queryable values of a record, except metrics, labels, timings and artifacts.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Leaves {
    /// Scalars of the description, parents before children, then the results.
    pub scalars: Vec<Leaf>,
    /// The lists of the description.
    pub lists: Vec<List>,
}

impl Leaves {
    /// The leaves of every record.
    #[must_use]
    pub fn of_records() -> Self {
        let mut leaves = Self::default();
        leaves.gather(&Spot::default().below("", "/parameters"), &Frame::SHAPE);
        for result in RESULTS {
            let spot = Spot {
                unit: result.unit,
                doc: result.doc,
                ..Spot::default().below(result.name, result.pointer)
            };
            leaves.gather(&spot, &result.shape);
        }
        leaves
    }

    fn gather(&mut self, spot: &Spot, shape: &Shape) {
        match shape {
            Shape::Number(_) => self.add(spot, LeafKind::Number),
            Shape::Integer(_, max) if *max > EXACT => self.add(spot, LeafKind::Large),
            Shape::Integer(..) => self.add(spot, LeafKind::Whole),
            Shape::Text(_) => self.add(spot, LeafKind::Text),
            Shape::Rgb(_) => self.parts(spot, &["r", "g", "b"], LeafKind::Number),
            Shape::Vector(_) => self.parts(spot, &["x", "y", "z"], LeafKind::Number),
            Shape::Pair(..) => self.parts(spot, &["across", "down"], LeafKind::Whole),
            // The object has only the field that its string abbreviates.
            Shape::Short(_, [field]) => {
                let inside = spot.below("", &format!("/{}", field.name));
                self.gather(&inside, &field.shape);
            }
            Shape::Object(fields) | Shape::OneOf(fields) | Shape::Short(_, fields) => {
                self.fields(spot, fields);
            }
            Shape::Either(_, object) => {
                self.add(
                    &Spot {
                        unit: None,
                        ..spot.clone()
                    },
                    LeafKind::Text,
                );
                self.gather(spot, object);
            }
            Shape::Tagged { tag, options, .. } => {
                let tagged = spot.below(tag, &format!("/{tag}"));
                self.add(&Spot { unit: None, ..tagged }, LeafKind::Text);
                for option in *options {
                    self.fields(spot, option.fields);
                }
            }
            Shape::List { element, .. } => self.list(spot, element),
            Shape::Bool | Shape::Labels | Shape::Scalar => {}
        }
    }

    fn list(&mut self, spot: &Spot, element: &Shape) {
        let count = Spot {
            name: joined(&spot.name, "count"),
            unit: None,
            ..spot.clone()
        };
        self.add(&count, LeafKind::Length);
        let mut inside = Self::default();
        let alone = Spot {
            unit: spot.unit,
            doc: spot.doc,
            ..Spot::default()
        };
        inside.gather(&alone, element);
        if !inside.scalars.is_empty() {
            self.lists.push(List {
                name: spot.name.clone(),
                pointer: spot.pointer.clone(),
                element: inside.scalars,
            });
        }
    }

    fn fields(&mut self, spot: &Spot, fields: &[Field]) {
        for field in fields {
            let spot = Spot {
                unit: field.unit,
                doc: field.doc,
                ..spot.below(field.name, &format!("/{}", field.name))
            };
            self.gather(&spot, &field.shape);
        }
    }

    fn parts(&mut self, spot: &Spot, parts: &[&str], kind: LeafKind) {
        for (position, part) in parts.iter().enumerate() {
            self.add(&spot.below(part, &format!("/{position}")), kind);
        }
    }

    fn add(&mut self, spot: &Spot, kind: LeafKind) {
        if self.scalars.iter().all(|leaf| leaf.name != spot.name) {
            self.scalars.push(Leaf {
                name: spot.name.clone(),
                pointer: spot.pointer.clone(),
                kind,
                unit: spot.unit,
                doc: spot.doc,
            });
        }
    }
}

/// A location in a record with its declaration.
#[derive(Debug, Clone, Default)]
struct Spot {
    name: String,
    pointer: String,
    unit: Option<&'static str>,
    doc: &'static str,
}

impl Spot {
    fn below(&self, name: &str, pointer: &str) -> Self {
        Self {
            name: joined(&self.name, name),
            pointer: format!("{}{pointer}", self.pointer),
            ..self.clone()
        }
    }
}

fn joined(name: &str, field: &str) -> String {
    let dot = if name.is_empty() || field.is_empty() {
        ""
    } else {
        "."
    };
    format!("{name}{dot}{field}")
}

#[cfg(test)]
mod tests;
