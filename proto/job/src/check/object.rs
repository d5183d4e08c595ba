//! Objects: known and unknown fields, defaults.

use serde_json::{Map, Value};

use super::{Checker, Location};
use crate::migration;
use crate::node::Node;
use crate::schema::{Field, Presence, Shape, parse_default};
use crate::table::find_owners;

impl Checker<'_> {
    pub(super) fn check_object(
        &mut self,
        location: &Location,
        fields: &[Field],
        map: &Map<String, Value>,
    ) -> Node {
        let names: Vec<_> = fields.iter().map(|field| field.name).collect();
        self.refuse_unknown(location, &names, map, |_| None);
        Node::Object(self.check_fields(location, fields, map))
    }

    pub(super) fn check_one_of(
        &mut self,
        location: &Location,
        fields: &[Field],
        map: &Map<String, Value>,
    ) -> Option<Node> {
        let names: Vec<_> = fields.iter().map(|field| field.name).collect();
        let present: Vec<_> = fields
            .iter()
            .filter(|field| map.contains_key(field.name))
            .copied()
            .collect();
        if present.len() == 1
            || map
                .keys()
                .any(|key: &String| migration::find_field(&location.field(key).path("[]"), None).is_some())
        {
            self.refuse_unknown(location, &names, map, |_| None);
            return Some(Node::Object(self.check_fields(location, &present, map)));
        }
        let message = format!(
            "{location} must have exactly one of {}, but has {}",
            names.join(", "),
            present.len()
        );
        let written = map
            .keys()
            .find(|key| !names.contains(&key.as_str()))
            .map_or("", String::as_str);
        self.refuse(|| {
            location
                .error(message)
                .limit("exactly one")
                .allowed(names, written)
        });
        None
    }

    /// Checks an object, or a string in place of its field `field`.
    pub(super) fn check_short(
        &mut self,
        location: &Location,
        field: &str,
        fields: &[Field],
        value: &Value,
    ) -> Option<Node> {
        let numbers = self.expand_own_water(value);
        let checked = match numbers.as_ref().unwrap_or(value) {
            Value::Object(map) => self.check_object(location, fields, map),
            Value::String(_) => {
                let (own, others): (Vec<Field>, Vec<Field>) = fields
                    .iter()
                    .copied()
                    .partition(|candidate| candidate.name == field);
                let node = self.check(location, &own.first()?.shape, false, value)?;
                let mut nodes = self.check_fields(location, &others, &Map::new());
                nodes.push((field.to_owned(), node));
                Node::Object(nodes)
            }
            _ => return self.refuse_kind(location, &Shape::Short("", &[]), true, value),
        };
        self.refuse_unrenderable(location, &checked, value.is_object());
        Some(checked)
    }

    pub(super) fn refuse_unknown(
        &mut self,
        location: &Location,
        names: &[&str],
        map: &Map<String, Value>,
        note: impl Fn(&str) -> Option<String>,
    ) {
        for (key, value) in map.iter().filter(|(key, _)| !names.contains(&key.as_str())) {
            if self.refuse_removed(&location.field(key), value) {
                continue;
            }
            self.refuse(|| {
                let message = note(key).unwrap_or_else(|| describe_unknown(location, key));
                location
                    .field(key)
                    .error(message)
                    .value(value)
                    .allowed(names, key)
            });
        }
    }

    /// Rejects a field of version 0.1 and suggests its replacement, if possible for each field inside.
    fn refuse_removed(&mut self, location: &Location, value: &Value) -> bool {
        let Some(removed) = migration::find_field(&location.path("[]"), value.as_str()) else {
            return false;
        };
        let mut found_inside = false;
        for (key, value) in value.as_object().into_iter().flatten() {
            found_inside |= self.refuse_removed(&location.field(key), value);
        }
        if !found_inside {
            let message = format!("{location} was removed in 0.2; {}", removed.instruction());
            self.refuse(|| location.error(message).value(value));
        }
        true
    }

    pub(super) fn check_fields(
        &mut self,
        location: &Location,
        fields: &[Field],
        map: &Map<String, Value>,
    ) -> Vec<(String, Node)> {
        let checked = fields.iter().filter_map(|field| {
            let node = self.check_field(&location.field(field.name), field, map.get(field.name))?;
            Some((field.name.to_owned(), node))
        });
        checked.collect()
    }

    fn check_field(&mut self, location: &Location, field: &Field, value: Option<&Value>) -> Option<Node> {
        match (value, field.presence) {
            (Some(value), _) => self.check(location, &field.shape, field.laws, value),
            (None, Presence::Optional) => None,
            (None, Presence::Default(text)) => {
                self.check(location, &field.shape, field.laws, &parse_default(text))
            }
            (None, Presence::Required) => {
                let message = format!("{location} is missing: {}", field.doc);
                self.refuse(|| location.error(message).limit("required"));
                None
            }
        }
    }
}

/// Describes an unknown field. If exactly one other object has a field of this name, as `daylight` has
/// `sun_elevation_deg`, the message names it.
fn describe_unknown(location: &Location, key: &str) -> String {
    let unknown = format!("{location} has no field `{key}`");
    match find_owners(key).as_slice() {
        [owner] => format!("{unknown}; it is a field of {owner}: move it there, or remove it"),
        _ => unknown,
    }
}
