//! Schemas of single values.

use serde_json::{Value, json};
use spec::schema::{Names, Range};

pub(super) fn reference(name: &str) -> Value {
    json!({"$ref": format!("#/components/schemas/{name}")})
}

/// The endpoint that lists names of this kind.
pub(super) fn listed_at(names: Names) -> &'static str {
    match names {
        Names::Preset => ", or a user-defined water; `GET /v1/waters` lists both",
        Names::Style => "; `GET /v1/styles` lists them",
        Names::Enhancer => "; `GET /v1/styles?role=enhancer` lists them",
        Names::Camera => "; `GET /v1/lists/cameras` describes them",
        Names::Sensor => "; `GET /v1/lists/sensors` describes them",
        Names::SceneId => "; `GET /v1/scenes` lists them",
        Names::Dataset => "; `GET /v1/datasets` lists the existing ones",
        Names::Collection => "; `GET /v1/collections` lists them",
        Names::Family => "; `GET /v1/lists/families` describes them",
        Names::Method => "; `GET /v1/lists/enhancements` describes them",
        Names::Metric => "; `GET /v1/lists/metrics` describes them",
        Names::Artifact => "; `GET /v1/lists/artifacts` describes them",
        Names::Fixed(_)
        | Names::WaterName
        | Names::Enhancement
        | Names::Words
        | Names::Path
        | Names::MaskImage => "",
    }
}

pub(super) fn number(range: &Range) -> Value {
    let mut number = json!({"type": "number"});
    if *range != Range::FINITE {
        let least = if range.above {
            "exclusiveMinimum"
        } else {
            "minimum"
        };
        number[least] = range.min.into();
        number["maximum"] = range.max.into();
    }
    number
}

pub(super) fn integer(low: i128, high: i128) -> Value {
    let [low, high] = [low, high].map(serde_json::Number::from_i128);
    json!({"type": "integer", "minimum": low, "maximum": high})
}

/// `range_m` as a part of a type's name: `RangeM`.
pub(super) fn camel(name: &str) -> String {
    name.split('_')
        .map(|part| part[..1].to_uppercase() + &part[1..])
        .collect()
}
