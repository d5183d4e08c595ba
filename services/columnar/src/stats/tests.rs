use std::collections::BTreeMap;
use std::sync::Arc;

use proptest::prelude::*;

use super::sorting::summary;
use super::*;
use crate::bins::Bins;
use crate::cache::Cache;
use crate::column::{ColumnBuilder, Kind};
use crate::condition::{Condition, Sign, Test, Value};
use crate::file::{About, ReplicaFile};
use crate::parts::Part;
use crate::write::write;

#[test]
fn statistics_are_those_of_the_textbook() {
    let stats = summary(vec![4.0, 1.0, 2.0, 3.0]);
    assert_eq!(
        (stats.count, stats.mean, stats.min, stats.max),
        (4, Some(2.5), Some(1.0), Some(4.0))
    );
    assert_eq!(
        (stats.q25, stats.median, stats.q75),
        (Some(1.75), Some(2.5), Some(3.25))
    );
    assert!((stats.sd.unwrap() - (5.0f64 / 3.0).sqrt()).abs() < 1e-15);
    let none = summary(Vec::new());
    assert_eq!(
        (none.count, none.mean, none.sd, none.median),
        (0, None, None, None)
    );
}

/// A value, a style and an α, each possibly missing.
type Row = (Option<f64>, Option<u8>, Option<f64>);

fn names() -> Vec<String> {
    ["uiqm", "style", "alpha"].map(str::to_owned).to_vec()
}

fn columns(rows: &[Row]) -> [crate::column::Column; 3] {
    let mut value = ColumnBuilder::new(Kind::Number);
    let mut style = ColumnBuilder::new(Kind::Text);
    let mut alpha = ColumnBuilder::new(Kind::Number);
    for (one, two, three) in rows {
        value.number(*one);
        style.text(two.map(|style| format!("style {style}")).as_deref());
        alpha.number(*three);
    }
    [value.build(), style.build(), alpha.build()]
}

fn file(folder: &std::path::Path, rows: &[Row], first_row: i64) -> Part {
    let kinds = [Kind::Number, Kind::Text, Kind::Number];
    let columns: Vec<_> = names()
        .into_iter()
        .zip(kinds)
        .zip(columns(rows))
        .map(|((name, kind), column)| (name, kind, column))
        .collect();
    let about = About {
        first_row,
        last_row: first_row + rows.len() as i64 - 1,
        columns: String::new(),
        jobs: BTreeMap::new(),
        checksums: Vec::new(),
    };
    let named = write(folder, &columns, about).unwrap();
    let file = ReplicaFile::open(&folder.join(&named.name), &named.digest).unwrap();
    Part::File {
        file: Arc::new(file),
        jobs: None,
    }
}

fn value() -> impl Strategy<Value = Option<f64>> {
    prop_oneof![
        6 => (-10.0f64..10.0).prop_map(Some),
        2 => (-3i8..3).prop_map(|value| Some(f64::from(value))),
        1 => Just(Some(-0.0)),
        1 => Just(None),
        1 => (-1e-30f64..1e30).prop_map(Some),
    ]
}

fn row() -> impl Strategy<Value = Row> {
    (value(), prop::option::of(0u8..4), prop::option::of(0.0f64..1.0))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// The reference: rows one by one into groups, each sorted.
    #[test]
    fn passes_over_files_find_what_sorting_finds(rows in prop::collection::vec(row(), 0..400), split in 0usize..400,
                                                  by_style: bool, by_alpha: bool, is_filtered: bool, threads in 1usize..4) {
        let folder = tempfile::tempdir().unwrap();
        let split = split.min(rows.len());
        let counts = |row: &&Row| !is_filtered || row.2.is_some_and(|alpha| alpha < 0.6);
        let in_memory: Vec<Row> = rows[split..].iter().filter(counts).copied().collect();
        let mut parts = vec![Part::Rows(columns(&in_memory).into_iter().map(Arc::new).collect())];
        for (at, some) in rows[..split].chunks(97).enumerate() {
            parts.push(file(folder.path(), some, 1 + 97 * at as i64));
        }
        let condition = Condition::Test("alpha".to_owned(), Test::Is(Sign::Below, Value::Number(0.6)));
        let (names, cache) = (names(), Cache::new(1 << 20));
        let query = Query { parts: &parts, columns: &names, condition: is_filtered.then_some(&condition), cache: &cache, threads };
        let bins = Bins::new(0.25);
        let mut by = Vec::new();
        if by_style { by.push(GroupBy { column: 1, bins: None }); }
        if by_alpha { by.push(GroupBy { column: 2, bins: Some(bins) }); }

        let mut expected: BTreeMap<String, Vec<f64>> = BTreeMap::new();
        for (value, style, alpha) in rows.iter().filter(counts) {
            let mut key = Vec::new();
            if by_style { key.push(style.map_or(Cell::Missing, |style| Cell::Text(format!("style {style}").into()))); }
            if by_alpha { key.push(alpha.map_or(Cell::Missing, |alpha| Cell::Edge(bins.lower_edge(alpha).to_bits()))); }
            expected.entry(format!("{key:?}")).or_default().extend(value);
        }
        let expected: BTreeMap<String, String> = expected.into_iter().map(|(key, values)| (key, format!("{:?}", summary(values)))).collect();
        let (got, source) = stats(&query, 1, &by, Some(1000)).unwrap();
        let got: BTreeMap<String, String> = got.into_iter().map(|(key, all)| (format!("{key:?}"), format!("{:?}", all[0]))).collect();
        prop_assert_eq!(got, expected);
        prop_assert_eq!(source.memory, in_memory.len() as u64);
        prop_assert_eq!(source.files, rows[..split].iter().filter(counts).count() as u64);
    }
}

#[test]
fn more_groups_than_allowed_are_refused() {
    let rows: Vec<Row> = (0..50)
        .map(|row| (Some(1.0), None, Some(f64::from(row))))
        .collect();
    let parts = [Part::Rows(columns(&rows).into_iter().map(Arc::new).collect())];
    let (names, cache) = (names(), Cache::new(0));
    let query = Query {
        parts: &parts,
        columns: &names,
        condition: None,
        cache: &cache,
        threads: 2,
    };
    let grouping = [GroupBy {
        column: 2,
        bins: None,
    }];
    assert!(matches!(
        stats(&query, 1, &grouping, Some(49)),
        Err(ColumnarError::TooManyGroups(49))
    ));
    for most in [Some(50), None] {
        assert_eq!(stats(&query, 1, &grouping, most).unwrap().0.len(), 50);
    }
}

#[test]
fn values_without_bins_and_the_values_of_many_groups_are_sorted() {
    let infinite = [4.0, f64::INFINITY, 1.0, -1e308, 1e308];
    let rows: Vec<Row> = infinite.map(|value| (Some(value), None, None)).to_vec();
    let many: Vec<Row> = (0..3 * MOST_BINNED_GROUPS)
        .map(|row| (Some(row as f64), None, Some((row / 2) as f64)))
        .collect();
    let summaries = |rows: &[Row], by: &[GroupBy]| {
        let lots = rows.chunks(999);
        let parts: Vec<Part> = lots
            .map(|lot| Part::Rows(columns(lot).into_iter().map(Arc::new).collect()))
            .collect();
        let (names, cache) = (names(), Cache::new(0));
        let query = Query {
            parts: &parts,
            columns: &names,
            condition: None,
            cache: &cache,
            threads: 3,
        };
        stats(&query, 1, by, None).unwrap().0
    };
    let summarized = &summaries(&rows, &[])[0].1[0];
    assert_eq!(
        format!("{summarized:?}"),
        format!("{:?}", summary(infinite.to_vec()))
    );
    let grouping = [GroupBy {
        column: 2,
        bins: None,
    }];
    let groups = summaries(&many, &grouping);
    assert_eq!(groups.len(), 3 * MOST_BINNED_GROUPS / 2);
    for (key, all) in groups {
        let Cell::Number(bits) = key[0] else {
            panic!("{key:?}")
        };
        let first = 2.0 * f64::from_bits(bits);
        assert_eq!(all[0], summary(vec![first, first + 1.0]));
    }
}
