use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::sync::Arc;

use proptest::prelude::*;

use super::*;
use crate::cache::Cache;
use crate::column::{ColumnBuilder, Kind};
use crate::condition::{Condition, Sign, Test, Value};
use crate::file::{About, ReplicaFile};
use crate::parts::Part;
use crate::write::write;

/// A number, a text, a whole number, each possibly missing, and a job. The frame is the place.
type Row = (Option<f64>, Option<u8>, Option<i64>, u8);

const NAMES: [(&str, Kind); 5] = [
    ("uiqm", Kind::Number),
    ("style", Kind::Text),
    ("holes", Kind::Whole),
    ("job", Kind::Text),
    ("frame", Kind::Whole),
];

fn text(style: u8) -> String {
    format!("style {style}")
}

fn columns(rows: &[(usize, Row)]) -> Vec<Column> {
    let mut all = NAMES.map(|(_, kind)| ColumnBuilder::new(kind));
    for (frame, (number, style, whole, job)) in rows {
        all[0].number(*number);
        all[1].text(style.map(text).as_deref());
        all[2].whole(*whole);
        all[3].text(Some(&format!("job_{job}")));
        all[4].whole(Some(*frame as i64));
    }
    all.into_iter().map(ColumnBuilder::build).collect()
}

fn file(folder: &std::path::Path, rows: &[(usize, Row)]) -> Part {
    let named = NAMES.iter().zip(columns(rows));
    let columns: Vec<_> = named
        .map(|((name, kind), column)| ((*name).to_owned(), *kind, column))
        .collect();
    let about = About {
        first_row: rows[0].0 as i64 + 1,
        last_row: (rows[0].0 + rows.len()) as i64,
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

/// The reference: two rows compared value by value.
fn compared(one: &(usize, Row), other: &(usize, Row), by: Option<(usize, bool)>) -> Ordering {
    fn missing_last<T>(
        a: &Option<T>,
        b: &Option<T>,
        descending: bool,
        compare: impl Fn(&T, &T) -> Ordering,
    ) -> Ordering {
        match (a, b) {
            (None, None) => Ordering::Equal,
            (None, _) => Ordering::Greater,
            (_, None) => Ordering::Less,
            (Some(a), Some(b)) if descending => compare(b, a),
            (Some(a), Some(b)) => compare(a, b),
        }
    }
    let (a, b) = (&one.1, &other.1);
    let first = match by {
        None => Ordering::Equal,
        Some((0, descending)) => missing_last(&a.0, &b.0, descending, |a, b| a.partial_cmp(b).unwrap()),
        Some((1, descending)) => missing_last(&a.1, &b.1, descending, |a, b| text(*a).cmp(&text(*b))),
        Some((_, descending)) => missing_last(&a.2, &b.2, descending, Ord::cmp),
    };
    first.then(a.3.cmp(&b.3)).then(one.0.cmp(&other.0))
}

fn sorted_by(row: &Row, by: usize) -> Option<Sorted> {
    match by {
        0 => row.0.map(Sorted::Number),
        1 => row.1.map(|style| Sorted::Text(text(style))),
        _ => row.2.map(Sorted::Whole),
    }
}

fn row() -> impl Strategy<Value = Row> {
    let number = prop_oneof![
        4 => (-10.0f64..10.0).prop_map(Some),
        2 => (-2i8..3).prop_map(|value| Some(f64::from(value))),
        1 => Just(Some(-0.0)),
        1 => Just(Some(f64::INFINITY)),
        1 => Just(Some(f64::NEG_INFINITY)),
        1 => Just(None),
    ];
    let whole = prop_oneof![3 => prop::option::of(-3i64..3), 1 => prop::option::of(any::<i64>())];
    (number, prop::option::of(0u8..4), whole, 0u8..3)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn rows_of_any_rank_are_those_that_sorting_finds(rows in prop::collection::vec(row(), 0..300), split in 0usize..300,
                                                     by in prop::option::of((0usize..3, any::<bool>())), is_filtered: bool,
                                                     rank in 0usize..310, most in 1usize..40, threads in 1usize..4) {
        let folder = tempfile::tempdir().unwrap();
        let rows: Vec<(usize, Row)> = rows.into_iter().enumerate().collect();
        let counts = |row: &&(usize, Row)| !is_filtered || row.1.0.is_some_and(|number| number < 0.5);
        let (stored, fresh) = rows.split_at(split.min(rows.len()));
        let fresh: Vec<_> = fresh.iter().filter(counts).copied().collect();
        let mut parts = vec![Part::Rows(columns(&fresh).into_iter().map(Arc::new).collect())];
        parts.extend(stored.chunks(97).map(|some| file(folder.path(), some)));
        let condition = Condition::Test("uiqm".to_owned(), Test::Is(Sign::Below, Value::Number(0.5)));
        let (names, cache) = (NAMES.map(|(name, _)| name.to_owned()), Cache::new(1 << 20));
        let query = Query { parts: &parts, columns: &names, condition: is_filtered.then_some(&condition), cache: &cache, threads };
        let order = Order { by, job: 3, frame: 4 };

        let mut expected: Vec<_> = rows.iter().filter(counts).copied().collect();
        expected.sort_by(|one, other| compared(one, other, by));
        let shown = |some: &[(usize, Row)]| some.iter().take(most).map(|(frame, row)| (format!("job_{}", row.3), *frame as i64)).collect::<Vec<_>>();
        let got = |start: &Start| top_k(&query, &order, start, most).unwrap().into_iter().map(|(job, frame)| (job.to_string(), frame)).collect::<Vec<_>>();

        prop_assert_eq!(got(&Start::Behind(rank as u64)), shown(expected.get(rank..).unwrap_or_default()));
        if let Some((frame, row)) = expected.get(rank) {
            let value = by.and_then(|(place, _)| sorted_by(row, place));
            let after = Start::After(value, format!("job_{}", row.3), *frame as i64);
            prop_assert_eq!(got(&after), shown(&expected[rank + 1..]));
        }
    }

    /// The row of a cursor may have been deleted.
    #[test]
    fn a_place_that_no_row_has_lies_between_its_neighbors(rows in prop::collection::vec(row(), 1..60), gone in row(), frame in 0usize..60, descending: bool) {
        let rows: Vec<(usize, Row)> = rows.into_iter().enumerate().map(|(at, row)| (2 * at, row)).collect();
        let parts = [Part::Rows(columns(&rows).into_iter().map(Arc::new).collect())];
        let (names, cache) = (NAMES.map(|(name, _)| name.to_owned()), Cache::new(0));
        let query = Query { parts: &parts, columns: &names, condition: None, cache: &cache, threads: 1 };
        for place in 0..3 {
            let order_by = Some((place, descending));
            let (mut expected, gone) = (rows.clone(), (2 * frame + 1, gone));
            expected.retain(|row| compared(row, &gone, order_by) == Ordering::Greater);
            expected.sort_by(|one, other| compared(one, other, order_by));
            let expected: Vec<_> = expected.iter().map(|(frame, _)| *frame as i64).collect();
            let start = Start::After(sorted_by(&gone.1, place), format!("job_{}", gone.1.3), gone.0 as i64);
            let got = top_k(&query, &Order { by: order_by, job: 3, frame: 4 }, &start, 100).unwrap();
            prop_assert_eq!(got.into_iter().map(|(_, frame)| frame).collect::<Vec<_>>(), expected);
        }
    }

    #[test]
    fn digits_narrow_keys_to_those_that_have_them(key in any::<Key>(), at in 0u32..256) {
        let (low, high) = with_digit(&key, at, digit(&key, at) as u64);
        prop_assert!(low <= key && key <= high);
        prop_assert_eq!((digit(&low, at), digit(&high, at)), (digit(&key, at), digit(&key, at)));
        prop_assert!(low == high || highest_difference(&low, &high) == at + DIGIT);
    }
}
