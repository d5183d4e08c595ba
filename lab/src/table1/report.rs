//! The table as Markdown, CSV and bars.

use std::fmt::Write;

use super::{METRICS, Row, Table, mean_sd};
use crate::plot::{Bar, Bars, PALETTE};

/// The published means (standard deviation if given): seconds, entropy, UICM, UISM, UIConM, UIQM.
const PUBLISHED: [(&str, [f64; 6]); 6] = [
    ("suir", [7.08, 10.14, 4.42, 2.45, -0.12, 1.02]),
    ("ibla", [14.0, 4.62, 5.59, 2.24, -0.65, 1.17]),
    ("ulap", [1.01, 10.49, 5.79, 2.62, -0.61, 1.29]),
    ("rd", [3.54, 10.77, 5.29, 2.67, -0.55, 1.27]),
    ("rghs", [2.28, 10.49, 3.94, 2.42, -0.63, 1.17]),
    ("hscm", [0.33, 10.42, 3.09, 2.56, -0.23, 1.05]),
];
const CAVEAT: &str = "The frames behind the published numbers are not public, so order and order of magnitude can be compared, \
                      not digits; the published times are of another machine.";

/// Writes the table in Markdown: the published layout, the published numbers and the usual profile. `about` names the measured
/// pictures and the machine.
#[must_use]
pub fn markdown(table: &Table, about: &str) -> String {
    let mut text = format!("# Enhancement methods compared\n\n{about}\n\n");
    let mut section = |title: &str, columns: std::ops::Range<usize>, entropy: &str| {
        let _ = write!(
            text,
            "## {title}\n\n| method | s | {entropy} | UICM | UISM | UIConM | UIQM | warned |\n"
        );
        text.push_str("|---|---|---|---|---|---|---|---|\n");
        for row in &table.rows {
            let _ = write!(text, "| {} | {} |", row.method, cell(&row.seconds, 4));
            for column in columns.clone() {
                let _ = write!(text, " {} |", cell(&row.values[column], 2));
            }
            let _ = writeln!(text, " {} of {} |", row.warned, table.pictures());
        }
        text.push('\n');
    };
    section("Profile `table1`, mean (sd)", 0..5, "entropy_2d");
    section("Profile `panetta`, mean (sd)", 5..10, "entropy");
    text.push_str("## As published\n\n| method | s | entropy | UICM | UISM | UIConM | UIQM |\n|---|---|---|---|---|---|---|\n");
    for (method, values) in PUBLISHED {
        let cells: Vec<String> = values.iter().map(|v| format!("{v:.2}")).collect();
        let _ = writeln!(text, "| {method} | {} |", cells.join(" | "));
    }
    let _ = write!(text, "\n{CAVEAT}\n");
    text
}

fn cell(values: &[f64], digits: usize) -> String {
    let (mean, sd) = mean_sd(values);
    format!("{mean:.digits$} ({sd:.digits$})")
}

/// One line for each method and column: method, column, count, mean, sd.
#[must_use]
pub fn csv(table: &Table) -> String {
    let mut text = String::from("method,column,count,mean,sd\n");
    let mut line = |row: &Row, column: &str, values: &[f64]| {
        let (mean, sd) = mean_sd(values);
        let _ = writeln!(text, "{},{column},{},{mean},{sd}", row.method, values.len());
    };
    for row in &table.rows {
        line(row, "seconds", &row.seconds);
        for (metric, values) in METRICS.iter().zip(&row.values) {
            line(row, metric, values);
        }
    }
    text
}

/// The profile of the published table as bars with error bars.
#[must_use]
pub fn figure(table: &Table) -> Bars {
    let bars = |values: fn(&Row) -> &[f64], scale: f64| -> Vec<Bar> {
        let bar = |row: &Row| {
            let (mean, sd) = mean_sd(values(row));
            let name = row.method.chars().take(4).collect();
            Bar {
                name,
                mean: scale * mean,
                sd: scale * sd,
            }
        };
        table.rows.iter().map(bar).collect()
    };
    Bars {
        title: format!(
            "Enhancement methods on {} pictures, mean and standard deviation, profile table1",
            table.pictures()
        ),
        colors: PALETTE.to_vec(),
        level: None,
        panels: vec![
            (
                "time, ms on one thread".to_owned(),
                bars(|row| &row.seconds, 1000.0),
            ),
            ("entropy_2d, bits".to_owned(), bars(|row| &row.values[0], 1.0)),
            ("UICM".to_owned(), bars(|row| &row.values[1], 1.0)),
            ("UISM".to_owned(), bars(|row| &row.values[2], 1.0)),
            ("UIConM".to_owned(), bars(|row| &row.values[3], 1.0)),
            ("UIQM".to_owned(), bars(|row| &row.values[4], 1.0)),
        ],
    }
}
