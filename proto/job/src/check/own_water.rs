//! User-defined waters. A description contains their numbers, so that a frame does not change when the water is
//! deleted.

use serde_json::{Map, Value};

use super::Checker;

const PARTS: [&str; 2] = ["absorption_per_m", "scattering_per_m"];
const WHOLE: &str = "beam_attenuation_per_m";

impl Checker<'_> {
    /// The optics for the name of a user-defined water, or for an object with that preset: the water's name and
    /// numbers, overridden by those of the object.
    pub(super) fn expand_own_water(&self, optics: &Value) -> Option<Value> {
        let (name, given) = match optics {
            Value::String(name) => (name.as_str(), Map::new()),
            Value::Object(given) if !given.contains_key("name") => {
                let mut others = given.clone();
                others.remove("preset");
                (given.get("preset")?.as_str()?, others)
            }
            _ => return None,
        };
        let water = self.vocabulary.waters.get(name)?;
        Some(Value::Object(merge_optics(name, water, given)))
    }
}

/// A given beam attenuation replaces the water's a and b; a given a or b replaces its c. Keeping both would be
/// contradictory.
fn merge_optics(name: &str, water: &Map<String, Value>, given: Map<String, Value>) -> Map<String, Value> {
    let gives_whole = given.contains_key(WHOLE);
    let gives_part = PARTS.iter().any(|part| given.contains_key(*part));
    let mut merged = water.clone();
    merged
        .retain(|field, _| !(gives_whole && PARTS.contains(&field.as_str()) || gives_part && field == WHOLE));
    merged.extend(given);
    merged.insert("name".to_owned(), name.into());
    merged
}
