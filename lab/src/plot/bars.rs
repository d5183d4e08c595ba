//! Bars with error bars, one panel for each quantity.

use super::colors::{FAINT, INK, PALETTE};
use super::svg::{Anchor, Svg};

/// A mean with its spread.
#[derive(Debug, Clone, PartialEq)]
pub struct Bar {
    /// Name of the bar.
    pub name: String,
    /// Its height.
    pub mean: f64,
    /// Half the length of its error bar.
    pub sd: f64,
}

/// Panels of bars. All panels have the same names in the same order.
#[derive(Debug, Clone, PartialEq)]
pub struct Bars {
    /// Title of the sheet.
    pub title: String,
    /// Title and bars of each panel.
    pub panels: Vec<(String, Vec<Bar>)>,
}

const PANEL: (f64, f64) = (330.0, 270.0);
const COLUMNS: usize = 3;
const HEAD_PX: f64 = 44.0;

impl Bars {
    pub(super) fn svg(&self) -> String {
        let columns = COLUMNS.min(self.panels.len()).max(1);
        let rows = self.panels.len().div_ceil(columns);
        let mut svg = Svg::new(columns as f64 * PANEL.0, HEAD_PX + rows as f64 * PANEL.1);
        svg.text((12.0, 24.0), &self.title, Anchor::Start);
        for (index, (title, bars)) in self.panels.iter().enumerate() {
            let left = (index % columns) as f64 * PANEL.0;
            let top = HEAD_PX + (index / columns) as f64 * PANEL.1;
            draw_panel(&mut svg, (left, top), title, bars);
        }
        svg.finish()
    }
}

fn draw_panel(svg: &mut Svg, (left, top): (f64, f64), title: &str, bars: &[Bar]) {
    svg.text((left + PANEL.0 / 2.0, top + 16.0), title, Anchor::Middle);
    let ends = bars.iter().flat_map(|bar| [bar.mean - bar.sd, bar.mean + bar.sd]);
    let ends = ends.filter(|v| v.is_finite());
    let (low, high) = ends.fold((0.0_f64, 0.0_f64), |(low, high), v| (low.min(v), high.max(v)));
    let span = if high > low { high - low } else { 1.0 };
    let (plot_top, plot_height) = (top + 44.0, PANEL.1 - 84.0);
    let row = |v: f64| plot_top + (high - v) / span * plot_height;
    svg.line(
        &[(left + 12.0, row(0.0)), (left + PANEL.0 - 12.0, row(0.0))],
        FAINT,
        1.0,
    );
    let step = (PANEL.0 - 24.0) / bars.len().max(1) as f64;
    for (index, bar) in bars.iter().enumerate().filter(|(_, bar)| bar.mean.is_finite()) {
        let start = left + 12.0 + index as f64 * step + 5.0;
        let (middle, width) = (start + step / 2.0 - 5.0, step - 10.0);
        let (upper, lower) = (row(bar.mean.max(0.0)), row(bar.mean.min(0.0)));
        let color = PALETTE[index % PALETTE.len()];
        svg.rectangle((start, upper), (width, lower - upper), color);
        if bar.sd > 0.0 {
            let ends = [row(bar.mean - bar.sd), row(bar.mean + bar.sd)];
            svg.line(&[(middle, ends[0]), (middle, ends[1])], INK, 1.0);
        }
        let above = row((bar.mean + bar.sd).max(bar.mean));
        svg.text((middle, above - 4.0), &format_number(bar.mean), Anchor::Middle);
        svg.text((middle, plot_top + plot_height + 20.0), &bar.name, Anchor::Middle);
    }
}

/// At most three significant digits.
fn format_number(value: f64) -> String {
    let digits = match value.abs() {
        v if v >= 99.95 => 0,
        v if v >= 9.995 => 1,
        _ => 2,
    };
    format!("{value:.digits$}")
}
