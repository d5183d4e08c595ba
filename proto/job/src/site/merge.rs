//! Merges the fields of a job into those of its site.

use serde_json::{Map, Value};

use crate::law::is_law;
use crate::schema::{Field, Shape, Variant};

/// Overrides the site's fields with the job's: objects merge field by field; lists, scalars and distributions are
/// replaced; `null` removes the site's field. An object of another kind replaces the site's, and so does a scene of
/// another family.
pub(super) fn merge(
    fields: &[Field],
    mut site: Map<String, Value>,
    job: &Map<String, Value>,
) -> Map<String, Value> {
    for (name, value) in job {
        let old = site.remove(name).unwrap_or_else(|| Map::new().into());
        if value.is_null() {
            continue;
        }
        let field = fields.iter().find(|field| field.name == name);
        let merged = field.map_or_else(|| value.clone(), |field| merge_value(&field.shape, old, value));
        site.insert(name.clone(), merged);
    }
    site
}

fn merge_value(shape: &Shape, site: Value, job: &Value) -> Value {
    let Value::Object(over) = job else {
        return job.clone();
    };
    if is_law(job) || is_law(&site) {
        return job.clone();
    }
    let merged = match (shape, site) {
        (Shape::Either(_, object), site) => return merge_value(object, site, job),
        (Shape::Short(short, fields), Value::String(text)) => {
            let site = Map::from_iter([((*short).to_owned(), text.into())]);
            merge(fields, site, over)
        }
        (Shape::Object(fields) | Shape::Short(_, fields), Value::Object(site)) => merge(fields, site, over),
        (Shape::OneOf(fields), Value::Object(site)) if site.keys().eq(over.keys()) => {
            merge(fields, site, over)
        }
        (Shape::Labels, Value::Object(site)) => merge(&[], site, over),
        (Shape::Tagged { tag, options, .. }, Value::Object(site)) => merge_tagged(tag, options, site, over),
        _ => return job.clone(),
    };
    merged.into()
}

fn merge_tagged(
    tag: &str,
    options: &[Variant],
    mut site: Map<String, Value>,
    job: &Map<String, Value>,
) -> Map<String, Value> {
    let option = options
        .iter()
        .find(|option| site.get(tag).is_some_and(|kind| kind == option.name));
    let Some(option) = option else {
        return job.clone();
    };
    if [tag, "family"]
        .iter()
        .any(|name| job.get(*name).is_some_and(|value| site.get(*name) != Some(value)))
    {
        site.retain(|name, _| name == tag);
        return merge(&[], site, job);
    }
    merge(option.fields, site, job)
}
