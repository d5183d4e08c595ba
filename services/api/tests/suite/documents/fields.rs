//! The fields of a job in the document, compared with their declarations.

use std::collections::BTreeSet;

use serde_json::{Value, json};
use spec::schema::{Field, Presence, Range, Shape};

use super::{document, followed, without_law};

/// Compares a declaration with its schema recursively; returns the number of fields.
fn compare(document: &Value, place: &str, shape: &Shape, schema: &Value) -> usize {
    let schema = without_law(document, schema);
    match shape {
        Shape::Number(range) => compare_range(place, range, schema),
        Shape::Integer(low, high) => {
            let end = |name: &str| schema[name].as_number().map(ToString::to_string);
            assert_eq!(
                (end("minimum"), end("maximum")),
                (Some(low.to_string()), Some(high.to_string())),
                "{place}"
            );
        }
        Shape::Rgb(range) | Shape::Vector(range) => {
            assert_eq!(
                (&schema["minItems"], &schema["maxItems"]),
                (&json!(3), &json!(3)),
                "{place}"
            );
            compare_range(place, range, without_law(document, &schema["items"]));
        }
        Shape::Pair(..) => assert_eq!(
            (&schema["minItems"], &schema["maxItems"]),
            (&json!(2), &json!(2)),
            "{place}"
        ),
        Shape::Text(_) => assert_eq!(schema["type"], "string", "{place}"),
        Shape::List {
            element,
            max,
            distinct,
        } => {
            assert_eq!(
                (&schema["maxItems"], &schema["uniqueItems"]),
                (&json!(max), &json!(distinct)),
                "{place}"
            );
            return compare(document, place, element, &schema["items"]);
        }
        Shape::Object(fields) => return compare_object(document, place, fields, schema, &[]),
        Shape::OneOf(fields) => {
            let options = schema["oneOf"].as_array().unwrap();
            let found = fields.iter().map(|field| {
                let has = |option: &&Value| followed(document, option)["properties"][field.name].is_object();
                let option = followed(document, options.iter().find(has).unwrap());
                compare_object(document, place, &[*field], option, &[field.name])
            });
            return found.sum();
        }
        Shape::Tagged {
            tag,
            presence,
            options,
        } => {
            let found = options.iter().map(|option| {
                let is_it =
                    |schema: &&Value| followed(document, schema)["properties"][tag]["const"] == option.name;
                let schema = followed(
                    document,
                    schema["oneOf"].as_array().unwrap().iter().find(is_it).unwrap(),
                );
                let usual = format!("\"{}\"", option.name);
                let is_usual = matches!(presence, Presence::Default(name) if *name == usual);
                let mut inside = schema.clone();
                inside["properties"]
                    .as_object_mut()
                    .unwrap()
                    .remove(*tag)
                    .unwrap();
                let also: &[&str] = if is_usual { &[] } else { &[*tag] };
                compare_object(document, place, option.fields, &inside, also)
            });
            return found.sum();
        }
        Shape::Short(_, fields) => {
            let object = followed(document, &schema["oneOf"][1]);
            return compare_object(document, place, fields, object, &[]);
        }
        Shape::Either(_, Shape::OneOf(fields)) => {
            return compare(document, place, &Shape::OneOf(fields), schema);
        }
        Shape::Either(_, object) => return compare(document, place, object, &schema["oneOf"][1]),
        Shape::Bool | Shape::Labels | Shape::Scalar => {}
    }
    0
}

fn compare_object(document: &Value, place: &str, fields: &[Field], schema: &Value, also: &[&str]) -> usize {
    let properties = schema["properties"].as_object().unwrap();
    let names: BTreeSet<_> = fields.iter().map(|field| field.name.to_owned()).collect();
    assert_eq!(
        properties.keys().cloned().collect::<BTreeSet<_>>(),
        names,
        "{place}"
    );
    assert_eq!(schema["additionalProperties"], false, "{place}");
    let required = fields.iter().filter(|field| field.presence == Presence::Required);
    let required: BTreeSet<_> = required
        .map(|field| field.name)
        .chain(also.iter().copied())
        .collect();
    let written = schema["required"].as_array().cloned().unwrap_or_default();
    assert_eq!(
        written.iter().filter_map(Value::as_str).collect::<BTreeSet<_>>(),
        required,
        "{place}"
    );
    let field = |field: &Field| {
        let (place, schema) = (format!("{place}/{}", field.name), &properties[field.name]);
        let text = schema["description"].as_str().unwrap_or_default();
        assert!(text.starts_with(field.doc), "{place}: {text}");
        assert!(text.ends_with(field.unit.unwrap_or_default()), "{place}: {text}");
        assert_eq!(schema["x-unit"].as_str(), field.unit, "{place}");
        if let Presence::Default(written) = field.presence {
            assert_eq!(
                schema["default"],
                serde_json::from_str::<Value>(written).unwrap(),
                "{place}"
            );
        }
        1 + compare(document, &place, &field.shape, schema)
    };
    fields.iter().map(field).sum()
}

fn compare_range(place: &str, range: &Range, schema: &Value) {
    assert_eq!(schema["type"], "number", "{place}");
    let least = schema["minimum"].as_f64().or(schema["exclusiveMinimum"].as_f64());
    let (low, high) = if *range == Range::FINITE {
        (None, None)
    } else {
        (Some(range.min), Some(range.max))
    };
    assert_eq!((least, schema["maximum"].as_f64()), (low, high), "{place}");
    assert_eq!(schema["exclusiveMinimum"].is_number(), range.above, "{place}");
}

#[test]
fn every_field_has_its_meaning_unit_limits_and_default_in_the_document() {
    let (_service, document) = document();
    let job = &document["components"]["schemas"]["JobDescription"];
    let seen = compare(&document, "", &spec::fields::DOCUMENT, job);
    // The table has a row for each tag too, and one row for a field common to several kinds of an object:
    // `lights[](point, spot)`.
    let fields: usize = spec::table::rows()
        .iter()
        .filter(|row| !row.doc.starts_with("selects"))
        .map(|row| 1 + row.path.matches(", ").count())
        .sum();
    assert_eq!(seen, fields);
    let water = &document["components"]["schemas"]["NewWater"];
    compare(&document, "", &Shape::Object(spec::OwnWater::FIELDS), water);
}
