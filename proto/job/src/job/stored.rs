//! Reads the canonical text of an accepted job without checking its names and limits again: the job keeps its
//! meaning when names, sites and limits change.

mod law;

use std::collections::BTreeMap;

use serde_json::{Map, Value, json};

use crate::check::{constant, whole};
use crate::fields::DOCUMENT;
use crate::invalid::{FieldError, Invalid};
use crate::json::step;
use crate::law::find_key;
use crate::node::{Node, float};
use crate::schema::{Field, Names, Presence, Shape, Variant, parse_default};
use crate::site::{NamedSite, split_site, take_names};

use super::formula::{Document, Job, seed};

/// Reads a stored job.
pub(super) fn read_job(stored: &Value) -> Result<Job, Invalid> {
    let seed = seed(stored);
    let (site, documents) = read_documents(&Reader { seed }, stored)?;
    let mut errors = Vec::new();
    let job = Job::assemble(seed, site, documents, &mut errors);
    if errors.is_empty() {
        Ok(job)
    } else {
        Err(Invalid(errors))
    }
}

fn read_documents(reader: &Reader, stored: &Value) -> Result<(Option<Node>, Vec<Document>), Invalid> {
    let Some((site, fields)) = split_site(stored) else {
        let node = reader.read_document(stored)?;
        let site = String::new();
        return Ok((None, vec![Document { site, node }]));
    };
    let mut named = Vec::new();
    let names = take_names(&site, "/site".to_owned(), &mut named);
    let name = reader.read("/site", &Shape::Text(Names::WaterName), &names)?;
    let mut documents = BTreeMap::new();
    for NamedSite {
        name,
        pointer,
        fields: own,
    } in named
    {
        let mut description = own.ok_or_else(|| damage(&pointer, "must be a complete description"))?;
        description.extend(fields.clone());
        description.insert("site".to_owned(), json!({"name": name}));
        documents.insert(name, reader.read_document(&description.into())?);
    }
    let documents = documents.into_iter().map(|(site, node)| Document { site, node });
    let documents: Vec<_> = documents.collect();
    if documents.is_empty() {
        return Err(damage("/site", "must name a site"));
    }
    Ok((Some(name), documents))
}

fn damage(pointer: &str, problem: &str) -> Invalid {
    let location = if pointer.is_empty() { "/" } else { pointer };
    let message = format!("the stored description is damaged: `{location}` {problem}");
    Invalid(vec![FieldError::new(pointer, message)])
}

struct Reader {
    /// The job's seed, for the streams of distributions.
    seed: u64,
}

impl Reader {
    fn read_document(&self, description: &Value) -> Result<Node, Invalid> {
        let node = self.read("", &DOCUMENT, description)?;
        match node.get("scene") {
            Some(_) => Ok(node),
            None => Err(damage("/scene", "is missing")),
        }
    }

    fn read(&self, pointer: &str, shape: &Shape, value: &Value) -> Result<Node, Invalid> {
        if let Value::Object(map) = value
            && !matches!(shape, Shape::Labels)
            && let Some(key) = find_key(map)
        {
            return self.read_law(pointer, shape, key, map);
        }
        let node = match (shape, value) {
            (Shape::Number(_), Value::Number(_)) => {
                value.as_f64().map(|number| Node::Constant(float(number)))
            }
            (Shape::Integer(..), Value::Number(_)) => whole(value).and_then(constant),
            (Shape::Scalar, Value::Number(_) | Value::String(_) | Value::Bool(_))
            | (Shape::Text(_) | Shape::Either(..), Value::String(_))
            | (Shape::Bool, Value::Bool(_)) => Some(Node::Constant(value.clone())),
            (Shape::List { element, .. }, Value::Array(items)) => {
                Some(Node::List(self.read_items(pointer, element, items)?))
            }
            (Shape::Rgb(range) | Shape::Vector(range), Value::Array(items)) if items.len() == 3 => Some(
                Node::List(self.read_items(pointer, &Shape::Number(*range), items)?),
            ),
            (Shape::Pair(min, max), Value::Array(items)) if items.len() == 2 => Some(Node::List(
                self.read_items(pointer, &Shape::Integer(*min, *max), items)?,
            )),
            (Shape::Short(field, fields), Value::String(_)) => {
                let map = Map::from_iter([((*field).to_owned(), value.clone())]);
                Some(Node::Object(self.read_fields(pointer, fields, &map, None)?))
            }
            (Shape::Object(fields) | Shape::Short(_, fields), Value::Object(map)) => {
                Some(Node::Object(self.read_fields(pointer, fields, map, None)?))
            }
            (Shape::OneOf(fields), Value::Object(map)) if map.len() == 1 => {
                let present = fields.iter().filter(|field| map.contains_key(field.name));
                let present: Vec<_> = present.copied().collect();
                Some(Node::Object(self.read_fields(pointer, &present, map, None)?))
            }
            (
                Shape::Tagged {
                    tag,
                    presence,
                    options,
                },
                Value::Object(map),
            ) => Some(self.read_tagged(pointer, tag, *presence, options, map)?),
            (Shape::Either(_, object), Value::Object(_)) => Some(self.read(pointer, object, value)?),
            (Shape::Labels, Value::Object(map)) => Some(Node::Object(
                map.iter()
                    .map(|(key, label)| {
                        let node = self.read(&format!("{pointer}{}", step(key)), &Shape::Scalar, label)?;
                        Ok((key.clone(), node))
                    })
                    .collect::<Result<_, _>>()?,
            )),
            _ => None,
        };
        node.ok_or_else(|| damage(pointer, &format!("must be {}", shape.describe())))
    }

    fn read_items(&self, pointer: &str, element: &Shape, items: &[Value]) -> Result<Vec<Node>, Invalid> {
        let items = items.iter().enumerate();
        items
            .map(|(position, item)| self.read(&format!("{pointer}/{position}"), element, item))
            .collect()
    }

    /// Fields added to the schema since the job was stored get their defaults.
    fn read_fields(
        &self,
        pointer: &str,
        fields: &[Field],
        map: &Map<String, Value>,
        tag: Option<&str>,
    ) -> Result<Vec<(String, Node)>, Invalid> {
        let known: Vec<_> = fields.iter().map(|field| field.name).chain(tag).collect();
        if let Some(key) = map.keys().find(|key| !known.contains(&key.as_str())) {
            return Err(damage(&format!("{pointer}{}", step(key)), "is not a known field"));
        }
        let mut nodes = Vec::new();
        for field in fields {
            let pointer = format!("{pointer}{}", step(field.name));
            let node = match (map.get(field.name), field.presence) {
                (Some(value), _) => self.read(&pointer, &field.shape, value)?,
                (None, Presence::Default(text)) => self.read(&pointer, &field.shape, &parse_default(text))?,
                (None, Presence::Optional) => continue,
                (None, Presence::Required) => return Err(damage(&pointer, "is missing")),
            };
            nodes.push((field.name.to_owned(), node));
        }
        Ok(nodes)
    }

    fn read_tagged(
        &self,
        pointer: &str,
        tag: &str,
        presence: Presence,
        options: &[Variant],
        map: &Map<String, Value>,
    ) -> Result<Node, Invalid> {
        let name = match (map.get(tag), presence) {
            (None, Presence::Default(text)) => parse_default(text),
            (written, _) => written.cloned().unwrap_or_default(),
        };
        let Some(option) = options.iter().find(|option| name == option.name) else {
            return Err(damage(
                &format!("{pointer}{}", step(tag)),
                "is not a known kind of object",
            ));
        };
        let mut nodes = self.read_fields(pointer, option.fields, map, Some(tag))?;
        nodes.push((tag.to_owned(), Node::Constant(name)));
        Ok(Node::Object(nodes))
    }
}
