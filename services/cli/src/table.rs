//! Text tables for people: words left, numbers right.

use client::ImageRow;
use serde_json::Value;

/// The cell of a missing value.
pub const DASH: &str = "–";

/// Lays out a header and rows in columns.
pub fn table(header: &[&str], rows: &[Vec<String>]) -> String {
    columns(header, rows, |column| column == 0)
}

/// Lays out columns of text, all of them on the left.
pub fn text_table(header: &[&str], rows: &[Vec<String>]) -> String {
    columns(header, rows, |_| true)
}

fn columns(header: &[&str], rows: &[Vec<String>], is_left: impl Fn(usize) -> bool) -> String {
    let widths: Vec<usize> = (0..header.len())
        .map(|column| {
            let cells = rows
                .iter()
                .filter_map(|row| row.get(column))
                .map(|cell| cell.chars().count());
            cells.chain([header[column].chars().count()]).max().unwrap_or(0)
        })
        .collect();
    let line = |cells: Vec<&str>| {
        let padded: Vec<String> = cells
            .iter()
            .zip(&widths)
            .enumerate()
            .map(|(column, (cell, &width))| {
                if is_left(column) {
                    format!("{cell:<width$}")
                } else {
                    format!("{cell:>width$}")
                }
            })
            .collect();
        padded.join("  ").trim_end().to_owned()
    };
    let rule: Vec<String> = widths.iter().map(|&width| "─".repeat(width)).collect();
    let mut lines = vec![line(header.to_vec()), rule.join("  ")];
    lines.extend(
        rows.iter()
            .map(|row| line(row.iter().map(String::as_str).collect())),
    );
    lines.join("\n")
}

/// Images as rows with these columns.
pub fn image_table(columns: &[impl AsRef<str>], rows: &[ImageRow]) -> String {
    let header: Vec<&str> = columns.iter().map(AsRef::as_ref).collect();
    let cells: Vec<Vec<String>> = rows
        .iter()
        .map(|row| header.iter().map(|column| cell(row.value(column))).collect())
        .collect();
    table(&header, &cells)
}

/// A number with at most four decimals, a dash without one.
pub fn optional_decimal(number: Option<f64>) -> String {
    number.map_or_else(|| DASH.to_owned(), decimal)
}

/// A JSON scalar as a cell: numbers with up to four decimals, null as a dash.
pub fn cell(value: &Value) -> String {
    match value {
        Value::Null => DASH.to_owned(),
        Value::String(text) => text.clone(),
        Value::Number(number) if number.is_f64() => decimal(number.as_f64().unwrap_or(f64::NAN)),
        other => other.to_string(),
    }
}

/// A number with at most four decimals.
pub fn decimal(number: f64) -> String {
    if number == 0.0 || (1e-3..1e6).contains(&number.abs()) {
        let text = format!("{number:.4}");
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        format!("{number:.3e}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_line_up_on_the_right_and_names_on_the_left() {
        let rows = vec![
            vec!["muddy".to_owned(), "1.5".to_owned()],
            vec!["a".to_owned(), "10.25".to_owned()],
        ];
        assert_eq!(
            table(&["water", "uiqm"], &rows),
            "water   uiqm\n─────  ─────\nmuddy    1.5\na      10.25"
        );
    }

    #[test]
    fn decimals_drop_their_trailing_zeros() {
        assert_eq!(decimal(0.5), "0.5");
        assert_eq!(decimal(2.0), "2");
        assert_eq!(decimal(1.23e-5), "1.230e-5");
    }
}
