//! Text tables for people: words left, numbers right.

use client::ImageRow;
use serde_json::Value;

use crate::print::visible;
use crate::terminal;

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

/// Least columns of a terminal that a wrapped text keeps.
const LEAST_TEXT: usize = 24;
/// Space between two columns.
const GAP: usize = 2;

/// Lays out the columns in the width of the terminal: the last text is wrapped, or else columns on the right are left out and named.
fn columns(header: &[&str], rows: &[Vec<String>], is_left: impl Fn(usize) -> bool) -> String {
    fit(header, rows, is_left, terminal::width())
}

fn fit(
    header: &[&str],
    rows: &[Vec<String>],
    is_left: impl Fn(usize) -> bool,
    limit: Option<usize>,
) -> String {
    let rows: Vec<Vec<String>> = rows
        .iter()
        .map(|row| row.iter().map(|cell| escape_cell(cell)).collect())
        .collect();
    let mut widths: Vec<usize> = (0..header.len())
        .map(|column| {
            let cells = rows
                .iter()
                .filter_map(|row| row.get(column))
                .map(|cell| length(cell));
            cells.chain([length(header[column])]).max().unwrap_or(0)
        })
        .collect();
    let limit = limit.unwrap_or(usize::MAX);
    let total = |widths: &[usize]| widths.iter().sum::<usize>() + GAP * widths.len().saturating_sub(1);
    let last = widths.len().saturating_sub(1);
    let excess = total(&widths).saturating_sub(limit);
    if excess > 0 && is_left(last) && widths[last] >= LEAST_TEXT + excess {
        widths[last] -= excess;
    }
    while widths.len() > 1 && total(&widths) > limit {
        widths.pop();
    }
    let layout = Layout {
        widths: &widths,
        is_left: &is_left,
    };
    let rule: Vec<String> = widths.iter().map(|&width| "─".repeat(width)).collect();
    let mut lines = layout.lines(header);
    lines.push(rule.join("  "));
    for row in &rows {
        let cells: Vec<&str> = row.iter().map(String::as_str).collect();
        lines.extend(layout.lines(&cells));
    }
    let left_out = &header[widths.len()..];
    if !left_out.is_empty() {
        lines.push(format!("not shown: {}; --wide shows all", left_out.join(", ")));
    }
    lines.join("\n")
}

/// Widths and sides of columns.
struct Layout<'a, F> {
    widths: &'a [usize],
    is_left: &'a F,
}

impl<F: Fn(usize) -> bool> Layout<'_, F> {
    /// The lines of a row: further ones hold the rest of its last text.
    fn lines(&self, cells: &[&str]) -> Vec<String> {
        let Some(last) = self.widths.len().checked_sub(1) else {
            return vec![String::new()];
        };
        let texts = wrap(cells.get(last).copied().unwrap_or_default(), self.widths[last]);
        let blank = vec![""; last];
        let lines = texts.iter().enumerate().map(|(number, text)| {
            let others = if number == 0 { cells } else { &blank };
            let all = others.iter().copied().take(last).chain([text.as_str()]);
            let padded = all.zip(self.widths).enumerate().map(|(column, (cell, &width))| {
                if (self.is_left)(column) {
                    format!("{cell:<width$}")
                } else {
                    format!("{cell:>width$}")
                }
            });
            padded.collect::<Vec<_>>().join("  ").trim_end().to_owned()
        });
        lines.collect()
    }
}

/// A cell as it is shown: a line break in it would look like another row.
pub(crate) fn escape_cell(cell: &str) -> String {
    visible(&cell.replace('\n', "\\n").replace('\t', " ")).into_owned()
}

fn length(text: &str) -> usize {
    text.chars().count()
}

/// The lines of a text of at most this width, broken between words where possible.
fn wrap(text: &str, width: usize) -> Vec<String> {
    if length(text) <= width {
        return vec![text.to_owned()];
    }
    let mut lines = vec![String::new()];
    for word in text.split(' ') {
        let line = lines.last_mut().expect("one line");
        if line.is_empty() {
            line.push_str(word);
        } else if length(line) + 1 + length(word) <= width {
            line.push(' ');
            line.push_str(word);
        } else {
            lines.push(word.to_owned());
        }
    }
    lines
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
    fn a_table_fits_the_terminal() {
        let rows = vec![vec![
            "shaft".to_owned(),
            "17".to_owned(),
            "a flooded shaft with a lamp on the camera and clear water".to_owned(),
        ]];
        let header = ["site", "frames", "summary"];
        let shown = fit(&header, &rows, |_| true, Some(50));
        assert_eq!(
            shown,
            "site   frames  summary\n─────  ──────  ───────────────────────────────────\n\
             shaft  17      a flooded shaft with a lamp on the\n               camera and clear water"
        );
        let narrow = fit(&header, &rows, |column| column == 0, Some(20));
        assert!(
            narrow.starts_with("site   frames\n") && narrow.ends_with("not shown: summary; --wide shows all"),
            "{narrow}"
        );
        assert!(
            fit(&header, &rows, |_| true, None)
                .lines()
                .all(|line| !line.contains("not shown"))
        );
        assert_eq!(wrap("incomprehensibilities", 5), ["incomprehensibilities"]);
    }

    #[test]
    fn decimals_drop_their_trailing_zeros() {
        assert_eq!(decimal(0.5), "0.5");
        assert_eq!(decimal(2.0), "2");
        assert_eq!(decimal(1.23e-5), "1.230e-5");
    }
}
