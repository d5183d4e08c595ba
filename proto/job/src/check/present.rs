//! The fields of a checked description, by path.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::Value;

use super::Location;
use crate::fields::DOCUMENT;
use crate::node::Node;
use crate::schema::{Field, Presence, Shape};

pub(super) struct Present<'a> {
    pub(super) field: &'static Field,
    pub(super) location: Location,
    /// The object with this field.
    pub(super) object: &'a Node,
    pub(super) node: &'a Node,
    /// The alternative of its top-level field.
    pub(super) branch: usize,
}

impl Present<'_> {
    /// Whether its value differs from the default.
    pub(super) fn is_given(&self) -> bool {
        match self.field.presence {
            Presence::Default(text) => {
                let default = serde_json::from_str(text).unwrap_or_default();
                !is_same(&default, &self.node.canonical())
            }
            Presence::Required | Presence::Optional => true,
        }
    }
}

/// The fields of a description by path, such as `water.optics`, separately for each alternative of a top-level field.
#[derive(Default)]
pub(crate) struct Contents<'a> {
    pub(super) fields: Vec<Present<'a>>,
    /// Present fields, including defaults.
    present: BTreeSet<(String, usize)>,
    /// Fields with a value other than the default, and words of lists, as in `artifacts.raw`.
    given: BTreeSet<(String, usize)>,
    /// Number of alternatives of each top-level field.
    branches: BTreeMap<&'static str, usize>,
}

impl<'a> Contents<'a> {
    pub(super) fn read(document: &'a Node) -> Self {
        let mut contents = Self::default();
        if let Shape::Object(fields) = DOCUMENT {
            contents.add_fields(fields, document, &Location::default(), None);
        }
        contents
    }

    /// Whether a frame can have this path, given or by default. `own` is the frame's branch of a top-level field.
    pub(super) fn has(&self, path: &str, own: Option<(&str, usize)>) -> bool {
        self.holds(&self.present, path, own)
    }

    /// Whether a frame can have this path with a value other than the default.
    pub(super) fn has_given(&self, path: &str, own: Option<(&str, usize)>) -> bool {
        self.holds(&self.given, path, own)
    }

    /// Whether every frame has this path.
    pub(super) fn is_certain(&self, path: &str) -> bool {
        let mut branches = self.branches_of(top_of(path));
        branches.all(|branch| self.present.contains(&(path.to_owned(), branch)))
    }

    fn holds(&self, set: &BTreeSet<(String, usize)>, path: &str, own: Option<(&str, usize)>) -> bool {
        let top = top_of(path);
        match own {
            Some((own_top, branch)) if own_top == top => set.contains(&(path.to_owned(), branch)),
            _ => self
                .branches_of(top)
                .any(|branch| set.contains(&(path.to_owned(), branch))),
        }
    }

    fn branches_of(&self, top: &str) -> std::ops::Range<usize> {
        0..self.branches.get(top).copied().unwrap_or_default()
    }

    /// `branch` is `None` at the top level.
    fn add_fields(
        &mut self,
        fields: &'static [Field],
        object: &'a Node,
        location: &Location,
        branch: Option<usize>,
    ) {
        for field in fields {
            let Some(node) = object.get(field.name) else {
                continue;
            };
            let location = location.field(field.name);
            let values = node.alternatives(&location.pointer);
            if branch.is_none() {
                self.branches.insert(field.name, values.len());
            }
            for (position, (pointer, value)) in values.into_iter().enumerate() {
                let location = Location {
                    pointer,
                    name: location.name.clone(),
                };
                self.add_inside(&field.shape, value, &location, branch.unwrap_or(position));
            }
            self.add(Present {
                field,
                location,
                object,
                node,
                branch: branch.unwrap_or_default(),
            });
        }
    }

    fn add(&mut self, present: Present<'a>) {
        let key = (present.location.path(""), present.branch);
        if present.is_given() {
            self.given.insert(key.clone());
        }
        self.present.insert(key);
        self.fields.push(present);
    }

    /// Adds the contents of a value.
    fn add_inside(&mut self, shape: &'static Shape, value: &'a Node, location: &Location, branch: usize) {
        match (shape, value) {
            (Shape::Object(fields) | Shape::Short(_, fields) | Shape::OneOf(fields), Node::Object(_)) => {
                self.add_fields(fields, value, location, Some(branch));
            }
            (Shape::Tagged { tag, options, .. }, Node::Object(_)) => {
                let written = value.get(tag).map(|tag| tag.strings("")).unwrap_or_default();
                let option = options
                    .iter()
                    .find(|option| written.iter().any(|(_, name)| *name == option.name));
                if let Some(option) = option {
                    self.add_fields(option.fields, value, location, Some(branch));
                }
            }
            (Shape::Either(_, object), Node::Object(_)) => self.add_inside(object, value, location, branch),
            (Shape::List { element, .. }, Node::List(items)) => {
                for (position, item) in items.iter().enumerate() {
                    let location = location.item(position);
                    for (pointer, value) in item.alternatives(&location.pointer) {
                        let location = Location {
                            pointer,
                            name: location.name.clone(),
                        };
                        self.add_inside(element, value, &location, branch);
                    }
                }
            }
            (Shape::Text(_), Node::Constant(word)) if location.name.ends_with(']') => {
                let word = word.as_str().unwrap_or_default();
                self.given
                    .insert((format!("{}.{word}", location.path("")), branch));
            }
            _ => {}
        }
    }
}

/// Compares values; 2 and 2.0 are equal.
fn is_same(left: &Value, right: &Value) -> bool {
    match (left, right) {
        (Value::Number(left), Value::Number(right)) => left.as_f64() == right.as_f64(),
        (Value::Array(left), Value::Array(right)) => {
            left.len() == right.len() && left.iter().zip(right).all(|(left, right)| is_same(left, right))
        }
        _ => left == right,
    }
}

pub(super) fn top_of(path: &str) -> &str {
    path.split(['.', '[']).next().unwrap_or_default()
}
