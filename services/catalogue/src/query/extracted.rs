//! Columns that are read from the record, without a column of the schema.

use spec::METRIC_NETWORK;

use crate::query::filter::{Bind, Column, Join, Kind};

/// The picture of metrics without a subject.
pub(super) const MAIN_SUBJECT: &str = "rgb";

/// The value of a network of the user, `net.NAME` or `SUBJECT.net.NAME`. Networks come while the catalogue is open, so their values
/// have no column of the schema and are read from the record.
pub(super) fn metric_of_network(name: &str) -> Option<Column> {
    let (subject, network) = match name.strip_prefix(METRIC_NETWORK) {
        Some(network) => (MAIN_SUBJECT, network),
        None => {
            let (subject, metric) = name.split_once('.')?;
            (subject, metric.strip_prefix(METRIC_NETWORK)?)
        }
    };
    let are_plain = [subject, network].iter().all(|text| {
        !text.is_empty()
            && text
                .chars()
                .all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || matches!(c, '_' | '-'))
    });
    let path = format!("$.measurements.\"{subject}\".\"{METRIC_NETWORK}{network}\"");
    are_plain.then(|| extracted(path, Kind::Number, None))
}

/// `/parameters/lights/0/color/2` as `$.parameters.lights[0].color[2]`.
pub(super) fn json_path(pointer: &str) -> String {
    let steps: String = pointer
        .split('/')
        .skip(1)
        .map(|step: &str| match step.parse::<u16>() {
            Ok(position) => format!("[{position}]"),
            Err(_) => format!(".{step}"),
        })
        .collect();
    format!("${steps}")
}

/// A value at a place of the record.
pub(super) fn extracted(path: String, kind: Kind, unit: Option<&'static str>) -> Column {
    let record = Join::record_json();
    // In SQLite text is greater than every number, and a list is text: such values must not compare as numbers.
    let sql = match kind {
        Kind::Text => format!("CAST(json_extract({record}, ?) AS TEXT)"),
        Kind::Number | Kind::Whole | Kind::Large | Kind::Bool | Kind::Label => {
            format!("(SELECT iif(typeof(v) = 'text', NULL, v) FROM (SELECT json_extract({record}, ?) AS v))")
        }
    };
    Column {
        binds: vec![Bind::Text(path)],
        unit,
        join: Some(Join::Record),
        ..Column::new(sql, kind)
    }
}
