//! What each effect of the chain brings it nearer to the truth, and what it costs: one small scene for each.

mod figure;
mod jobs;

use std::fmt::Write as _;

use imaging::Rgb;
use truth::{Comparison, Difference, Estimate, Measured, Part};

pub use figure::bars;
pub use jobs::{Effect, effects};

/// Pixels on a side of the blocks that are compared.
pub const BLOCK: usize = 8;
/// The figures that come with the program, as `fathom-lab truth-effects` made them.
pub const SHIPPED: &str = include_str!("../../docs/truth/effects.csv");

const COLUMNS: &str = "effect,with,paths,red,green,blue,confidence_red,confidence_green,confidence_blue,rms_red,rms_green,rms_blue,ms";
const CELLS: usize = 13;
/// Of what the noise hides.
const HIDDEN: &str = "not measured";

/// A frame without or with an effect, held against the truth of the one with it.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// The effect.
    pub effect: String,
    /// Whether it is on.
    pub with: bool,
    /// Paths of each pixel of the truth.
    pub paths: u64,
    /// Mean of the chain over that of the truth: red, green, blue.
    pub ratio: [f64; 3],
    /// Half the width of the 95 % interval about it, which is that of the truth.
    pub confidence: [f64; 3],
    /// Root of the mean square error of the blocks without the noise, over the mean; none where the noise hides it.
    pub rms: [Option<f64>; 3],
    /// Median milliseconds of a core for the light of a frame of 768 × 492, its scene included.
    pub ms: f64,
}

impl Row {
    /// Holds the light of a chain against a truth.
    #[must_use]
    pub fn new(effect: &Effect, with: bool, light: &Rgb<f32>, truth: &Estimate, ms: f64) -> Option<Self> {
        let channels = Comparison::new(light, truth, Part::All, None, BLOCK).smooth?;
        let of = |value: fn(&Difference) -> f64| channels.each_ref().map(value);
        Some(Self {
            effect: effect.name.to_owned(),
            with,
            paths: truth.paths,
            ratio: of(|d| d.model / d.truth),
            confidence: of(|d| d.confidence / d.truth),
            rms: channels.map(|d| match d.relative_rms {
                Measured::Value(rms) => Some(rms),
                Measured::NotMeasured => None,
            }),
            ms,
        })
    }

    fn read(line: &str) -> Option<Self> {
        let cells: Vec<&str> = line.split(',').collect();
        if cells.len() != CELLS {
            return None;
        }
        let triple = |from: usize| -> Option<[f64; 3]> {
            let number = |i: usize| cells[from + i].parse().ok();
            Some([number(0)?, number(1)?, number(2)?])
        };
        Some(Self {
            effect: cells[0].to_owned(),
            with: cells[1].parse().ok()?,
            paths: cells[2].parse().ok()?,
            ratio: triple(3)?,
            confidence: triple(6)?,
            rms: [9, 10, 11].map(|i| cells[i].parse().ok()),
            ms: cells[12].parse().ok()?,
        })
    }
}

/// Rows as a table of commas.
#[must_use]
pub fn csv(rows: &[Row]) -> String {
    let mut text = format!("{COLUMNS}\n");
    for row in rows {
        let _ = write!(text, "{},{},{}", row.effect, row.with, row.paths);
        for value in row.ratio.iter().chain(&row.confidence) {
            let _ = write!(text, ",{value:.4}");
        }
        for rms in row.rms {
            match rms {
                Some(rms) => write!(text, ",{rms:.4}"),
                None => write!(text, ",{HIDDEN}"),
            }
            .unwrap_or_default();
        }
        let _ = writeln!(text, ",{:.1}", row.ms);
    }
    text
}

/// The rows of such a table; none where a line is not one.
#[must_use]
pub fn read(text: &str) -> Option<Vec<Row>> {
    let mut lines = text.lines();
    (lines.next()? == COLUMNS).then(|| lines.map(Row::read).collect())?
}

/// The columns of [`cells`].
pub const HEAD: [&str; 8] = [
    "effect",
    "mean without",
    "mean with",
    "rms without",
    "rms with",
    "ms without",
    "ms with",
    "paths",
];

/// The rows for people: an effect a line, green; means over that of the truth.
#[must_use]
pub fn cells(rows: &[Row]) -> Vec<Vec<String>> {
    const GREEN: usize = 1;
    let share = |row: &Row| format!("{:.2} ± {:.2}", row.ratio[GREEN], row.confidence[GREEN]);
    let rms = |row: &Row| row.rms[GREEN].map_or_else(|| HIDDEN.to_owned(), |rms| format!("{rms:.2}"));
    let pairs = rows.chunks_exact(2).map(|pair| {
        let (without, with) = (&pair[0], &pair[1]);
        vec![
            with.effect.clone(),
            share(without),
            share(with),
            rms(without),
            rms(with),
            format!("{:.0}", without.ms),
            format!("{:.0}", with.ms),
            with.paths.to_string(),
        ]
    });
    pairs.collect()
}

/// The same as Markdown.
#[must_use]
pub fn markdown(rows: &[Row]) -> String {
    let mut text = format!("| {} |\n|{}\n", HEAD.join(" | "), "---|".repeat(HEAD.len()));
    for cells in cells(rows) {
        let _ = writeln!(text, "| {} |", cells.join(" | "));
    }
    text
}

/// The rows of an effect without it and with it, where a table has both with at least so many paths.
#[must_use]
pub fn kept(rows: &[Row], effect: &str, paths: u64) -> Option<[Row; 2]> {
    let row = |with| {
        let is_meant = |row: &&Row| row.effect == effect && row.with == with && row.paths >= paths;
        rows.iter().find(is_meant).cloned()
    };
    Some([row(false)?, row(true)?])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(with: bool, rms: Option<f64>) -> Row {
        Row {
            effect: "hard shadows".to_owned(),
            with,
            paths: 64,
            ratio: [1.25, 1.0, 0.5],
            confidence: [0.125, 0.25, 0.5],
            rms: [rms, Some(0.5), None],
            ms: 12.5,
        }
    }

    #[test]
    fn a_table_is_read_as_it_was_written() {
        let rows = vec![row(false, Some(0.25)), row(true, None)];
        assert_eq!(read(&csv(&rows)), Some(rows.clone()));
        assert_eq!(read(&csv(&rows).replace("64", "many")), None);
        assert!(markdown(&rows).contains("| hard shadows | 1.00 ± 0.25 | 1.00 ± 0.25 | 0.50 | 0.50 |"));
    }

    #[test]
    fn rows_are_kept_where_both_have_enough_paths() {
        let rows = vec![row(false, None), row(true, None)];
        assert_eq!(
            kept(&rows, "hard shadows", 64).as_ref().map(<[Row; 2]>::as_slice),
            Some(&*rows)
        );
        assert_eq!(kept(&rows, "hard shadows", 65), None);
        assert_eq!(kept(&rows, "soft shadows", 64), None);
        assert_eq!(kept(&rows[1..], "hard shadows", 64), None);
    }

    #[test]
    fn the_shipped_figures_hold_every_effect_off_and_on() {
        let rows = read(SHIPPED).expect("a table");
        let named: Vec<(&str, bool)> = rows.iter().map(|row| (row.effect.as_str(), row.with)).collect();
        let of = effects();
        let expected: Vec<(&str, bool)> = of
            .iter()
            .flat_map(|e| [(e.name, false), (e.name, true)])
            .collect();
        assert_eq!(named, expected);
    }
}
