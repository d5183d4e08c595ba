use std::collections::BTreeMap;

use super::*;
use crate::column::ColumnBuilder;
use crate::condition::Bound;
use crate::file::ReplicaFile;

fn columns() -> Vec<(String, Kind, Column)> {
    let mut text = ColumnBuilder::new(Kind::Text);
    let mut number = ColumnBuilder::new(Kind::Number);
    let mut whole = ColumnBuilder::new(Kind::Whole);
    let mut large = ColumnBuilder::new(Kind::Large);
    let mut flag = ColumnBuilder::new(Kind::Flag);
    let mut full = ColumnBuilder::new(Kind::Number);
    let mut void = ColumnBuilder::new(Kind::Text);
    for row in 0..5000_i64 {
        text.text((row % 7 > 0).then(|| format!("text {}", row % 1000)).as_deref());
        number.number((row % 5 > 0).then_some(row as f64 / 3.0));
        whole.whole((row % 3 > 0).then_some(row - 100));
        large.whole((row % 11 > 0).then_some(i64::MIN + row));
        flag.whole(Some(row % 2));
        full.number(Some((row as f64).sin()));
        void.text(None);
    }
    let named = |name: &str, kind, column: ColumnBuilder| (name.to_owned(), kind, column.build());
    vec![
        named("water.style", Kind::Text, text),
        named("alpha", Kind::Number, number),
        named("frame", Kind::Whole, whole),
        named("seed", Kind::Large, large),
        named("warned", Kind::Flag, flag),
        named("uiqm", Kind::Number, full),
        named("void", Kind::Text, void),
    ]
}

fn about() -> About {
    About {
        first_row: 1,
        last_row: 5000,
        columns: "of some names".to_owned(),
        jobs: BTreeMap::from([("job_a".to_owned(), 5000)]),
        checksums: Vec::new(),
    }
}

/// Text of a column, in which missing values (NaN) are equal.
fn shown(column: &Column) -> String {
    format!("{column:?}")
}

#[test]
fn what_is_written_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let columns = columns();
    let named = write(folder.path(), &columns, about()).unwrap();
    let path = folder.path().join(&named.name);
    assert_eq!(std::fs::metadata(&path).unwrap().len(), named.bytes);
    let file = ReplicaFile::open(&path, &named.digest).unwrap();
    file.check().unwrap();
    assert_eq!((file.rows(), &file.about().jobs), (5000, &about().jobs));
    for (name, _, column) in &columns[..6] {
        assert_eq!(shown(&file.read(name).unwrap()), shown(column), "{name}");
    }
    assert_eq!(file.read("void").unwrap(), Column::Missing(5000));
    let alpha = file.range("alpha").unwrap();
    assert_eq!((alpha.low, alpha.any_missing), (Bound::Number(1.0 / 3.0), true));
    assert_eq!(file.range("frame").unwrap().high, Bound::Whole(4899));
    assert!(file.range("uiqm").is_some_and(|range| !range.any_missing));
}

#[test]
fn no_damaged_byte_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let named = write(folder.path(), &columns(), about()).unwrap();
    let path = folder.path().join(&named.name);
    let bytes = std::fs::read(&path).unwrap();
    // The first four bytes are those of the format's name.
    for at in (4..bytes.len()).step_by(611) {
        let mut damaged = bytes.clone();
        damaged[at] ^= 0x10;
        std::fs::write(&path, &damaged).unwrap();
        let found = ReplicaFile::open(&path, &named.digest).and_then(|file| file.check());
        assert!(matches!(found, Err(ColumnarError::Damaged { .. })), "byte {at}");
    }
    for length in [0, 3, 11, bytes.len() / 2, bytes.len() - 1] {
        std::fs::write(&path, &bytes[..length]).unwrap();
        let found = ReplicaFile::open(&path, &named.digest).and_then(|file| file.check());
        assert!(found.is_err(), "{length} bytes");
    }
}
