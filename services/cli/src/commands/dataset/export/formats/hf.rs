//! `metadata.parquet` of a folder of images for Hugging Face: columns `file_name` and `KIND_file_name` have the paths of pictures.

use std::fs::{self, File};
use std::io::{BufRead, BufReader};
use std::path::Path;

use anyhow::Context;
use cli::exit::Failure;
use client::ColumnInfo;
use serde_json::Value;

use crate::commands::dataset::export::files::lists::Rows;
use crate::commands::dataset::export::files::target::{create, draft_of};
use crate::commands::dataset::export::formats::exact::{Readers, check_exact};
use crate::commands::dataset::export::formats::table_file::write_table;
use crate::commands::dataset::export::formats::tables::{TableRow, table_columns, text_column};

const TABLE: &str = "metadata.parquet";
/// Rows of a group.
const GROUP_ROWS: usize = 1000;
/// File extensions of pictures for the reader.
const PICTURES: [&str; 3] = [".png", ".jpg", ".webp"];

/// Writes the rows as a table in place of their list; returns its name.
pub(crate) fn write(
    folder: &Path,
    rows: Rows,
    columns: &[ColumnInfo],
    kinds: &[String],
) -> Result<String, Failure> {
    let path = folder.join(TABLE);
    let list = File::open(&rows.draft).with_context(|| format!("cannot read {}", rows.draft.display()))?;
    let mut lines = BufReader::new(list).lines().peekable();
    let first: Value = match lines.peek() {
        Some(Ok(line)) => serde_json::from_str(line).context("a row is JSON")?,
        _ => Value::Null,
    };
    let names: Vec<(String, String)> = kinds
        .iter()
        .skip(1)
        .map(|kind| (kind.clone(), name_of(kind, &first)))
        .collect();
    let mut all = table_columns(columns);
    all.push(text_column("file_name"));
    all.extend(names.iter().map(|(_, name)| text_column(name)));
    let mut group = || {
        lines
            .by_ref()
            .take(GROUP_ROWS)
            .map(|line: std::io::Result<String>| {
                let line = line.context("cannot read the rows")?;
                let mut values: Value = serde_json::from_str(&line).context("a row is JSON")?;
                check_exact(&all, &values, Readers::HuggingFace)?;
                for (kind, name) in &names {
                    values[name] = values[kind].take();
                }
                Ok(TableRow {
                    values,
                    files: Vec::new(),
                })
            })
            .collect()
    };
    let draft = draft_of(&path);
    let file = create(&draft).with_context(|| format!("cannot write {}", path.display()))?;
    write_table(file, &all, &mut group)?;
    fs::rename(&draft, &path).with_context(|| format!("cannot write {}", path.display()))?;
    rows.remove()?;
    Ok(TABLE.to_owned())
}

/// The column of a kind: pictures are read as such.
fn name_of(kind: &str, row: &Value) -> String {
    let file = row[kind].as_str().unwrap_or_default();
    match PICTURES.iter().any(|end| file.ends_with(end)) {
        true => format!("{kind}_file_name"),
        false => kind.to_owned(),
    }
}
