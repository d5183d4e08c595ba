//! The columns of the rows: those of the catalogue under the same names, and the position of each artifact in the tar.

use std::collections::BTreeMap;

use serde_json::Value;
use spec::{ArtifactEntry, FrameRecord, Job, LabelType, Leaf, Leaves};

use crate::rows::cells::{Cell, Kind};

/// A column.
#[derive(Debug, Clone)]
pub(crate) struct Column {
    /// The same as in queries of the catalogue.
    pub(crate) name: String,
    pub(crate) kind: Kind,
    source: Source,
}

/// The source of a column's values.
#[derive(Debug, Clone)]
enum Source {
    Job,
    Frame,
    Dataset,
    CreatedMs,
    Digest,
    Failed,
    Warned,
    Tar,
    Leaf(Leaf),
    Label { name: String, kind: LabelType },
    Metric { subject: String, metric: String },
    ArtifactDigest(String),
    ArtifactOffset(String),
    ArtifactBytes(String),
    Record,
}

/// The data of a row.
pub(crate) struct Row<'a> {
    pub(crate) record: &'a FrameRecord,
    /// The same as JSON.
    pub(crate) json: &'a Value,
    pub(crate) digest: &'a str,
    pub(crate) created_ms: u64,
    /// Offsets of the artifacts in the tar, by kind.
    pub(crate) offsets: &'a BTreeMap<String, u64>,
}

impl Row<'_> {
    fn artifact(&self, kind: &str) -> Option<&ArtifactEntry> {
        self.record
            .artifacts
            .iter()
            .find(|artifact| artifact.kind == kind)
    }
}

/// What all rows of a shard have in common.
pub(crate) struct Common {
    pub(crate) job: String,
    pub(crate) dataset: String,
    pub(crate) tar: String,
}

/// The columns of a job's set, the same in each of its shards. `metrics` are those of the program.
pub(crate) fn columns(job: &Job, metrics: &[String]) -> Vec<Column> {
    let own = [
        ("job", Kind::Text, Source::Job),
        ("frame", Kind::Whole, Source::Frame),
        ("dataset", Kind::Text, Source::Dataset),
        ("created_ms", Kind::Whole, Source::CreatedMs),
        ("digest", Kind::Text, Source::Digest),
        ("failed", Kind::Flag, Source::Failed),
        ("warned", Kind::Flag, Source::Warned),
        ("tar", Kind::Text, Source::Tar),
    ];
    let own = own.map(|(name, kind, source)| column(name.to_owned(), kind, source));
    let mut columns = Vec::from(own);
    let leaves = Leaves::of_records()
        .scalars
        .into_iter()
        .filter(|leaf| leaf.name != "dataset");
    columns.extend(leaves.map(|leaf| column(leaf.name.clone(), leaf.kind.into(), Source::Leaf(leaf))));
    for (name, types) in job.label_types() {
        for (column_name, label) in spec::label_columns(&name, &types) {
            let kind = match label {
                LabelType::Number => Kind::Number,
                LabelType::Text => Kind::Text,
                LabelType::Bool => Kind::Flag,
            };
            let name = name.clone();
            columns.push(column(column_name, kind, Source::Label { name, kind: label }));
        }
    }
    let mut subjects = job.enhancements();
    subjects.insert("rgb".to_owned());
    for subject in subjects {
        for metric in metrics {
            let name = match subject.as_str() {
                "rgb" => metric.clone(),
                subject => format!("{subject}.{metric}"),
            };
            let (subject, metric) = (subject.clone(), metric.clone());
            columns.push(column(name, Kind::Number, Source::Metric { subject, metric }));
        }
    }
    for artifact in job.words("artifacts") {
        let name = format!("artifacts.{artifact}");
        let (offset, bytes) = (format!("{name}.offset"), format!("{name}.bytes"));
        columns.push(column(name, Kind::Text, Source::ArtifactDigest(artifact.clone())));
        columns.push(column(
            offset,
            Kind::Whole,
            Source::ArtifactOffset(artifact.clone()),
        ));
        columns.push(column(bytes, Kind::Whole, Source::ArtifactBytes(artifact)));
    }
    columns.push(column("record".to_owned(), Kind::Text, Source::Record));
    columns
}

fn column(name: String, kind: Kind, source: Source) -> Column {
    Column { name, kind, source }
}

impl Column {
    /// The value of a row in this column.
    pub(crate) fn cell(&self, row: &Row<'_>, common: &Common) -> Option<Cell> {
        match &self.source {
            Source::Job => Some(Cell::text(&common.job)),
            Source::Frame => Some(Cell::whole(row.record.frame)),
            Source::Dataset => Some(Cell::text(&common.dataset)),
            Source::CreatedMs => Some(Cell::whole(row.created_ms)),
            Source::Digest => Some(Cell::text(row.digest)),
            Source::Failed => Some(Cell::Flag(false)),
            Source::Warned => Some(Cell::Flag(!row.record.warnings.is_empty())),
            Source::Tar => Some(Cell::text(&common.tar)),
            Source::Leaf(leaf) => Cell::of_leaf(leaf.kind, leaf.find(row.json)?),
            Source::Label { name, kind } => {
                let value = row.json.get("parameters")?.get("labels")?.get(name)?;
                if LabelType::of_value(value) != Some(*kind) {
                    return None;
                }
                match value {
                    Value::Bool(flag) => Some(Cell::Flag(*flag)),
                    Value::String(label) => Some(Cell::text(label)),
                    number => number.as_f64().map(Cell::Number),
                }
            }
            Source::Metric { subject, metric } => row
                .record
                .measurements
                .get(subject)?
                .get(metric)
                .copied()
                .map(Cell::Number),
            Source::ArtifactDigest(kind) => Some(Cell::text(&row.artifact(kind)?.digest)),
            Source::ArtifactOffset(kind) => Some(Cell::whole(*row.offsets.get(kind)?)),
            Source::ArtifactBytes(kind) => Some(Cell::whole(row.artifact(kind)?.bytes)),
            Source::Record => Some(Cell::Text(row.json.to_string())),
        }
    }
}
