//! Expands the sites that a job names into complete descriptions.

use std::collections::BTreeMap;

use serde_json::{Map, Value, json};

use super::SitePreset;
use super::merge::merge;
use crate::check::{Checker, Place};
use crate::fields::JOB;
use crate::invalid::FieldError;
use crate::json::step;
use crate::node::Node;
use crate::schema::{Names, Shape};

/// Fields that all sites of a job share. They are given beside `site`, never within it.
pub(crate) const OF_THE_JOB: [&str; 4] = ["count", "dataset", "seed", "site"];

/// Greatest number of sites that a job can name: each is a whole description in its canonical text.
const MAX_SITES: usize = 16;

/// The descriptions of a job.
pub(crate) struct Sites {
    /// The name of a frame's site, or how it is drawn. `None` for a job without a site.
    pub(crate) name: Option<Node>,
    /// One for each site, or that of the job without a site. Never empty.
    pub(crate) descriptions: Vec<SiteDescription>,
}

/// A complete description.
pub(crate) struct SiteDescription {
    /// Name of the site; empty without one.
    pub(crate) name: String,
    /// JSON pointer to the fields that the job gives for this site alone; empty for a preset.
    pub(crate) pointer: String,
    pub(crate) value: Value,
}

/// A site as the job names it.
struct NamedSite {
    name: String,
    pointer: String,
    /// Its own fields in place of those of a preset.
    fields: Option<Map<String, Value>>,
}

impl Sites {
    /// Lays the fields of the job over those of each site that it names.
    ///
    /// Returns `None` if `site` itself is refused, with its errors added.
    pub(crate) fn expand(written: &Value, checker: &mut Checker<'_>) -> Option<Self> {
        let Some((site, fields)) = split(written) else {
            return Some(Self {
                name: None,
                descriptions: vec![SiteDescription {
                    name: String::new(),
                    pointer: String::new(),
                    value: written.clone(),
                }],
            });
        };
        let mut named = Vec::new();
        let names = take_names(&site, "/site".to_owned(), &mut named);
        if named.len() > MAX_SITES {
            let message = format!("`site` names {} sites, the limit is {MAX_SITES}", named.len());
            checker.refuse(|| FieldError::new("/site", message).limit(format!("at most {MAX_SITES} sites")));
            return None;
        }
        let at = Place::default().field("site");
        let name = checker.node(&at, &Shape::Text(Names::WaterName), true, &names)?;
        let mut bases = BTreeMap::new();
        for site in named {
            checker.add_site(site, &mut bases);
        }
        let expand = |(name, (pointer, site)): (String, (String, Map<String, Value>))| {
            let mut value = merge(&JOB, site, &fields);
            value.insert("site".to_owned(), json!({"name": name}));
            SiteDescription {
                name,
                pointer,
                value: value.into(),
            }
        };
        checker.errors.is_empty().then(|| Self {
            name: Some(name),
            descriptions: bases.into_iter().map(expand).collect(),
        })
    }
}

impl Checker<'_> {
    /// Adds a site with its pointer, or the errors of its name and of its own fields that belong beside `site`.
    fn add_site(&mut self, site: NamedSite, bases: &mut BTreeMap<String, (String, Map<String, Value>)>) {
        let NamedSite {
            name,
            pointer,
            fields,
        } = site;
        let base = match (fields, SitePreset::find(&name)) {
            (Some(fields), _) => (pointer.clone(), fields),
            (None, Some(preset)) => (String::new(), preset.description()),
            (None, None) => {
                let message =
                    format!("`site` \"{name}\" is not a known site; `fathom list sites` lists them");
                let known = super::SITES.map(|site| site.name);
                self.refuse(|| {
                    FieldError::new(&pointer, message)
                        .value(&name.as_str().into())
                        .allowed(known, &name)
                });
                return;
            }
        };
        for field in OF_THE_JOB.into_iter().filter(|field| base.1.contains_key(*field)) {
            let message =
                format!("site `{name}` cannot have `{field}`: give it beside `site`, for all frames");
            self.refuse(|| FieldError::new(&format!("{pointer}/{field}"), message));
        }
        if bases.get(&name).is_some_and(|known| known.1 != base.1) {
            let message = format!("`site` has two different sites named `{name}`: rename one of them");
            self.refuse(|| FieldError::new(&pointer, message).value(&name.as_str().into()));
        }
        bases.insert(name, base);
    }
}

/// The field `site` of a job, and the fields beside it.
fn split(written: &Value) -> Option<(Value, Map<String, Value>)> {
    let mut fields = written.as_object()?.clone();
    Some((fields.remove("site")?, fields))
}

/// Returns `site` with a name in place of each object that has one, and adds the sites in their order.
fn take_names(site: &Value, pointer: String, named: &mut Vec<NamedSite>) -> Value {
    if let Value::String(name) = site {
        named.push(NamedSite {
            name: name.clone(),
            pointer,
            fields: None,
        });
        return site.clone();
    }
    let Value::Object(map) = site else {
        return site.clone();
    };
    if let Some(Value::String(name)) = map.get("name") {
        let mut fields = map.clone();
        fields.remove("name");
        named.push(NamedSite {
            name: name.clone(),
            pointer,
            fields: Some(fields),
        });
        return name.as_str().into();
    }
    let take = |(key, value): (&String, &Value)| {
        let pointer = format!("{pointer}{}", step(key));
        let value = match value {
            Value::Array(items) if key == "choice" || key == "grid" => {
                let items = items.iter().enumerate();
                items
                    .map(|(position, item)| take_names(item, format!("{pointer}/{position}"), named))
                    .collect()
            }
            _ => value.clone(),
        };
        (key.clone(), value)
    };
    map.iter().map(take).collect()
}

/// Returns `site` with the description in place of each name: the inverse of [`take_names`].
pub(crate) fn insert_descriptions(site: &Value, descriptions: &BTreeMap<&str, Value>) -> Value {
    match site {
        Value::String(name) => {
            let mut description = descriptions
                .get(name.as_str())
                .cloned()
                .unwrap_or_else(|| json!({}));
            if let Value::Object(fields) = &mut description {
                fields.retain(|field, _| !OF_THE_JOB.contains(&field.as_str()));
                fields.insert("name".to_owned(), name.as_str().into());
            }
            description
        }
        Value::Array(items) => items
            .iter()
            .map(|item| insert_descriptions(item, descriptions))
            .collect(),
        Value::Object(map) => map
            .iter()
            .map(|(key, value)| (key.clone(), insert_descriptions(value, descriptions)))
            .collect(),
        scalar => scalar.clone(),
    }
}
