//! Schemas of descriptions, generated from the field schema: a named component for each group, list of words and
//! distribution.

use serde_json::{Map, Value, json};
use spec::schema::{Field, MAX_LABEL_TEXT, MAX_LABELS, Names, Presence, Shape, Variant};
use spec::{OwnWater, Vocabulary};

use super::laws;
use super::laws::Components;
use super::leaf::{camel, integer, listed_at, number, reference};

/// The documented example of a job.
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

/// The schema of a value without distributions.
struct Plain {
    schema: Value,
    /// Name of its distribution, without the suffix `Law`.
    base: String,
    /// Whether `schema` refers to a component of that name.
    is_named: bool,
}

/// Writes components.
struct Writer<'v> {
    vocabulary: &'v Vocabulary,
    found: Components,
}

/// All components of jobs and user-defined waters: `JobDescription`, `NewWater` and their parts.
pub(crate) fn components(vocabulary: &Vocabulary) -> Components {
    let mut writer = Writer {
        vocabulary,
        found: laws::components(),
    };
    if let Shape::Object(fields) = spec::fields::DOCUMENT {
        let mut job = writer.object(fields);
        job["description"] =
            "A frame description. Values can be distributions where the schema allows it; frames = count × product of the \
             grid axes."
                .into();
        let example: Value = serde_json::from_str(EXAMPLE).unwrap_or_default();
        job["examples"] = json!([example]);
        writer.found.insert("JobDescription".to_owned(), job);
    }
    let mut water = writer.object(OwnWater::FIELDS);
    water["description"] = "A user-defined water. Arrays are R, G, B; an absent value is unknown.".into();
    water["examples"] = json!([{
        "name": "quay-7", "source": "our transmissometer, May", "licence": "CC-BY-4.0", "wavelength_nm": [650, 532, 450],
        "absorption_per_m": [0.42, 0.2, 0.5], "scattering_per_m": [1.0, 1.1, 1.3], "diffuse_attenuation_per_m": [0.6, 0.4, 0.8]
    }]);
    writer.found.insert("NewWater".to_owned(), water);
    for names in [Names::Artifact, Names::Method, Names::Metric, Names::Family] {
        writer.text(names, None);
    }
    writer.found
}

impl Writer<'_> {
    fn object(&mut self, fields: &[Field]) -> Value {
        let mut properties = Map::new();
        for field in fields {
            let schema = self.field(field);
            properties.insert(field.name.to_owned(), schema);
        }
        let required: Vec<_> = fields
            .iter()
            .filter(|field| field.presence == Presence::Required)
            .map(|field| field.name)
            .collect();
        let mut object = json!({"type": "object", "properties": properties, "additionalProperties": false});
        if !required.is_empty() {
            object["required"] = json!(required);
        }
        object
    }

    /// The field's schema or a distribution, with meaning, unit and default.
    fn field(&mut self, field: &Field) -> Value {
        let plain = match field.shape {
            Shape::Text(names) => self.text(names, field.type_name.or(Some(field.name))),
            shape => self.plain(&shape, field.type_name.unwrap_or_default(), field.laws),
        };
        let mut schema = if field.laws {
            self.varied(plain)
        } else {
            plain.schema
        };
        let own = schema.get("description").and_then(Value::as_str);
        let meaning = field.meaning();
        let notes = [Some(meaning.as_str()), own, field.unit.map(|_| "unit:")];
        let mut text = notes.into_iter().flatten().collect::<Vec<_>>().join("; ");
        if let Some(unit) = field.unit {
            text = format!("{text} {unit}");
            schema["x-unit"] = unit.into();
        }
        schema["description"] = text.into();
        if let Presence::Default(written) = field.presence {
            schema["default"] = serde_json::from_str(written).unwrap_or_default();
        }
        schema
    }

    /// The schema of a value or its distribution.
    fn varied(&mut self, plain: Plain) -> Value {
        let Plain {
            schema,
            base,
            is_named,
        } = plain;
        let law = format!("{base}Law");
        if !self.found.contains_key(&law) {
            laws::add(&mut self.found, &base, is_named.then(|| schema.clone()));
        }
        if is_named {
            reference(&format!("{base}OrLaw"))
        } else {
            json!({"oneOf": [schema, reference(&law)]})
        }
    }

    fn place(&mut self, shape: &Shape, type_name: &str, laws: bool) -> Value {
        let plain = self.plain(shape, type_name, laws);
        if laws { self.varied(plain) } else { plain.schema }
    }

    fn plain(&mut self, shape: &Shape, type_name: &str, laws: bool) -> Plain {
        match shape {
            Shape::Number(range) => bare(number(range), "Number"),
            Shape::Integer(low, high) => bare(integer(*low, *high), "Integer"),
            Shape::Rgb(range) | Shape::Vector(range) => {
                let part = self.place(&Shape::Number(*range), "", laws);
                bare(
                    json!({"type": "array", "items": part, "minItems": 3, "maxItems": 3}),
                    "Triple",
                )
            }
            Shape::Pair(low, high) => {
                let part = self.place(&Shape::Integer(*low, *high), "", laws);
                bare(
                    json!({"type": "array", "items": part, "minItems": 2, "maxItems": 2}),
                    "Pair",
                )
            }
            Shape::Text(names) => self.text(*names, Some(type_name).filter(|name| !name.is_empty())),
            Shape::List {
                element,
                max,
                distinct,
            } => {
                let item = self.place(element, type_name, laws);
                let list = json!({"type": "array", "items": item, "maxItems": max, "uniqueItems": distinct});
                if !laws {
                    return bare(list, "");
                }
                let element = self.plain(element, type_name, laws).base;
                self.named(&format!("{element}List"), |_| list)
            }
            Shape::Bool => bare(json!({"type": "boolean"}), "Boolean"),
            Shape::Labels => self.labels(),
            Shape::Scalar => self.named("Scalar", |_| {
                let text = json!({"type": "string", "maxLength": MAX_LABEL_TEXT});
                json!({"oneOf": [{"type": "number"}, text, {"type": "boolean"}], "description": "A user-defined value."})
            }),
            Shape::Object(fields) => self.group(type_name, |writer| writer.object(fields)),
            Shape::OneOf(fields) => self.group(type_name, |writer| writer.one_of(fields, type_name)),
            Shape::Tagged {
                tag,
                presence,
                options,
            } => self.group(type_name, |writer| writer.tagged(tag, *presence, options)),
            Shape::Short(name, fields) => self.group(type_name, |writer| writer.short(name, fields, type_name)),
            Shape::Either(names, object) => self.group(type_name, |writer| {
                let word = writer.text(*names, Some(&format!("{type_name}Word"))).schema;
                match object {
                    Shape::OneOf(fields) => {
                        let mut options = writer.options(fields, type_name);
                        options.insert(0, word);
                        json!({"oneOf": options})
                    }
                    object => {
                        // The name without `Fields` is that of the alternatives.
                        let fields = writer.plain(object, &format!("{type_name}Fields"), laws);
                        json!({"oneOf": [word, fields.schema]})
                    }
                }
            }),
        }
    }

    /// Adds a component once.
    fn named(&mut self, name: &str, write: impl FnOnce(&mut Self) -> Value) -> Plain {
        if !self.found.contains_key(name) {
            // Reserve the name first, because schemas may be recursive.
            self.found.insert(name.to_owned(), Value::Null);
            let schema = write(self);
            self.found.insert(name.to_owned(), schema);
        }
        Plain {
            schema: reference(name),
            base: name.to_owned(),
            is_named: true,
        }
    }

    /// A group of fields. The suffix `Description` avoids clashes with stored types.
    fn group(&mut self, type_name: &str, write: impl FnOnce(&mut Self) -> Value) -> Plain {
        Plain {
            base: type_name.to_owned(),
            ..self.named(&format!("{type_name}Description"), write)
        }
    }

    fn one_of(&mut self, fields: &[Field], type_name: &str) -> Value {
        json!({"oneOf": self.options(fields, type_name)})
    }

    /// An object of one field for each of these.
    fn options(&mut self, fields: &[Field], type_name: &str) -> Vec<Value> {
        fields
            .iter()
            .map(|field: &Field| {
                let name = format!("{}{type_name}", camel(field.name));
                self.group(&name, |writer: &mut Self| {
                    let mut object = writer.object(std::slice::from_ref(field));
                    object["required"] = json!([field.name]);
                    object
                })
                .schema
            })
            .collect()
    }

    fn tagged(&mut self, tag: &str, presence: Presence, options: &[Variant]) -> Value {
        let mut kinds = Map::new();
        for option in options {
            let is_usual =
                matches!(presence, Presence::Default(text) if text.trim_matches('"') == option.name);
            let kind = self
                .group(option.type_name, |writer: &mut Self| {
                    let mut object = writer.object(option.fields);
                    object["properties"][tag] = json!({"type": "string", "const": option.name});
                    let mut required = object["required"].as_array().cloned().unwrap_or_default();
                    if !is_usual {
                        required.push(tag.into());
                        object["required"] = required.into();
                    }
                    object
                })
                .schema;
            kinds.insert(option.name.to_owned(), kind["$ref"].clone());
        }
        let references: Vec<_> = kinds.values().map(|path| json!({"$ref": path})).collect();
        let mut union = json!({"oneOf": references});
        if presence == Presence::Required {
            union["discriminator"] = json!({"propertyName": tag, "mapping": kinds});
        }
        union
    }

    /// A string as a shorthand for the object with its one field.
    fn short(&mut self, name: &str, fields: &[Field], type_name: &str) -> Value {
        let text = fields
            .iter()
            .find(|field| field.name == name)
            .map(|field| field.shape);
        let mut text = text.map_or(json!({}), |shape| self.plain(&shape, "", false).schema);
        let own = text["description"].as_str().unwrap_or_default();
        text["description"] = format!("short for {{\"{name}\": …}}: {own}").into();
        let object = self.group(&format!("{type_name}Fields"), |writer| writer.object(fields));
        json!({"oneOf": [text, object.schema]})
    }

    /// A string. A fixed list of words becomes a component.
    fn text(&mut self, names: Names, type_name: Option<&str>) -> Plain {
        let name = match names {
            Names::Fixed(_) => type_name.map(camel),
            Names::Family => Some("SceneFamily".to_owned()),
            Names::Method => Some("EnhancementMethod".to_owned()),
            Names::Metric => Some("Metric".to_owned()),
            Names::Artifact => Some("ArtifactKind".to_owned()),
            _ => None,
        };
        let Some(name) = name else {
            let text = format!("{}{}", names.describe(), listed_at(names));
            return bare(json!({"type": "string", "description": text}), "Text");
        };
        let mut listed = self.named(&name, |writer| {
            let mut schema = json!({"type": "string", "enum": writer.vocabulary.listed(names)});
            let about = listed_at(names);
            if !about.is_empty() {
                schema["description"] = format!("{}{about}", names.describe()).into();
            }
            schema
        });
        if let Some(pattern) = find_name_pattern(names) {
            listed.schema = json!({"type": "string", "anyOf": [listed.schema, {"pattern": pattern}]});
        }
        listed
    }

    fn labels(&mut self) -> Plain {
        self.named("Labels", |writer| {
            let value = writer.place(&Shape::Scalar, "", true);
            json!({"type": "object", "additionalProperties": value, "maxProperties": MAX_LABELS,
                   "description": Shape::Labels.limit()})
        })
    }
}

/// The pattern of valid names that are not listed.
fn find_name_pattern(names: Names) -> Option<&'static str> {
    match names {
        Names::Artifact => Some(r"^enhanced\.[a-z][a-z0-9_-]{0,31}(\.[a-z0-9]+)?$"),
        Names::Metric => Some(r"^net\.[a-z0-9_-]{1,64}$"),
        _ => None,
    }
}

fn bare(schema: Value, base: &str) -> Plain {
    Plain {
        schema,
        base: base.to_owned(),
        is_named: false,
    }
}
