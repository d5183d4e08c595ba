//! The columns of a record: every scalar of the description under its own path, and what came out of the frame.
//!
//! A leaf that stands in several kinds of one object, such as the intensity of a light, stands here once. Of three numbers
//! each is a leaf, `….r`, `.g`, `.b` or `.x`, `.y`, `.z`. A list has its length as `LIST.count`, and its elements are
//! reached as `LIST.N` or `LIST.N.FIELD`.

use serde_json::Value;

use crate::described::Described;
use crate::frame::Frame;
use crate::record::RESULTS;
use crate::schema::{EXACT, Field, Shape};

/// A scalar of a record.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Leaf {
    /// Its name in questions.
    pub name: String,
    /// JSON pointer in the record; of an element's field, from the element.
    pub pointer: String,
    /// What stands there.
    pub kind: LeafKind,
    /// Unit of its number.
    pub unit: Option<&'static str>,
}

/// The water by name is that of a preset, or that of a water of the user's own.
const WATER: &str = "water.optics";
const OWN_WATER: &str = "/parameters/water/optics/name";

impl Leaf {
    /// What a record has here, as JSON.
    #[must_use]
    pub fn find<'a>(&self, record: &'a Value) -> Option<&'a Value> {
        let own_water = || at(record, OWN_WATER).filter(|_| self.name == WATER);
        at(record, &self.pointer).or_else(own_water)
    }
}

/// What stands at a JSON pointer, none of whose parts has a `~`. The common function makes two texts of each part, which took
/// half of the time of an import.
fn at<'a>(record: &'a Value, pointer: &str) -> Option<&'a Value> {
    let mut parts = pointer.split('/').skip(1);
    parts.try_fold(record, |value, part| match value {
        Value::Object(fields) => fields.get(part),
        Value::Array(items) => items.get(part.parse::<usize>().ok()?),
        _ => None,
    })
}

/// What stands in a leaf.
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
    /// A list, of which the length counts.
    Length,
}

/// A list of a description.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct List {
    /// Its name in questions.
    pub name: String,
    /// JSON pointer in the record.
    pub pointer: String,
    /// What stands in its elements, by name; the name is empty where an element is a scalar itself.
    pub element: Vec<Leaf>,
}

/// Everything that a record can be asked for by name, apart from metrics, labels, timings and artifacts.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Leaves {
    /// The scalars of the description, parents before children, and then the results.
    pub scalars: Vec<Leaf>,
    /// The lists of the description.
    pub lists: Vec<List>,
}

impl Leaves {
    /// The leaves of every record.
    #[must_use]
    pub fn of_records() -> Self {
        let mut leaves = Self::default();
        leaves.gather("", "/parameters", &Frame::SHAPE, None);
        for result in RESULTS {
            leaves.gather(result.name, result.pointer, &result.shape, result.unit);
        }
        leaves
    }

    fn gather(&mut self, name: &str, pointer: &str, shape: &Shape, unit: Option<&'static str>) {
        match shape {
            Shape::Number(_) => self.add(name, pointer, LeafKind::Number, unit),
            Shape::Integer(_, max) if *max > EXACT => self.add(name, pointer, LeafKind::Large, unit),
            Shape::Integer(..) => self.add(name, pointer, LeafKind::Whole, unit),
            Shape::Text(_) => self.add(name, pointer, LeafKind::Text, unit),
            Shape::Rgb(_) => self.triple(name, pointer, ["r", "g", "b"], unit),
            Shape::Vector(_) => self.triple(name, pointer, ["x", "y", "z"], unit),
            Shape::Object(fields) | Shape::OneOf(fields) | Shape::Short(_, fields) => {
                self.fields(name, pointer, fields);
            }
            Shape::Either(_, object) => {
                self.add(name, pointer, LeafKind::Text, None);
                self.gather(name, pointer, object, unit);
            }
            Shape::Tagged { tag, options, .. } => {
                self.add(
                    &joined(name, tag),
                    &format!("{pointer}/{tag}"),
                    LeafKind::Text,
                    None,
                );
                for option in *options {
                    self.fields(name, pointer, option.fields);
                }
            }
            Shape::List { element, .. } => {
                self.add(&joined(name, "count"), pointer, LeafKind::Length, None);
                let mut inside = Self::default();
                inside.gather("", "", element, unit);
                if !inside.scalars.is_empty() {
                    self.lists.push(List {
                        name: name.to_owned(),
                        pointer: pointer.to_owned(),
                        element: inside.scalars,
                    });
                }
            }
            Shape::Bool | Shape::Labels | Shape::Scalar => {}
        }
    }

    fn fields(&mut self, name: &str, pointer: &str, fields: &[Field]) {
        for field in fields {
            let pointer = format!("{pointer}/{}", field.name);
            self.gather(&joined(name, field.name), &pointer, &field.shape, field.unit);
        }
    }

    fn triple(&mut self, name: &str, pointer: &str, parts: [&str; 3], unit: Option<&'static str>) {
        for (position, part) in parts.into_iter().enumerate() {
            let pointer = format!("{pointer}/{position}");
            self.add(&joined(name, part), &pointer, LeafKind::Number, unit);
        }
    }

    fn add(&mut self, name: &str, pointer: &str, kind: LeafKind, unit: Option<&'static str>) {
        if self.scalars.iter().all(|leaf| leaf.name != name) {
            self.scalars.push(Leaf {
                name: name.to_owned(),
                pointer: pointer.to_owned(),
                kind,
                unit,
            });
        }
    }
}

fn joined(name: &str, field: &str) -> String {
    let dot = if name.is_empty() { "" } else { "." };
    format!("{name}{dot}{field}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table;

    /// The fields as the documentation has them, by the words that say what they are: an account of its own.
    fn documented() -> Vec<String> {
        let mut names = Vec::new();
        for row in table::rows() {
            // The kinds of an object share their leaves: `scene(files).rgb` is `scene.rgb`.
            let mut path = String::new();
            for (position, part) in row.path.split(['(', ')']).enumerate() {
                path += if position % 2 == 0 { part } else { "" };
            }
            let parts: &[&str] = match row.kind {
                "a number" | "a whole number" | "a string" | "a string or an object" => &[""],
                "a list of three numbers, R, G, B" => &[".r", ".g", ".b"],
                "a list of three numbers, x, y, z" => &[".x", ".y", ".z"],
                "a list" => &[".count"],
                _ => &[],
            };
            let is_short = row.limit.starts_with("a string is short for");
            if path != "count" && !is_short {
                names.extend(parts.iter().map(|part| format!("{path}{part}")));
            }
        }
        names.sort_unstable();
        names.dedup();
        names
    }

    #[test]
    fn every_leaf_of_a_description_has_its_own_name() {
        let Leaves { scalars, lists } = Leaves::of_records();
        let of_description =
            |leaf: &&Leaf| leaf.pointer.starts_with("/parameters/") && leaf.name != "water.optics";
        let mut names: Vec<String> = scalars
            .iter()
            .filter(of_description)
            .map(|leaf| leaf.name.clone())
            .collect();
        let lights = lists.iter().find(|list| list.name == "lights").unwrap();
        names.extend(
            lights
                .element
                .iter()
                .map(|leaf| format!("lights[].{}", leaf.name)),
        );
        names.sort_unstable();
        assert_eq!(names, documented());
        let all: Vec<_> = lists.iter().map(|list| list.name.as_str()).collect();
        assert_eq!(all, ["lights", "enhance", "metrics", "artifacts"]);
    }

    #[test]
    fn units_and_kinds_come_from_the_declaration() {
        let leaves = Leaves::of_records();
        let leaf = |name: &str| leaves.scalars.iter().find(|leaf| leaf.name == name).unwrap();
        assert_eq!(leaf("water.snow.density_per_m3").unit, Some("1/m³"));
        assert_eq!(
            leaf("water.optics.veiling_light.b").pointer,
            "/parameters/water/optics/veiling_light/2"
        );
        assert_eq!(
            (leaf("seed").kind, leaf("scene.seed").kind),
            (LeafKind::Large, LeafKind::Whole)
        );
        assert_eq!(leaf("absorption_per_m.r").unit, Some("1/m"));
        assert_eq!(leaf("lights.count").kind, LeafKind::Length);
    }
}
