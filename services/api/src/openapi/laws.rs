//! Schemas of distributions. Numeric ones are common to all fields; choices and grids contain values of their field,
//! so each type of value has its own schema.

use serde_json::{Map, Value, json};

use super::leaf::reference;

/// Common description of all distributions.
const ABOUT: &str =
    "A distribution: the value of each frame is a pure function of seed, JSON pointer and frame.";

/// The numeric distributions.
pub(super) fn components() -> Components {
    let whole = json!({"type": "array", "items": {"type": "integer"}, "minItems": 2, "maxItems": 2,
                       "description": "first and last number, both included"});
    let ends = two_numbers("ends of its values");
    let clip = ("clip", two_numbers("limits of its values"), true);
    let mean = two_numbers("mean and standard deviation");
    let laws = [
        (
            "UniformLaw",
            object("uniform", ends.clone(), None, json!({"uniform": [0.5, 2.0]})),
        ),
        (
            "LogUniformLaw",
            object("log_uniform", ends, None, json!({"log_uniform": [0.01, 1.0]})),
        ),
        ("IntLaw", object("int", whole, None, json!({"int": [0, 9]}))),
        (
            "NormalLaw",
            object(
                "normal",
                mean,
                Some(clip),
                json!({"normal": [0.8, 0.1], "clip": [0, 1]}),
            ),
        ),
    ];
    laws.into_iter()
        .map(|(name, law)| (name.to_owned(), law))
        .collect()
}

fn two_numbers(about: &str) -> Value {
    json!({"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 2, "description": about})
}

/// Adds `{base}Law` and `{base}OrLaw` with the choice and the grid of such values. `value` is the schema without
/// distributions; absent for numbers, whose limits differ from field to field.
pub(super) fn add(found: &mut Components, base: &str, value: Option<Value>) {
    let (law, place) = (format!("{base}Law"), format!("{base}OrLaw"));
    let (choice, grid) = (format!("{base}Choice"), format!("{base}Grid"));
    let numbers: &[&str] = match base {
        "Number" | "Scalar" => &["UniformLaw", "LogUniformLaw", "NormalLaw", "IntLaw"],
        "Integer" => &["IntLaw"],
        _ => &[],
    };
    let names = numbers.iter().copied().chain([choice.as_str(), grid.as_str()]);
    let laws: Vec<_> = names.map(reference).collect();
    found.insert(law.clone(), json!({"oneOf": laws, "description": ABOUT}));
    let value = value.unwrap_or_else(|| without_limits(base));
    let either = json!({"oneOf": [value, reference(&law)], "description": "A value or a distribution."});
    found.insert(place.clone(), either);
    let weights = json!({"type": "array", "items": {"type": "number", "minimum": 0}, "minItems": 1,
                         "description": "one per value; absent: all equal"});
    let drawn = value_list(&place, "one of these values, drawn for each frame");
    let choice_law = law_object("choice", drawn, Some(("weights", weights, false)));
    let axis = value_list(
        &place,
        "an axis: every value in turn, combined with those of the other axes",
    );
    found.insert(choice, choice_law);
    found.insert(grid, law_object("grid", axis, None));
}

fn value_list(element: &str, about: &str) -> Value {
    json!({"type": "array", "items": reference(element), "minItems": 1, "description": about})
}

fn without_limits(base: &str) -> Value {
    match base {
        "Integer" => json!({"type": "integer"}),
        "Text" => json!({"type": "string"}),
        "Boolean" => json!({"type": "boolean"}),
        "Triple" => json!({"type": "array", "items": reference("NumberOrLaw"), "minItems": 3, "maxItems": 3}),
        _ => json!({"type": "number"}),
    }
}

fn object(key: &str, argument: Value, companion: Option<(&str, Value, bool)>, example: Value) -> Value {
    let mut law = law_object(key, argument, companion);
    law["examples"] = json!([example]);
    law
}

/// An object with the distribution's key and its companion.
fn law_object(key: &str, argument: Value, companion: Option<(&str, Value, bool)>) -> Value {
    let mut law = json!({"type": "object", "properties": {key: argument}, "required": [key],
                         "additionalProperties": false, "description": ABOUT});
    if let Some((name, schema, is_required)) = companion {
        law["properties"][name] = schema;
        if is_required {
            law["required"] = json!([key, name]);
        }
    }
    law
}

/// Components by name.
pub(crate) type Components = Map<String, Value>;
