//! Whole numbers that a table would change.

use cli::exit::Failure;
use serde_json::Value;
use sets::MOST_EXACT;
use spec::LeafKind;

use super::tables::{CellKind, TableColumn};

/// The programs that read a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Readers {
    /// Every reader of Parquet.
    Any,
    /// The library `datasets`, whose whole numbers have 63 bits.
    HuggingFace,
}

/// An error for the first whole number of a row that its column or its readers cannot hold.
pub(crate) fn check_exact(columns: &[TableColumn], row: &Value, readers: Readers) -> Result<(), Failure> {
    for TableColumn { name, kind } in columns {
        let value = &row[name.as_str()];
        let size = value.as_u64().or_else(|| value.as_i64().map(i64::unsigned_abs));
        let (limit, reason) = match kind {
            CellKind::Leaf(LeafKind::Number) => (MOST_EXACT, "a column of doubles would round it"),
            CellKind::Leaf(LeafKind::Large) if readers == Readers::HuggingFace => {
                (i64::MAX as u64, "`datasets.load_dataset` reads no larger one")
            }
            _ => continue,
        };
        if size.is_some_and(|size| size > limit) {
            return Err(Failure::BadInput(format!(
                "`{name}` of frame {} is {value}, beyond {limit}: {reason}; export with `--format folder`, which keeps all digits",
                row["frame"]
            )));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    fn check(kind: LeafKind, value: Value, readers: Readers) -> Option<String> {
        let columns = [TableColumn {
            name: "x".to_owned(),
            kind: CellKind::Leaf(kind),
        }];
        let checked = check_exact(&columns, &json!({"frame": 3, "x": value}), readers);
        checked.err().map(|failure| failure.to_string())
    }

    #[test]
    fn numbers_that_change_are_errors() {
        let error = check(LeafKind::Number, json!(9_007_199_254_740_993u64), Readers::Any).unwrap();
        assert!(error.contains("`x` of frame 3 is 9007199254740993"), "{error}");
        assert!(check(LeafKind::Number, json!(-9_007_199_254_740_993i64), Readers::Any).is_some());
        assert_eq!(check(LeafKind::Number, json!(1u64 << 53), Readers::Any), None);
        assert_eq!(check(LeafKind::Number, json!(1e300), Readers::Any), None);
        assert_eq!(check(LeafKind::Large, json!(u64::MAX), Readers::Any), None);
        assert!(check(LeafKind::Large, json!(u64::MAX), Readers::HuggingFace).is_some());
        assert_eq!(check(LeafKind::Text, json!("a"), Readers::HuggingFace), None);
    }
}
