//! User-defined waters. A description contains their numbers, so that a frame does not change when the water is
//! deleted.

use serde_json::{Map, Value};

use super::Checker;

const PARTS: [&str; 2] = ["absorption_per_m", "scattering_per_m"];
const WHOLE: &str = "beam_attenuation_per_m";

impl Checker<'_> {
    /// The optics for the name of a user-defined water, or for an object with that preset: the water's name and
    /// numbers, overridden by those of the object.
    pub(super) fn own_water(&self, optics: &Value) -> Option<Value> {
        let own = |name: &str| Some((name.to_owned(), self.vocabulary.waters.get(name)?));
        match optics {
            Value::String(name) => {
                own(name).map(|(name, water)| Value::Object(merged(&name, water, Map::new())))
            }
            Value::Object(given) if !given.contains_key("name") => {
                let (name, water) = own(given.get("preset")?.as_str()?)?;
                let mut given = given.clone();
                given.remove("preset");
                Some(Value::Object(merged(&name, water, given)))
            }
            _ => None,
        }
    }
}

/// A given beam attenuation replaces the water's a and b; a given a or b replaces its c. Keeping both would be
/// contradictory.
fn merged(name: &str, water: &Map<String, Value>, given: Map<String, Value>) -> Map<String, Value> {
    let gives_whole = given.contains_key(WHOLE);
    let gives_part = PARTS.iter().any(|part| given.contains_key(*part));
    let replaced = |field: &str| {
        gives_whole && PARTS.contains(&field) || gives_part && field == WHOLE || given.contains_key(field)
    };
    let mut merged: Map<String, Value> = water
        .iter()
        .filter(|(field, _)| !replaced(field))
        .map(|(k, v)| (k.clone(), v.clone()))
        .collect();
    merged.extend(given);
    merged.insert("name".to_owned(), name.into());
    merged
}
