//! Bars with error bars, one panel for each quantity.

use plotters::coord::Shift;
use plotters::drawing::{DrawingArea, DrawingAreaErrorKind};
use plotters::element::{PathElement, Rectangle, Text};
use plotters::style::Color;
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters_backend::DrawingBackend;

use super::{FAINT, Figure, INK, PALETTE, ink};

/// A mean with its spread.
#[derive(Debug, Clone, PartialEq)]
pub struct Bar {
    /// What it belongs to.
    pub name: String,
    /// Its height.
    pub mean: f64,
    /// Half the length of its error bar.
    pub sd: f64,
}

/// Panels of bars; all panels have the same names in the same order.
#[derive(Debug, Clone, PartialEq)]
pub struct Bars {
    /// Above everything.
    pub title: String,
    /// Title and bars of each panel.
    pub panels: Vec<(String, Vec<Bar>)>,
}

const PANEL: (i32, i32) = (330, 270);
const COLUMNS: usize = 3;
const HEAD_PX: i32 = 44;

impl Figure for Bars {
    fn size(&self) -> (u32, u32) {
        let rows = self.panels.len().div_ceil(COLUMNS) as i32;
        (
            (COLUMNS as i32 * PANEL.0) as u32,
            (HEAD_PX + rows * PANEL.1) as u32,
        )
    }

    fn draw<B: DrawingBackend>(
        &self,
        area: &DrawingArea<B, Shift>,
    ) -> Result<(), DrawingAreaErrorKind<B::ErrorType>> {
        area.draw(&Text::new(self.title.clone(), (12, 12), ink()))?;
        for (index, (title, bars)) in self.panels.iter().enumerate() {
            let left = (index % COLUMNS) as i32 * PANEL.0;
            let top = HEAD_PX + (index / COLUMNS) as i32 * PANEL.1;
            panel(area, (left, top), title, bars)?;
        }
        Ok(())
    }
}

fn panel<B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    (left, top): (i32, i32),
    title: &str,
    bars: &[Bar],
) -> Result<(), DrawingAreaErrorKind<B::ErrorType>> {
    let centered = |v| ink().pos(Pos::new(HPos::Center, v));
    area.draw(&Text::new(
        title.to_owned(),
        (left + PANEL.0 / 2, top + 4),
        centered(VPos::Top),
    ))?;
    let ends = bars
        .iter()
        .flat_map(|bar| [bar.mean - bar.sd, bar.mean + bar.sd])
        .filter(|v| v.is_finite());
    let (low, high) = ends.fold((0.0_f64, 0.0_f64), |(low, high), v| (low.min(v), high.max(v)));
    let span = if high > low { high - low } else { 1.0 };
    let (plot_top, plot_height) = (top + 44, PANEL.1 - 44 - 40);
    let y = |v: f64| plot_top + ((high - v) / span * f64::from(plot_height)).round() as i32;
    let (x0, step) = (left + 12, (PANEL.0 - 24) / bars.len().max(1) as i32);
    area.draw(&PathElement::new(
        vec![(x0, y(0.0)), (left + PANEL.0 - 12, y(0.0))],
        FAINT,
    ))?;
    for (index, bar) in bars.iter().enumerate().filter(|(_, bar)| bar.mean.is_finite()) {
        let (a, b) = (x0 + index as i32 * step + 5, x0 + (index as i32 + 1) * step - 5);
        let color = PALETTE[index % PALETTE.len()];
        let corners = [(a, y(bar.mean.max(0.0))), (b, y(bar.mean.min(0.0)))];
        area.draw(&Rectangle::new(corners, color.filled()))?;
        let middle = (a + b) / 2;
        let (upper, lower) = (y(bar.mean + bar.sd), y(bar.mean - bar.sd));
        for path in [
            vec![(middle, upper), (middle, lower)],
            vec![(middle - 4, upper), (middle + 4, upper)],
            vec![(middle - 4, lower), (middle + 4, lower)],
        ] {
            area.draw(&PathElement::new(path, INK.stroke_width(1)))?;
        }
        let value = number(bar.mean);
        area.draw(&Text::new(
            value,
            (middle, upper.min(y(bar.mean)) - 2),
            centered(VPos::Bottom),
        ))?;
        area.draw(&Text::new(
            bar.name.clone(),
            (middle, plot_top + plot_height + 8),
            centered(VPos::Top),
        ))?;
    }
    Ok(())
}

/// Three significant digits, as short as they come.
fn number(value: f64) -> String {
    let digits = match value.abs() {
        v if v >= 99.95 => 0,
        v if v >= 9.995 => 1,
        _ => 2,
    };
    format!("{value:.digits$}")
}
