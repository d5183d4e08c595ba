//! Objects whose tag selects the other fields.

use serde_json::{Map, Value};

use super::{Checker, Location, collection};
use crate::json::describe;
use crate::node::Node;
use crate::schema::{Presence, Variant, parse_default};

impl Checker<'_> {
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
}
