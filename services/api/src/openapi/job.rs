//! The schema of a job description, made from the table of accepted fields.

use serde_json::{Value, json};
use spec::fields::DOCUMENT;
use spec::schema::{Field, Names, Presence, Range, Shape, Variant};
use utoipa::openapi::RefOr;
use utoipa::openapi::schema::{
    AdditionalProperties, ArrayBuilder, Object, ObjectBuilder, OneOfBuilder, Ref, Schema, Type,
};
use utoipa::{PartialSchema, ToSchema};

/// The documented example.
const EXAMPLE: &str = r#"{
  "dataset": "structure-v1", "count": 1000, "seed": 42,
  "scene": {"kind": "procedural", "family": "structure", "seed": {"int": [0, 1000000]}},
  "camera": {"width": 768, "height": 492, "hfov_deg": 80},
  "water": {"optics": {"choice": ["jerlov-1C", "jerlov-5C", "jerlov-9C"]}, "range_scale": {"uniform": [0.5, 2.0]}},
  "lights": [{"kind": "haze", "x": {"uniform": [0, 1]}, "y": 1.0, "size": 0.2,
              "intensity": {"normal": [0.8, 0.1], "clip": [0, 1]}, "color": [1, 1, 1]}],
  "enhance": ["hscm"],
  "metrics": ["entropy", "uicm", "uism", "uiconm", "uiqm", "uciqe"],
  "fidelity": {"tolerance": 3e-4},
  "artifacts": ["rgb", "range", "enhanced.hscm"], "encode": {"format": "png"},
  "labels": {"run": "exp-41"}
}"#;

/// The body of a job: a frame description with laws in place of values.
pub(crate) struct JobDescription;

impl ToSchema for JobDescription {
    fn schemas(schemas: &mut Vec<(String, RefOr<Schema>)>) {
        schemas.push(("Law".to_owned(), law().into()));
    }
}

impl PartialSchema for JobDescription {
    fn schema() -> RefOr<Schema> {
        let Shape::Object(fields) = DOCUMENT else {
            return any("a job description").into();
        };
        let example: Value = serde_json::from_str(EXAMPLE).unwrap_or_default();
        let text = "A frame description. A law may stand in place of any number, string or list element where the \
                    schema says so; frames = count × product of the grid axes.";
        object(fields).description(Some(text)).examples([example]).into()
    }
}

fn law() -> Schema {
    let pair = "two numbers";
    let kinds = [
        (
            "choice",
            "one of these values, by `weights` if they are given; values may hold laws",
            json!({"choice": ["a", "b"], "weights": [1, 2]}),
        ),
        ("uniform", pair, json!({"uniform": [0.5, 2.0]})),
        ("log_uniform", pair, json!({"log_uniform": [0.01, 1.0]})),
        ("int", "two whole numbers, both included", json!({"int": [0, 9]})),
        (
            "normal",
            "mean and standard deviation, clamped to `clip`",
            json!({"normal": [0.8, 0.1], "clip": [0, 1]}),
        ),
        (
            "grid",
            "an axis: every value, combined with those of the other axes",
            json!({"grid": [0, 0.5, 1]}),
        ),
    ];
    let text = "A law: the value of each frame is a pure function of seed, place and frame.";
    let variants = kinds.map(|(name, text, example)| {
        let law = ObjectBuilder::new().property(name, ArrayBuilder::new().items(any(text)));
        law.required(name).examples([example])
    });
    one_of(variants).description(Some(text)).into()
}

fn object(fields: &[Field]) -> ObjectBuilder {
    let object = ObjectBuilder::new().schema_type(Type::Object);
    let object = object.additional_properties(Some(AdditionalProperties::FreeForm(false)));
    fields.iter().fold(object, |object, field| {
        let object = object.property(field.name, described(field));
        if field.presence == Presence::Required {
            object.required(field.name)
        } else {
            object
        }
    })
}

/// The field's own schema, or a law.
fn described(field: &Field) -> RefOr<Schema> {
    let default = match field.presence {
        Presence::Default(text) => serde_json::from_str(text).ok(),
        Presence::Required | Presence::Optional => None,
    };
    let one = OneOfBuilder::new()
        .item(shape(&field.shape))
        .description(Some(field.doc))
        .default(default);
    if field.laws {
        one.item(Ref::from_schema_name("Law")).into()
    } else {
        one.into()
    }
}

fn shape(shape: &Shape) -> RefOr<Schema> {
    match shape {
        Shape::Number(range) => number(range).into(),
        Shape::Integer(low, high) => ObjectBuilder::new()
            .schema_type(Type::Integer)
            .minimum(Some(*low as f64))
            .maximum(Some(*high as f64))
            .into(),
        Shape::Text(names) => text(names).into(),
        Shape::List {
            element,
            max,
            distinct,
        } => ArrayBuilder::new()
            .items(self::shape(element))
            .max_items(Some(*max))
            .unique_items(*distinct)
            .into(),
        Shape::Rgb(range) | Shape::Vector(range) => ArrayBuilder::new()
            .items(number(range))
            .min_items(Some(3))
            .max_items(Some(3))
            .into(),
        Shape::Object(fields) => object(fields).into(),
        Shape::OneOf(fields) => {
            let variant = |field: &Field| object(std::slice::from_ref(field)).required(field.name);
            one_of(fields.iter().map(variant)).into()
        }
        Shape::Tagged {
            tag,
            presence,
            options,
        } => {
            let variant = |option: &Variant| tagged(tag, *presence, option);
            one_of(options.iter().map(variant)).into()
        }
        Shape::Short(name, fields) => {
            let named = format!("short for {{\"{name}\": …}}");
            let name = ObjectBuilder::new()
                .schema_type(Type::String)
                .description(Some(named));
            OneOfBuilder::new().item(name).item(object(fields)).into()
        }
        Shape::Either(names, other) => OneOfBuilder::new()
            .item(text(names))
            .item(self::shape(other))
            .into(),
        Shape::Labels => any(&shape.limit()).into(),
        Shape::Scalar => any(shape.describe()).into(),
    }
}

fn one_of(variants: impl IntoIterator<Item = ObjectBuilder>) -> OneOfBuilder {
    let variants = variants.into_iter();
    variants.fold(OneOfBuilder::new(), |all, variant| all.item(variant))
}

fn number(range: &Range) -> Object {
    let number = ObjectBuilder::new().schema_type(Type::Number);
    let number = if *range == Range::FINITE {
        number
    } else if range.above {
        number.exclusive_minimum(Some(range.min)).maximum(Some(range.max))
    } else {
        number.minimum(Some(range.min)).maximum(Some(range.max))
    };
    number.build()
}

fn tagged(tag: &str, presence: Presence, option: &Variant) -> ObjectBuilder {
    let name = ObjectBuilder::new()
        .schema_type(Type::String)
        .enum_values(Some([option.name]));
    let variant = object(option.fields).property(tag, name);
    match presence {
        Presence::Default(text) if text.trim_matches('"') == option.name => variant,
        _ => variant.required(tag),
    }
}

fn text(names: &Names) -> Object {
    let text = ObjectBuilder::new().schema_type(Type::String);
    match names {
        Names::Fixed(words) => text.enum_values(Some(words.iter().copied())).build(),
        other => text.description(Some(other.describe())).build(),
    }
}

fn any(description: &str) -> Object {
    ObjectBuilder::new()
        .schema_type(utoipa::openapi::schema::SchemaType::AnyValue)
        .description(Some(description))
        .build()
}
