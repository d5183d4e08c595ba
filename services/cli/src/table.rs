//! Text tables for people: words on the left, numbers on the right.

use client::ImageRow;
use serde_json::Value;

use crate::print::visible;
use crate::terminal;
use crate::wrap::{length, paragraph, wrap};

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

/// Lays out the columns in the width of the terminal: wide texts are wrapped, or else columns on the right are left out and named.
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
    let natural: Vec<usize> = (0..header.len())
        .map(|column| {
            let cells = rows
                .iter()
                .filter_map(|row| row.get(column))
                .map(|cell| length(cell));
            cells.chain([length(header[column])]).max().unwrap_or(0)
        })
        .collect();
    let widths = fit_widths(header, &natural, &is_left, limit.unwrap_or(usize::MAX));
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
        let names = format!("not shown: {}; --wide shows all", left_out.join(", "));
        lines.push(paragraph(&names, 0, limit));
    }
    lines.join("\n")
}

/// The widths of as many columns as fit, at least one. Texts on the left give way, the widest first, down to `LEAST_TEXT`.
fn fit_widths(
    header: &[&str],
    natural: &[usize],
    is_left: &impl Fn(usize) -> bool,
    limit: usize,
) -> Vec<usize> {
    let mut widths = natural.to_vec();
    while !widths.is_empty() {
        let room = limit.saturating_sub(GAP * (widths.len() - 1));
        let least = |column: usize| match is_left(column) {
            true => natural[column].min(LEAST_TEXT.min(limit).max(length(header[column]))),
            false => natural[column],
        };
        let mut excess = widths.iter().sum::<usize>().saturating_sub(room);
        while excess > 0 {
            let wraps = (0..widths.len()).filter(|&column| widths[column] > least(column));
            let Some(widest) = wraps.max_by_key(|&column| widths[column]) else {
                break;
            };
            widths[widest] -= 1;
            excess -= 1;
        }
        if excess == 0 || widths.len() == 1 {
            return widths;
        }
        widths = natural[..widths.len() - 1].to_vec();
    }
    widths
}

/// Widths and sides of columns.
struct Layout<'a, F> {
    widths: &'a [usize],
    is_left: &'a F,
}

impl<F: Fn(usize) -> bool> Layout<'_, F> {
    /// The lines of a row: further ones hold the rest of its wrapped texts.
    fn lines(&self, cells: &[&str]) -> Vec<String> {
        let texts: Vec<Vec<String>> = self
            .widths
            .iter()
            .enumerate()
            .map(|(column, &width)| wrap(cells.get(column).copied().unwrap_or_default(), width))
            .collect();
        let height = texts.iter().map(Vec::len).max().unwrap_or(1);
        (0..height).map(|line| self.line(&texts, line)).collect()
    }

    /// A line of a row whose cells are wrapped.
    fn line(&self, texts: &[Vec<String>], line: usize) -> String {
        let padded = texts.iter().zip(self.widths).enumerate();
        let padded = padded.map(|(column, (text, &width))| {
            let cell = text.get(line).map_or("", String::as_str);
            if (self.is_left)(column) {
                format!("{cell:<width$}")
            } else {
                format!("{cell:>width$}")
            }
        });
        padded.collect::<Vec<_>>().join("  ").trim_end().to_owned()
    }
}

/// A cell as it is shown: a line break in it would look like another row.
pub(crate) fn escape_cell(cell: &str) -> String {
    visible(&cell.replace('\n', "\\n").replace('\t', " ")).into_owned()
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
            narrow.starts_with("site   frames\n")
                && narrow.ends_with("not shown: summary;\n--wide shows all"),
            "{narrow}"
        );
        assert!(
            fit(&header, &rows, |_| true, None)
                .lines()
                .all(|line| !line.contains("not shown"))
        );
    }

    #[test]
    fn wide_names_are_wrapped_and_their_meaning_stays() {
        let name = "enhance[](hscm, clahe, gray_world, onnx, chain).mask.saturated.dilation_px";
        let row = [name, "px", "width of the border around saturated pixels"].map(str::to_owned);
        let header = ["name", "unit", "meaning"];
        let shown = fit(&header, &[row.to_vec()], |_| true, Some(60));
        assert_eq!(
            shown,
            "name                        unit  meaning\n\
             ──────────────────────────  ────  ──────────────────────────\n\
             enhance[](hscm, clahe,      px    width of the border around\n\
             gray_world, onnx,                 saturated pixels\n\
             chain).mask.saturated.\n\
             dilation_px"
        );
    }

    #[test]
    fn decimals_drop_their_trailing_zeros() {
        assert_eq!(decimal(0.5), "0.5");
        assert_eq!(decimal(2.0), "2");
        assert_eq!(decimal(1.23e-5), "1.230e-5");
    }
}
