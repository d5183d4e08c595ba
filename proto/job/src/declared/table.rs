//! The flattened table of fields, for documentation.

use crate::fields::DOCUMENT;
use crate::schema::{Field, Presence, Shape, Variant};

/// One accepted field.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Row {
    /// Path such as `lights[].x`; for objects of several kinds with the kinds: `scene(uploaded).id`.
    pub path: String,
    /// Type.
    pub kind: &'static str,
    /// Unit of its numbers.
    pub unit: Option<&'static str>,
    /// Limits.
    pub limit: String,
    /// Meaning of absence.
    pub presence: Presence,
    /// Whether a distribution is allowed.
    pub laws: bool,
    /// Meaning, with the rules.
    pub doc: String,
}

impl Row {
    /// Meaning and limits, without the unit.
    #[must_use]
    pub fn summary(&self) -> String {
        match self.limit.as_str() {
            "" => self.doc.clone(),
            limit => format!("{}; {limit}", self.doc),
        }
    }
}

/// Every accepted field, parents before children.
#[must_use]
pub fn rows() -> Vec<Row> {
    let mut rows = Vec::new();
    lay_out("", &DOCUMENT, &mut rows);
    rows
}

/// The table in Markdown.
#[must_use]
pub fn markdown() -> String {
    let mut text =
        "| field | kind | unit | limits | default | varies | meaning |\n|---|---|---|---|---|---|---|\n"
            .to_owned();
    for Row {
        path,
        kind,
        unit,
        limit,
        presence,
        laws,
        doc,
    } in rows()
    {
        let default = match presence {
            Presence::Required => "required".to_owned(),
            Presence::Optional => "–".to_owned(),
            Presence::Default(value) => format!("`{value}`"),
        };
        let unit = unit.unwrap_or("–");
        let law = if laws { "yes" } else { "no" };
        text += &format!("| `{path}` | {kind} | {unit} | {limit} | {default} | {law} | {doc} |\n");
    }
    text
}

/// The objects with a field of this name, for messages; without the kinds and the elements of lists, whose fields
/// depend on the kind.
pub(crate) fn find_owners(name: &str) -> Vec<String> {
    let rows = rows().into_iter().filter(|row| !row.path.contains(['(', '[']));
    rows.filter_map(|row| match row.path.rsplit_once('.') {
        Some((owner, field)) => (field == name).then(|| format!("`{owner}`")),
        None => (row.path == name).then(|| "the description".to_owned()),
    })
    .collect()
}

fn lay_out(path: &str, shape: &Shape, rows: &mut Vec<Row>) {
    match shape {
        Shape::Object(fields) | Shape::OneOf(fields) | Shape::Short(_, fields) => {
            lay_out_fields(path, fields, rows)
        }
        Shape::Tagged {
            tag,
            presence,
            options,
        } => {
            rows.push(Row {
                path: format!("{path}.{tag}"),
                kind: "a string",
                unit: None,
                limit: options
                    .iter()
                    .map(|option| format!("`{}`", option.name))
                    .collect::<Vec<_>>()
                    .join(", "),
                presence: *presence,
                laws: false,
                doc: "selects the other fields".to_owned(),
            });
            lay_out_options(path, options, rows);
        }
        Shape::List { element, .. } => lay_out(&format!("{path}[]"), element, rows),
        Shape::Either(_, object) => lay_out(path, object, rows),
        Shape::Number(_)
        | Shape::Integer(..)
        | Shape::Text(_)
        | Shape::Rgb(_)
        | Shape::Vector(_)
        | Shape::Pair(..)
        | Shape::Bool
        | Shape::Labels
        | Shape::Scalar => {}
    }
}

/// The fields of objects of several kinds. Fields common to several kinds are listed once.
fn lay_out_options(path: &str, options: &[Variant], rows: &mut Vec<Row>) {
    let mut groups: Vec<(Vec<&str>, Vec<Row>)> = Vec::new();
    for option in options {
        for field in option.fields {
            let mut own = Vec::new();
            lay_out_fields("", std::slice::from_ref(field), &mut own);
            match groups.iter_mut().find(|(_, rows)| *rows == own) {
                Some((kinds, _)) => kinds.push(option.name),
                None => groups.push((vec![option.name], own)),
            }
        }
    }
    for (kinds, own) in groups {
        let prefix = format!("{path}({})", kinds.join(", "));
        rows.extend(own.into_iter().map(|row| Row {
            path: format!("{prefix}.{}", row.path),
            ..row
        }));
    }
}

fn lay_out_fields(path: &str, fields: &[Field], rows: &mut Vec<Row>) {
    for field in fields {
        let dot = if path.is_empty() { "" } else { "." };
        let path = format!("{path}{dot}{}", field.name);
        rows.push(Row {
            path: path.clone(),
            kind: field.shape.describe(),
            unit: field.unit,
            limit: field.shape.limit(),
            presence: field.presence,
            laws: field.laws,
            doc: field.meaning(),
        });
        lay_out(&path, &field.shape, rows);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_default_is_json() {
        for row in rows() {
            if let Presence::Default(text) = row.presence {
                assert!(
                    serde_json::from_str::<serde_json::Value>(text).is_ok(),
                    "{}: {text}",
                    row.path
                );
            }
        }
    }

    #[test]
    fn every_path_is_unique_and_has_a_meaning() {
        let rows = rows();
        let mut paths: Vec<_> = rows.iter().map(|row| row.path.as_str()).collect();
        paths.sort_unstable();
        paths.dedup();
        assert_eq!(paths.len(), rows.len());
        assert!(rows.iter().all(|row| !row.doc.is_empty()));
    }

    /// Fields that a job need not write: the service fills them in.
    const FILLED_IN: [&str; 2] = ["scene(collection).id", "water.optics.name"];

    /// Most fields that describe a frame without the parameters of its enhancements: more than this is no longer a
    /// description of a place that a user reads in one go. A new field replaces another, or is derived.
    const MOST_FIELDS: usize = 190;

    /// Most rows of enhancements. Every number of a published method is a parameter, once as an enhancement and once
    /// as a step of a chain; a user needs those of one method at a time.
    const MOST_ENHANCEMENT_FIELDS: usize = 90;

    #[test]
    fn the_description_stays_small() {
        let paths: Vec<_> = rows().into_iter().map(|row| row.path).collect();
        let (enhancements, others): (Vec<_>, Vec<_>) = paths
            .iter()
            .map(String::as_str)
            .partition(|path| path.starts_with("enhance[]"));
        let written = others.iter().filter(|path| !FILLED_IN.contains(path)).count();
        assert_eq!(
            written + FILLED_IN.len(),
            others.len(),
            "the table has every field of FILLED_IN"
        );
        assert!(
            written <= MOST_FIELDS,
            "{written} fields; must be at most {MOST_FIELDS}"
        );
        assert!(
            enhancements.len() <= MOST_ENHANCEMENT_FIELDS,
            "{} fields of enhancements; must be at most {MOST_ENHANCEMENT_FIELDS}",
            enhancements.len()
        );
    }

    #[test]
    fn an_owner_is_an_object_or_the_description() {
        assert_eq!(find_owners("sun_elevation_deg"), ["`daylight`"]);
        assert_eq!(find_owners("alpha"), ["the description"]);
        assert!(
            find_owners("intensity").is_empty(),
            "fields of lights depend on their kind"
        );
    }

    /// A default belongs in the table, or is worded as one.
    #[test]
    fn no_meaning_explains_an_absent_field() {
        for row in rows() {
            assert!(!row.doc.contains("absent"), "{}: {}", row.path, row.doc);
        }
    }
}
