//! Objects: known and unknown fields, defaults, kinds, labels.

use serde_json::{Map, Value};

use super::{Checker, Location, collection};
use crate::json::describe;
use crate::migration;
use crate::node::{Node, float};
use crate::schema::{Field, MAX_LABEL_KEY, MAX_LABEL_TEXT, MAX_LABELS, Presence, Shape, Variant};

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

    pub(super) fn check_tagged(
        &mut self,
        location: &Location,
        tag: &'static str,
        presence: Presence,
        options: &[Variant],
        map: &Map<String, Value>,
    ) -> Option<Node> {
        let written = match (map.get(tag), presence) {
            (None, Presence::Default(text)) => parse_default(text),
            (Some(value), _) => value.clone(),
            (None, _) => return self.refuse_tag(&location.field(tag), options, None),
        };
        let Value::String(written) = &written else {
            return self.refuse_tag(&location.field(tag), options, Some(&written));
        };
        let Some(option) = options
            .iter()
            .find(|option| option.name == *written && self.offers(option))
        else {
            return self.refuse_tag(&location.field(tag), options, Some(&written.as_str().into()));
        };
        let names: Vec<_> = option
            .fields
            .iter()
            .map(|field| field.name)
            .chain([tag])
            .collect();
        self.refuse_unknown(location, &names, map, |key| {
            let owner = options
                .iter()
                .find(|other: &&Variant| other.fields.iter().any(|field| field.name == key))?
                .name;
            Some(format!(
                "`{key}` belongs to {tag} \"{owner}\", not to \"{written}\""
            ))
        });
        let with_scenes = self.expand_collection(location, written, map);
        let mut fields = self.check_fields(location, option.fields, with_scenes.as_ref().unwrap_or(map));
        fields.push((tag.to_owned(), Node::Constant(written.as_str().into())));
        Some(Node::Object(fields))
    }

    fn refuse_tag(
        &mut self,
        location: &Location,
        options: &[Variant],
        value: Option<&Value>,
    ) -> Option<Node> {
        let allowed: Vec<_> = options
            .iter()
            .filter(|option| self.offers(option))
            .map(|option| option.name)
            .collect();
        self.refuse(|| match value {
            None => location
                .error(format!("{location} is missing"))
                .limit("required")
                .allowed(allowed, ""),
            Some(Value::String(name)) => {
                let known = options.iter().any(|option| option.name == name);
                let why = match known {
                    true if self.vocabulary.local => {
                        "needs a service: upload its scenes there and submit the job with `fathom submit`"
                    }
                    true => "works only with `fathom render`",
                    false => "is not known",
                };
                let message = format!(
                    "{location} {} {why}",
                    crate::invalid::quote(&name.as_str().into())
                );
                location
                    .error(message)
                    .value(&name.as_str().into())
                    .allowed(allowed, name)
            }
            Some(other) => {
                let message = format!(
                    "{location} selects the other fields and must be a string, but is {}; \
                    to vary it, use a choice of whole objects",
                    describe(other)
                );
                location.error(message).value(other).allowed(allowed, "")
            }
        });
        None
    }

    /// Whether this kind of object is available: files only on the rendering machine, collections only in a service.
    fn offers(&self, option: &Variant) -> bool {
        match option.name {
            "files" => self.vocabulary.local,
            collection::KIND => !self.vocabulary.local,
            _ => true,
        }
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

    pub(super) fn check_labels(&mut self, location: &Location, map: &Map<String, Value>) -> Option<Node> {
        if map.len() > MAX_LABELS {
            let message = format!("{location} has {} entries, the limit is {MAX_LABELS}", map.len());
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

    /// Checks a label. A whole number is stored the same way, whether written 2 or 2.0.
    pub(super) fn check_scalar(&mut self, location: &Location, value: &Value) -> Option<Node> {
        match value {
            Value::Bool(_) => Some(Node::Constant(value.clone())),
            Value::Number(number) => Some(
                match (super::whole(value).and_then(super::constant), number.as_f64()) {
                    (Some(whole), _) => whole,
                    (None, float_value) => Node::Constant(float(float_value?)),
                },
            ),
            Value::String(text) if text.chars().count() <= MAX_LABEL_TEXT => {
                Some(Node::Constant(value.clone()))
            }
            Value::String(_) => self.refuse_range(location, value, &format!("{MAX_LABEL_TEXT} characters")),
            _ => self.refuse_kind(location, &Shape::Scalar, true, value),
        }
    }

    fn refuse_unknown(
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
                let message = note(key).unwrap_or_else(|| format!("{location} has no field `{key}`"));
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

    fn check_fields(
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

pub(crate) fn parse_default(text: &str) -> Value {
    serde_json::from_str(text).expect("the defaults of the table are JSON, a test reads them all")
}
