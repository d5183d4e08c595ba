//! Expands the sites of a job into complete descriptions.

use std::collections::BTreeMap;

use serde_json::{Map, Value, json};

use super::SitePreset;
use super::merge::merge;
use crate::check::{Checker, Location};
use crate::fields::{DOCUMENT, JOB};
use crate::invalid::FieldError;
use crate::node::Node;
use crate::schema::{Names, Shape};

/// Fields that all sites of a job share. They are given next to `site`, never within it.
pub(crate) const OF_THE_JOB: [&str; 4] = ["count", "dataset", "seed", "site"];

/// Maximum sites of a job: each adds a whole description to its canonical text.
const MAX_SITES: usize = 16;

/// The descriptions of a job.
pub(crate) struct Sites {
    /// Name of a frame's site, or its distribution. `None` for a job without sites.
    pub(crate) name: Option<Node>,
    /// One per site, or a single one without sites. Empty if `site` is rejected.
    pub(crate) descriptions: Vec<SiteDescription>,
}

pub(crate) struct SiteDescription {
    /// Name of the site; empty without one.
    pub(crate) name: String,
    /// JSON pointer to the fields that the job sets for this site only; empty for a preset.
    pub(crate) pointer: String,
    pub(crate) value: Value,
}

/// A site named by the job.
pub(crate) struct NamedSite {
    pub(crate) name: String,
    pub(crate) pointer: String,
    /// Overrides of the preset's fields.
    pub(crate) fields: Option<Map<String, Value>>,
}

/// The fields of a site before the overrides of the job.
struct SiteFields {
    pointer: String,
    fields: Map<String, Value>,
}

impl Sites {
    /// Merges the fields of the job into each of its sites, and adds the errors of `site`. Rejected sites have no
    /// description.
    pub(crate) fn expand(written: &Value, checker: &mut Checker<'_>) -> Self {
        let Some((site, fields)) = split_site(written) else {
            return Self {
                name: None,
                descriptions: vec![SiteDescription {
                    name: String::new(),
                    pointer: String::new(),
                    value: written.clone(),
                }],
            };
        };
        let mut named = Vec::new();
        let names = take_names(&site, "/site".to_owned(), &mut named);
        if named.len() > MAX_SITES {
            let message = format!("`site` names {} sites; must be at most {MAX_SITES}", named.len());
            checker.refuse(|| FieldError::new("/site", message).limit(format!("at most {MAX_SITES} sites")));
            named.clear();
        }
        let location = Location::default().field("site");
        let name = checker.check(&location, &Shape::Text(Names::WaterName), true, &names);
        let mut sites = BTreeMap::new();
        if name.is_some() {
            for site in named {
                checker.add_site(site, &mut sites);
            }
        }
        if sites.is_empty() {
            checker.check_overrides(&fields);
        }
        let descriptions = sites.into_iter().map(|(name, site)| {
            let mut value = merge(&JOB, site.fields, &fields);
            value.insert("site".to_owned(), json!({"name": name}));
            SiteDescription {
                name,
                pointer: site.pointer,
                value: value.into(),
            }
        });
        Self {
            name,
            descriptions: descriptions.collect(),
        }
    }
}

impl Checker<'_> {
    /// Adds a site, or the errors of its name and of fields that belong next to `site`.
    fn add_site(&mut self, site: NamedSite, sites: &mut BTreeMap<String, SiteFields>) {
        let NamedSite {
            name,
            pointer,
            fields,
        } = site;
        let site = match (fields, SitePreset::find(&name)) {
            (Some(fields), _) => SiteFields {
                pointer: pointer.clone(),
                fields,
            },
            (None, Some(preset)) => SiteFields {
                pointer: String::new(),
                fields: preset.description(),
            },
            (None, None) => return self.refuse_unknown_site(&name, &pointer),
        };
        for field in OF_THE_JOB
            .into_iter()
            .filter(|field| site.fields.contains_key(*field))
        {
            let message =
                format!("site `{name}` cannot have `{field}`; set it next to `site`, for all frames");
            self.refuse(|| FieldError::new(&format!("{pointer}/{field}"), message));
        }
        if sites.get(&name).is_some_and(|known| known.fields != site.fields) {
            let message = format!("`site` has two different sites named `{name}`; rename one of them");
            self.refuse(|| FieldError::new(&pointer, message).value(&name.as_str().into()));
        }
        sites.insert(name, site);
    }

    /// Adds the errors of the fields next to a rejected site, except for missing and removed values, which depend on
    /// the site.
    fn check_overrides(&mut self, fields: &Map<String, Value>) {
        let mut checker = Checker::new(self.vocabulary, self.seed);
        let fields = merge(&JOB, Map::new(), fields).into();
        checker.check(&Location::default(), &DOCUMENT, false, &fields);
        let errors = checker.errors.into_iter();
        self.errors.extend(
            errors.filter(|error| {
                error.limit.as_deref() != Some("required") && error.value != Some(Value::Null)
            }),
        );
    }

    fn refuse_unknown_site(&mut self, name: &str, pointer: &str) {
        let message = format!("`site` \"{name}\" is not a known site; `fathom list sites` lists them");
        let known = super::SITES.map(|site| site.name);
        self.refuse(|| {
            FieldError::new(pointer, message)
                .value(&name.into())
                .allowed(known, name)
        });
    }
}

/// Splits a job into `site` and the other fields.
pub(crate) fn split_site(written: &Value) -> Option<(Value, Map<String, Value>)> {
    let mut fields = written.as_object()?.clone();
    Some((fields.remove("site")?, fields))
}

/// Returns `site` with each named object replaced by its name, and adds the sites in order.
pub(crate) fn take_names(site: &Value, pointer: String, named: &mut Vec<NamedSite>) -> Value {
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
    let mut names = map.clone();
    for law in ["choice", "grid"] {
        if let Some(Value::Array(items)) = names.get_mut(law) {
            for (position, item) in items.iter_mut().enumerate() {
                *item = take_names(item, format!("{pointer}/{law}/{position}"), named);
            }
        }
    }
    names.into()
}

/// Returns `site` with each name replaced by its description: the inverse of [`take_names`].
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
