//! Bars with error bars, one panel for each quantity.

use super::number::format_number;
use super::scale::{Axis, Scale};
use super::svg::{FAINT, INK, Svg, color};

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

/// Width of a bar with the space next to it, and height of a panel.
const BAR_PX: f64 = 36.0;
const PANEL_PX: f64 = 250.0;
const COLUMNS: usize = 3;

impl Bars {
    /// The chart as SVG text.
    #[must_use]
    pub fn svg(&self) -> String {
        let bars = self.panels.iter().map(|(_, bars)| bars.len()).max().unwrap_or(0);
        let (columns, width) = (COLUMNS.min(self.panels.len()), bars as f64 * BAR_PX + 40.0);
        let rows = self.panels.len().div_ceil(COLUMNS) as f64;
        let mut svg = Svg::new(columns as f64 * width, 44.0 + rows * PANEL_PX, &self.title);
        for (index, (title, bars)) in self.panels.iter().enumerate() {
            let left = 20.0 + (index % COLUMNS) as f64 * width;
            let top = 44.0 + (index / COLUMNS) as f64 * PANEL_PX;
            svg.text((left, top + 16.0), title, "start");
            draw_panel(&mut svg, (left, top + 44.0), bars);
        }
        svg.finish()
    }
}

fn draw_panel(svg: &mut Svg, (left, top): (f64, f64), bars: &[Bar]) {
    let bottom = top + PANEL_PX - 84.0;
    let ends = bars.iter().flat_map(|bar| [bar.mean - bar.sd, bar.mean + bar.sd]);
    let scale = Scale::new(&Axis::linear(""), ends.chain([0.0]), (bottom, top));
    let zero = scale.pixel(0.0).unwrap_or(bottom);
    let right = left + bars.len() as f64 * BAR_PX;
    svg.line(&[(left, zero), (right, zero)], FAINT, 1.0);
    for (index, bar) in bars.iter().enumerate() {
        let start = left + index as f64 * BAR_PX;
        let middle = start + BAR_PX / 2.0 - 4.0;
        svg.text((middle, bottom + 20.0), &bar.name, "middle");
        let rows = [bar.mean - bar.sd, bar.mean, bar.mean + bar.sd].map(|value| scale.pixel(value));
        let [Some(lower), Some(row), Some(upper)] = rows else {
            continue;
        };
        let size = (BAR_PX - 8.0, (row - zero).abs());
        let style = format!("fill=\"{}\"", color(index));
        svg.rectangle((start, row.min(zero)), size, &style);
        svg.line(&[(middle, lower), (middle, upper)], INK, 1.0);
        let above = (middle, upper.min(zero) - 4.0);
        svg.text(above, &format_number(bar.mean), "middle");
    }
}
