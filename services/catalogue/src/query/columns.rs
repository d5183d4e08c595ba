//! The queryable columns of an image: the leaves of a record, from which schema, insert and filter language are derived.

use std::sync::Arc;

use serde::Deserializer;
use spec::{Leaf, LeafKind, Leaves, List};

use crate::query::extracted::{MAIN_SUBJECT, extracted, json_path, metric_of_network};
use crate::query::filter::{Bind, Column, Join, Kind};
use crate::query::leaf_tree::LeafTree;
use crate::query::record_value::RecordValue;

/// Former names of columns.
const ALIASES: &[(&str, &str)] = &[
    ("snow.density_per_m3", "water.snow.density_per_m3"),
    ("snow.radius_m", "water.snow.radius_m"),
    ("snow.near_m", "water.snow.near_m"),
    ("snow.far_m", "water.snow.far_m"),
    ("snow.albedo.r", "water.snow.albedo.r"),
    ("snow.albedo.g", "water.snow.albedo.g"),
    ("snow.albedo.b", "water.snow.albedo.b"),
    ("turbidity.contrast", "water.turbidity.contrast"),
    ("turbidity.scale_m", "water.turbidity.scale_m"),
    ("path.frame", "camera.path.frame"),
];

/// Columns of every row: (name in queries, SQL, kind, unit). `failed` is false in every row, since failed frames have no image; it
/// exists because users expect it. A bare 0 would be the number of a column after ORDER BY.
const OWN: &[(&str, &str, Kind, Option<&str>)] = &[
    ("job", "images.job_id", Kind::Text, None),
    ("frame", "images.frame", Kind::Whole, None),
    ("dataset", "images.dataset", Kind::Text, None),
    ("created_ms", "images.created_ms", Kind::Whole, Some("ms")),
    ("digest", "images.digest", Kind::Text, None),
    ("failed", "(1 = 0)", Kind::Bool, None),
    ("warned", "(images.warnings > 0)", Kind::Bool, None),
];

/// All columns of one catalogue.
#[derive(Debug, Clone)]
pub(crate) struct Columns {
    metrics: Vec<String>,
    /// Those of the record, apart from those that every row has.
    leaves: Arc<[Leaf]>,
    tree: Arc<LeafTree>,
    lists: Arc<[List]>,
}

/// A column of the schema.
pub(crate) struct Added {
    pub(crate) table: &'static str,
    pub(crate) name: String,
    pub(crate) kind: &'static str,
    /// Its former name.
    pub(crate) before: Option<&'static str>,
}

impl Columns {
    pub(crate) fn new(metrics: &[String]) -> Self {
        let Leaves { mut scalars, lists } = Leaves::of_records();
        scalars.retain(|leaf| OWN.iter().all(|(own, ..)| *own != leaf.name));
        Self {
            metrics: metrics.to_vec(),
            tree: LeafTree::new(&scalars).into(),
            leaves: scalars.into(),
            lists: lists.into(),
        }
    }

    pub(crate) fn metrics(&self) -> &[String] {
        &self.metrics
    }

    /// The wide columns that the schema needs.
    pub(crate) fn added(&self) -> Vec<Added> {
        let leaves = self.leaves.iter().map(|leaf| Added {
            table: "images",
            name: stored_name(leaf),
            kind: match leaf.kind {
                LeafKind::Number => "REAL",
                LeafKind::Whole | LeafKind::Large | LeafKind::Length => "INTEGER",
                LeafKind::Text => "TEXT",
            },
            before: ALIASES
                .iter()
                .find(|(_, name)| *name == leaf.name)
                .map(|(before, _)| *before),
        });
        let metrics = self.metrics.iter().map(|name| Added {
            table: "measurements",
            name: name.clone(),
            kind: "REAL",
            before: None,
        });
        leaves.chain(metrics).collect()
    }

    /// The stored names of the record's columns, in their order.
    pub(crate) fn stored_names(&self) -> impl ExactSizeIterator<Item = String> {
        self.leaves.iter().map(stored_name)
    }

    /// The values of a record in the order of [`Columns::stored_names`]: JSON, as text or as values.
    pub(crate) fn stored_values<'de, D: Deserializer<'de>>(
        &self,
        record: D,
    ) -> Result<Vec<Option<Bind>>, D::Error> {
        self.tree.read(record)
    }

    /// Names that a query may use, apart from the open families `labels.…`, `timings.…`, `LIST.N.…` such as
    /// `lights.0.x`, `artifacts.KIND` (its digest), `SUBJECT.METRIC`, and `net.NAME` and `SUBJECT.net.NAME` of networks.
    pub(crate) fn names(&self) -> Vec<String> {
        let own = OWN.iter().map(|(name, ..)| (*name).to_owned());
        let aliases = ALIASES.iter().map(|(name, _)| (*name).to_owned());
        own.chain(self.leaves.iter().map(|leaf| leaf.name.clone()))
            .chain(aliases)
            .chain(self.metrics.iter().cloned())
            .collect()
    }

    /// The columns of the replica that every image may have, without measurements.
    pub(crate) fn replicated(&self) -> Vec<Column> {
        let own = OWN.iter().map(|(name, ..)| *name);
        let leaves = self.leaves.iter().map(|leaf| leaf.name.as_str());
        let all = own.chain(leaves).filter_map(|name| self.get(name));
        all.filter(|column| column.replica_name.is_some()).collect()
    }

    /// Digest of the names of all columns that the replica may have; files with other columns are written again.
    pub(crate) fn replica_digest(&self) -> String {
        let names = self
            .replicated()
            .into_iter()
            .filter_map(|column| column.replica_name);
        let names: Vec<String> = names.chain(self.metrics.iter().cloned()).collect();
        spec::sha256(names.join("\n").as_bytes())
    }

    /// A record and its digest with the other fields of the digest, as they are read for verification.
    pub(crate) fn of_record(&self) -> Vec<Column> {
        let beside = ["job", "frame", "dataset", "created_ms", "digest"];
        let own = beside.into_iter().filter_map(|name| self.get(name));
        let record = ["record", "row_digest"].map(|name| Column {
            join: Some(Join::Record),
            ..Column::new(format!("{}.{name}", Join::Record.alias()), Kind::Text)
        });
        own.chain(record).collect()
    }

    /// The column of a name.
    pub(crate) fn get(&self, name: &str) -> Option<Column> {
        if let Some((_, sql, kind, unit)) = OWN.iter().find(|(own, ..)| *own == name) {
            return Some(Column {
                unit: *unit,
                always: true,
                found: (name == "warned").then_some(RecordValue::Warned),
                // Digests are unique, so they need no aggregation.
                replica_name: (name != "digest").then(|| name.to_owned()),
                ..Column::new((*sql).to_owned(), *kind)
            });
        }
        let alias = ALIASES.iter().find(|(alias, _)| *alias == name);
        let name = alias.map_or(name, |(_, name)| name);
        if let Some(leaf) = self.leaves.iter().find(|leaf| leaf.name == name) {
            return Some(Column {
                unit: leaf.unit,
                found: Some(RecordValue::Leaf(leaf.clone())),
                replica_name: Some(leaf.name.clone()),
                ..Column::new(format!("images.\"{}\"", stored_name(leaf)), kind(leaf))
            });
        }
        // A label may be called like a metric.
        open_family(name)
            .or_else(|| self.metric(name))
            .or_else(|| metric_of_network(name))
            .or_else(|| self.element(name))
    }

    fn metric(&self, name: &str) -> Option<Column> {
        let (subject, metric) = if self.metrics.iter().any(|metric| metric == name) {
            (MAIN_SUBJECT, name)
        } else {
            name.split_once('.')?
        };
        let plain = subject
            .chars()
            .all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || matches!(c, '_' | '-'));
        let known = self.metrics.iter().find(|known| *known == metric)?;
        (plain && !subject.is_empty()).then(|| {
            let join = Join::Measured(subject.to_owned());
            let sql = format!("{}.\"{known}\"", join.alias());
            let (subject, metric) = (subject.to_owned(), known.clone());
            Column {
                join: Some(join),
                replica_name: Some(measured_name(&subject, &metric)),
                found: Some(RecordValue::Metric { subject, metric }),
                ..Column::new(sql, Kind::Number)
            }
        })
    }

    /// A scalar of an element of a list, such as `lights.0.color.r` or `enhance.1`.
    fn element(&self, name: &str) -> Option<Column> {
        let (list, rest) = name.split_once('.')?;
        let list = self.lists.iter().find(|known| known.name == list)?;
        let (position, field) = rest.split_once('.').unwrap_or((rest, ""));
        let position: u16 = position.parse().ok()?;
        let leaf = list.element.iter().find(|leaf| leaf.name == field)?;
        let path = json_path(&format!("{}/{position}{}", list.pointer, leaf.pointer));
        Some(extracted(path, kind(leaf), leaf.unit))
    }
}

/// The name of a picture's metric in the replica and in queries.
pub(crate) fn measured_name(subject: &str, metric: &str) -> String {
    match subject {
        MAIN_SUBJECT => metric.to_owned(),
        _ => format!("{subject}.{metric}"),
    }
}

/// The column of a leaf in the schema. The name of a large number contains the offset by which it is stored in an INTEGER.
fn stored_name(leaf: &Leaf) -> String {
    match leaf.kind {
        LeafKind::Large => format!("{} - 2^63", leaf.name),
        _ => leaf.name.clone(),
    }
}

fn kind(leaf: &Leaf) -> Kind {
    match leaf.kind {
        LeafKind::Number => Kind::Number,
        LeafKind::Whole | LeafKind::Length => Kind::Whole,
        LeafKind::Large => Kind::Large,
        LeafKind::Text => Kind::Text,
    }
}

/// Names that depend on the job: labels, digests of artifacts as text, times in milliseconds as numbers.
fn open_family(name: &str) -> Option<Column> {
    // The names that a description allows; others are not labels, and a NUL would end a JSON path.
    let quoted = |key: &str| {
        (!key.is_empty()
            && key
                .chars()
                .all(|c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '.' | '-')))
        .then(|| format!("\"{key}\""))
    };
    if let Some(kind) = name.strip_prefix("artifacts.") {
        let sql = "(SELECT a.digest FROM artifacts a
                    WHERE a.job_id = images.job_id AND a.frame = images.frame AND a.kind = ?)";
        return Some(Column {
            binds: vec![Bind::Text(kind.to_owned())],
            found: Some(RecordValue::Artifact(kind.to_owned())),
            ..Column::new(sql.to_owned(), Kind::Text)
        });
    }
    if let Some(label) = name.strip_prefix("labels.") {
        let path = format!("$.parameters.labels.{}", quoted(label)?);
        return Some(Column {
            binds: vec![Bind::Text(path)],
            join: Some(Join::Record),
            found: Some(RecordValue::Label(label.to_owned())),
            ..Column::new(format!("json_extract({}, ?)", Join::record_json()), Kind::Label)
        });
    }
    let stage = name.strip_prefix("timings.")?;
    Some(extracted(
        format!("$.timings_ms.{}", quoted(stage)?),
        Kind::Number,
        Some("ms"),
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn columns() -> Columns {
        Columns::new(&["uiqm".to_owned()])
    }

    #[test]
    fn the_value_of_a_network_is_read_from_the_record() {
        let columns = columns();
        for (name, path) in [
            ("net.my-net", "$.measurements.\"rgb\".\"net.my-net\""),
            ("hscm.net.my-net", "$.measurements.\"hscm\".\"net.my-net\""),
        ] {
            let column = columns.get(name).unwrap();
            assert_eq!(column.binds, [Bind::Text(path.to_owned())]);
            assert_eq!(column.kind, Kind::Number);
        }
        for name in [
            "net.",
            "hscm.net.",
            ".net.x",
            "net.a\"b",
            "net.A",
            "hscm.net",
            "a.b.net.x",
        ] {
            assert!(columns.get(name).is_none(), "{name}");
        }
    }

    #[test]
    fn every_leaf_of_a_record_is_a_column_under_its_own_name() {
        let (columns, leaves) = (columns(), Leaves::of_records());
        let stored: Vec<_> = columns.added().into_iter().map(|added| added.name).collect();
        for leaf in &leaves.scalars {
            let column = columns.get(&leaf.name).unwrap_or_else(|| panic!("{}", leaf.name));
            let own = OWN.iter().any(|(name, ..)| *name == leaf.name);
            assert!(own || stored.contains(&stored_name(leaf)), "{}", leaf.name);
            assert!(own || column.unit == leaf.unit, "{}", leaf.name);
            assert!(columns.names().contains(&leaf.name), "{}", leaf.name);
        }
        let wide = stored.len() - columns.metrics.len();
        let own = leaves.scalars.len() - columns.leaves.len();
        assert_eq!(
            (wide, own),
            (leaves.scalars.len() - 1, 1),
            "only the dataset is a row's own"
        );
        for list in &leaves.lists {
            for leaf in &list.element {
                let dot = if leaf.name.is_empty() { "" } else { "." };
                let name = format!("{}.3{dot}{}", list.name, leaf.name);
                assert_eq!(
                    columns.get(&name).map(|column| column.kind),
                    Some(kind(leaf)),
                    "{name}"
                );
            }
        }
    }

    #[test]
    fn names_of_before_are_found() {
        for (alias, name) in ALIASES {
            assert_eq!(columns().get(alias), columns().get(name), "{alias}");
            assert!(columns().get(name).is_some(), "{name}");
        }
    }

    #[test]
    fn an_element_of_a_list_is_reached_by_its_place() {
        let color = columns().get("lights.1.color.b").unwrap();
        assert_eq!(
            color.binds,
            [Bind::Text("$.parameters.lights[1].color[2]".to_owned())]
        );
        let method = columns().get("enhance.0").unwrap();
        assert_eq!(
            (method.kind, method.binds),
            (Kind::Text, vec![Bind::Text("$.parameters.enhance[0]".to_owned())])
        );
        for name in [
            "lights.0",
            "lights.0.hue.b",
            "lights.x.y",
            "lights.-1.x",
            "lights.70000.x",
        ] {
            assert_eq!(columns().get(name), None, "{name}");
        }
    }
}
