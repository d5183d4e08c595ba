//! Checks a description against the schema and collects every error.

mod across;
pub(crate) mod collection;
mod extremes;
mod law;
mod names;
mod object;
mod own_water;
mod present;
mod rules;
mod sections;
mod tagged;
mod values;
mod written_enhancement;

use std::collections::BTreeSet;

use serde_json::{Number, Value};

use crate::invalid::{FieldError, MAX_ERRORS, quote};
use crate::json::{describe, step};
use crate::law::find_key;
use crate::node::{Node, float};
use crate::schema::{EXACT, Range, Shape};
use crate::vocabulary::Vocabulary;

pub(crate) use daylight::find_black_frames;
pub(crate) use lights::has_lamps;
pub(crate) use names::is_dataset;
pub(crate) use sections::enhance::names_in;
pub(crate) use sections::networks::find_enhancers;
use sections::{daylight, lights, truth};
pub(crate) use truth::is_traced;
pub(crate) use values::{find_lists, find_values, has_procedural_scene};

/// Walks the document and the schema in parallel.
pub(crate) struct Checker<'v> {
    pub(crate) vocabulary: &'v Vocabulary,
    /// The job's seed, for the laws' streams.
    pub(crate) seed: u64,
    pub(crate) errors: Vec<FieldError>,
}

/// Location of a value in the document.
#[derive(Debug, Clone, Default)]
pub(crate) struct Location {
    /// JSON pointer.
    pub(crate) pointer: String,
    /// Name in messages, such as `lights[0].x`, without the steps into distributions.
    pub(crate) name: String,
}

impl Location {
    pub(crate) fn field(&self, key: &str) -> Self {
        let dot = if self.name.is_empty() { "" } else { "." };
        Self {
            pointer: format!("{}{}", self.pointer, step(key)),
            name: format!("{}{dot}{key}", self.name),
        }
    }

    /// Its name with `item` in place of each list position.
    pub(crate) fn path(&self, item: &str) -> String {
        let mut parts = self.name.split('[');
        let first = parts.next().unwrap_or_default().to_owned();
        parts.fold(first, |path, part| {
            let rest = part.split_once(']').map_or(part, |(_, rest)| rest);
            path + item + rest
        })
    }

    pub(crate) fn error(&self, message: impl Into<String>) -> FieldError {
        FieldError::new(&self.pointer, message)
    }

    pub(crate) fn item(&self, position: usize) -> Self {
        Self {
            pointer: format!("{}/{position}", self.pointer),
            name: format!("{}[{position}]", self.name),
        }
    }

    /// A value of a choice or grid at this location.
    pub(crate) fn alternative(&self, law: &str, position: usize) -> Self {
        Self {
            pointer: format!("{}/{law}/{position}", self.pointer),
            name: self.name.clone(),
        }
    }
}

impl std::fmt::Display for Location {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        if self.name.is_empty() {
            f.write_str("the description")
        } else {
            write!(f, "`{}`", self.name)
        }
    }
}

impl<'v> Checker<'v> {
    pub(crate) fn new(vocabulary: &'v Vocabulary, seed: u64) -> Self {
        Self {
            vocabulary,
            seed,
            errors: Vec::new(),
        }
    }
}

impl Checker<'_> {
    /// Adds an error if there is room; `error` is only called then.
    pub(crate) fn refuse(&mut self, error: impl FnOnce() -> FieldError) {
        match self.errors.len() {
            0..MAX_ERRORS => self.errors.push(error()),
            MAX_ERRORS => self.errors.push(FieldError::too_many()),
            _ => {}
        }
    }

    /// The checked value, or `None` with its errors added. Objects keep their valid fields, so that checks across
    /// fields can continue.
    pub(crate) fn check(
        &mut self,
        location: &Location,
        shape: &Shape,
        laws: bool,
        value: &Value,
    ) -> Option<Node> {
        if let Value::Object(map) = value
            && !matches!(shape, Shape::Labels)
            && let Some(key) = find_key(map)
        {
            if let Some(rest) = self.refuse_misnamed_tiles(location, shape, map) {
                return self.check(location, shape, laws, &rest);
            }
            if laws {
                return self.check_law(location, shape, key, map);
            }
            self.refuse(|| location.error(format!("{location} cannot be a distribution")));
            return None;
        }
        match (shape, value) {
            (Shape::Number(range), Value::Number(_)) => self.check_number(location, range, value),
            (Shape::Integer(min, max), Value::Number(_)) => self.check_integer(location, *min, *max, value),
            (Shape::Text(names), Value::String(text)) => self.check_text(location, *names, text),
            (Shape::Bool, Value::Bool(_)) => Some(Node::Constant(value.clone())),
            (Shape::Scalar, _) => self.check_scalar(location, value),
            (
                Shape::List {
                    element,
                    max,
                    distinct,
                },
                Value::Array(items),
            ) => self.check_list(location, element, *max, *distinct, items),
            (Shape::Rgb(range) | Shape::Vector(range), Value::Array(items)) if items.len() == 3 => {
                self.check_items(location, &Shape::Number(*range), items)
            }
            (Shape::Pair(min, max), Value::Array(items)) if items.len() == 2 => {
                self.check_items(location, &Shape::Integer(*min, *max), items)
            }
            (Shape::Object(fields), Value::Object(map)) => Some(self.check_object(location, fields, map)),
            (Shape::OneOf(fields), Value::Object(map)) => self.check_one_of(location, fields, map),
            (
                Shape::Tagged {
                    tag,
                    presence,
                    options,
                },
                Value::Object(map),
            ) => self.check_tagged(location, tag, *presence, options, map),
            (Shape::Short(field, fields), _) => self.check_short(location, field, fields, value),
            (Shape::Either(names, _), Value::String(text)) => self.check_text(location, *names, text),
            (Shape::Either(_, object), Value::Object(_)) => self.check(location, object, laws, value),
            (Shape::Labels, Value::Object(map)) => self.check_labels(location, map),
            _ => self.refuse_kind(location, shape, laws, value),
        }
    }

    fn refuse_kind(&mut self, location: &Location, shape: &Shape, laws: bool, value: &Value) -> Option<Node> {
        self.refuse(|| {
            let or_law = if laws { " or a distribution" } else { "" };
            let message = format!(
                "{location} must be {}{or_law}, but is {}",
                shape.describe(),
                describe(value)
            );
            let error = location.error(message).value(value).limit(shape.describe());
            match value {
                Value::Object(map) if laws => {
                    error.allowed(crate::law::KEYS, map.keys().next().map_or("", String::as_str))
                }
                _ => error,
            }
        });
        None
    }

    fn check_number(&mut self, location: &Location, range: &Range, value: &Value) -> Option<Node> {
        let number = value.as_f64()?;
        if range.holds(number) {
            return Some(Node::Constant(float(number)));
        }
        self.refuse_range(location, value, &range.to_string())
    }

    fn check_integer(&mut self, location: &Location, min: i128, max: i128, value: &Value) -> Option<Node> {
        let limit = Shape::Integer(min, max).limit();
        match whole(value) {
            Some(number) if (min..=max).contains(&number) => constant(number),
            Some(_) => self.refuse_range(location, value, &limit),
            None => {
                self.refuse(|| {
                    let message = format!(
                        "{location} is {}; must be a whole number in {limit}",
                        quote(value)
                    );
                    location
                        .error(message)
                        .value(value)
                        .limit(format!("whole numbers in {limit}"))
                });
                None
            }
        }
    }

    pub(crate) fn refuse_range(&mut self, location: &Location, value: &Value, limit: &str) -> Option<Node> {
        self.refuse(|| {
            let message = format!("{location} is {}; must be {limit}", quote(value));
            location.error(message).value(value).limit(limit)
        });
        None
    }

    fn check_list(
        &mut self,
        location: &Location,
        element: &Shape,
        max: usize,
        distinct: bool,
        items: &[Value],
    ) -> Option<Node> {
        if items.len() > max {
            let message = format!("{location} has {} elements; must be at most {max}", items.len());
            self.refuse(|| location.error(message).limit(format!("at most {max} elements")));
            return None;
        }
        let list = self.check_items(location, element, items)?;
        if distinct {
            self.refuse_repeats(location, &list);
        }
        Some(list)
    }

    fn check_items(&mut self, location: &Location, element: &Shape, items: &[Value]) -> Option<Node> {
        let nodes: Vec<_> = items
            .iter()
            .enumerate()
            .map(|(i, item)| self.check(&location.item(i), element, true, item))
            .collect();
        nodes.into_iter().collect::<Option<Vec<_>>>().map(Node::List)
    }

    fn refuse_repeats(&mut self, location: &Location, list: &Node) {
        let Node::List(items) = list else { return };
        let mut seen = BTreeSet::new();
        for (position, item) in items.iter().enumerate() {
            let location = location.item(position);
            let names = item.strings(&location.pointer);
            for (pointer, name) in names.iter().filter(|(_, name)| seen.contains(name)) {
                self.refuse(|| {
                    FieldError::new(
                        pointer,
                        format!("{location} can be \"{name}\", which the list already contains; remove one"),
                    )
                    .value(&Value::from(*name))
                });
            }
            seen.extend(names.into_iter().map(|(_, name)| name));
        }
    }
}

/// The value as a whole number; doubles count up to 2^53.
pub(crate) fn whole(value: &Value) -> Option<i128> {
    if let Some(number) = value.as_u64() {
        return Some(number.into());
    }
    if let Some(number) = value.as_i64() {
        return Some(number.into());
    }
    let number = value.as_f64()?;
    (number.fract() == 0.0 && number.abs() <= EXACT as f64).then_some(number as i128)
}

pub(crate) fn constant(number: i128) -> Option<Node> {
    Number::from_i128(number).map(|number| Node::Constant(Value::Number(number)))
}
