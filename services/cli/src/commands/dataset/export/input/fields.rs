//! `fields.json`: unit and meaning of every array and of every column, from where they are declared.

use cli::classes::Named;
use client::ColumnInfo;
use quality::MetricId;
use serde_json::{Map, Value, json};
use spec::{ArtifactKind, LabelType, Leaves, METRIC_NETWORK};

use crate::commands::dataset::export::format::{Format, RECORD};
use crate::commands::dataset::export::input::selection::Selection;
use crate::commands::dataset::export::input::times::{SEQUENCE, STAMP};
use crate::commands::dataset::export::role::{Z_DEPTH, depth_unit};

/// Columns of every row that are not scalars of its record.
const OWN: [(&str, &str); 9] = [
    ("job", "the job that rendered it"),
    ("frame", "its place in the job, from 0"),
    ("dataset", "the dataset that it joined"),
    ("created_ms", "when it was stored, since 1970"),
    (
        "digest",
        "SHA-256 over its parameters and the digests of its files",
    ),
    ("failed", "whether it failed; such frames have no image"),
    ("warned", "whether its record has warnings"),
    (SEQUENCE, "the sequence that it belongs to"),
    (STAMP, "its time in the sequence"),
];

/// The file's text.
pub(crate) fn fields(format: Format, selection: &Selection, classes: &Named) -> String {
    let stored = selection
        .kinds
        .iter()
        .filter(|kind| !(format.has_times() && *kind == RECORD));
    let arrays = stored.map(|kind| match (format.has_times(), kind.as_str()) {
        (true, "range") => (Z_DEPTH.to_owned(), z_depth(format)),
        _ => (kind.clone(), array(kind)),
    });
    let columns = selection.columns.iter().map(|column| {
        let about = json!({"kind": column.kind, "unit": column.unit, "meaning": meaning(column)});
        (column.name.clone(), about)
    });
    let classes = classes.iter().map(|(id, name)| json!({"id": id, "name": name}));
    let file = json!({
        "arrays": arrays.collect::<Map<_, _>>(),
        "columns": columns.collect::<Map<_, _>>(),
        "classes": classes.collect::<Vec<Value>>(),
    });
    format!("{file:#}\n")
}

fn array(kind: &str) -> Value {
    match ArtifactKind::parse(kind) {
        Some(artifact) => json!({"unit": artifact.unit(), "meaning": artifact.about()}),
        None if kind == RECORD => json!({"unit": null, "meaning": "the record of the frame: JSON"}),
        None => Value::Null,
    }
}

fn z_depth(format: Format) -> Value {
    let hole = if format == Format::Mcap { "NaN" } else { "0" };
    json!({"unit": depth_unit(format), "meaning": format!("distance along the optical axis, {hole} without a return")})
}

/// The meaning of a column.
pub(crate) fn meaning(column: &ColumnInfo) -> String {
    let name = column.name.as_str();
    if let Some((_, meaning)) = OWN.iter().find(|(own, _)| *own == name) {
        return (*meaning).to_owned();
    }
    if let Some(leaf) = Leaves::of_records().scalars.iter().find(|leaf| leaf.name == name) {
        return leaf.doc.to_owned();
    }
    if let Some(kind) = name.strip_prefix("artifacts.") {
        return format!("SHA-256 of its file `{kind}`");
    }
    if let Some(label) = name.strip_prefix("labels.") {
        return format!("label `{label}` of the job");
    }
    if let Some((subject, network)) = split_network(name) {
        let picture = subject.map(|subject| format!(", of `enhanced.{subject}`"));
        return format!("metric of the network `{network}`{}", picture.unwrap_or_default());
    }
    let about = |name: &str| MetricId::parse(name).map(|id| id.info().about);
    match (about(name), name.split_once('.')) {
        (Some(about), _) => about.to_owned(),
        (None, Some((subject, metric))) => match about(metric) {
            Some(about) => format!("{about}, of `enhanced.{subject}`"),
            None => format!("the same as {}", older(name)),
        },
        (None, None) => String::new(),
    }
}

/// The picture, unless it is the frame's own, and the network of `net.NAME` or `SUBJECT.net.NAME`.
fn split_network(name: &str) -> Option<(Option<&str>, &str)> {
    if let Some(network) = name.strip_prefix(METRIC_NETWORK) {
        return Some((None, network));
    }
    let (subject, metric) = name.split_once('.')?;
    Some((Some(subject), metric.strip_prefix(METRIC_NETWORK)?))
}

/// Former names of columns remain valid, without their first word.
fn older(name: &str) -> String {
    let end = format!(".{name}");
    let leaves = Leaves::of_records().scalars;
    let leaf = leaves.iter().find(|leaf| leaf.name.ends_with(&end));
    leaf.map_or_else(|| name.to_owned(), |leaf| format!("`{}`", leaf.name))
}

/// The column for a value of a label of several types.
pub(crate) fn typed_column(name: &str, value: &Value) -> String {
    LabelType::of_value(value).map_or_else(|| name.to_owned(), |label| label.mixed_column(name))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn column(name: &str) -> ColumnInfo {
        ColumnInfo {
            name: name.to_owned(),
            kind: "number".to_owned(),
            unit: None,
        }
    }

    #[test]
    fn every_family_of_columns_has_a_meaning() {
        for (name, part) in [
            ("frame", "place in the job"),
            ("camera.hfov_deg", "horizontal field of view"),
            ("holes", "without a valid range"),
            ("uiqm", ""),
            ("hscm.uiqm", "`enhanced.hscm`"),
            ("net.mine", "network `mine`"),
            ("hscm.net.mine", "`enhanced.hscm`"),
            ("labels.run", "label `run`"),
            ("artifacts.range", "SHA-256"),
            ("snow.radius_m", "`water.snow.radius_m`"),
        ] {
            let meaning = meaning(&column(name));
            assert!(!meaning.is_empty() && meaning.contains(part), "{name}: {meaning}");
        }
        let columns = catalogue::columns_of_every_image(&["uiqm".to_owned()]);
        let silent = columns
            .iter()
            .find(|info| meaning(&column(&info.name)).is_empty());
        assert_eq!(silent, None);
    }

    #[test]
    fn arrays_have_their_unit() {
        assert_eq!(array("range")["unit"], "mm");
        assert!(
            array("transmittance")["meaning"]
                .as_str()
                .is_some_and(|text| text.contains("0..1"))
        );
    }
}
