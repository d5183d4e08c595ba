//! Means over the truth as bars.

use plotters::style::RGBColor;

use super::Row;
use crate::plot::{Bar, Bars};

/// The bars of a panel: name, channel, color; first without the effect, then with it.
const BARS: [(&str, usize, RGBColor); 6] = [
    ("R off", 0, RGBColor(240, 180, 170)),
    ("R on", 0, RGBColor(205, 70, 55)),
    ("G off", 1, RGBColor(170, 215, 190)),
    ("G on", 1, RGBColor(25, 140, 90)),
    ("B off", 2, RGBColor(170, 200, 235)),
    ("B on", 2, RGBColor(30, 95, 175)),
];

/// The means over the truth, one panel for each effect.
#[must_use]
pub fn bars(rows: &[Row]) -> Bars {
    let panel = |pair: &[Row]| {
        let bars = BARS.iter().enumerate().map(|(number, &(name, channel, _))| {
            let row = &pair[number % 2];
            Bar {
                name: name.to_owned(),
                mean: row.ratio[channel],
                sd: row.confidence[channel],
            }
        });
        (pair[0].effect.clone(), bars.collect())
    };
    Bars {
        title: "mean light of the chain over that of the truth, without an effect (pale) and with it; \
                line: 1, right; whiskers: 95 %"
            .to_owned(),
        colors: BARS.map(|(_, _, color)| color).to_vec(),
        level: Some(1.0),
        panels: rows.chunks_exact(2).map(panel).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bars_without_and_with_an_effect_take_turns() {
        let row = |with, red| Row {
            effect: "shadows".to_owned(),
            with,
            paths: 16,
            ratio: [red, 0.5, 0.25],
            confidence: [0.125; 3],
            rms: [None; 3],
            ms: 1.0,
        };
        let figure = bars(&[row(false, 3.0), row(true, 2.0)]);
        let [(title, bars)] = figure.panels.as_slice() else {
            panic!("one panel");
        };
        let seen: Vec<(&str, f64)> = bars.iter().map(|bar| (bar.name.as_str(), bar.mean)).collect();
        assert_eq!(
            (title.as_str(), &seen[..3]),
            ("shadows", &[("R off", 3.0), ("R on", 2.0), ("G off", 0.5)][..])
        );
    }
}
