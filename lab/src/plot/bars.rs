//! Bars with error bars, one panel for each quantity.

use plotters::coord::Shift;
use plotters::drawing::{DrawingArea, DrawingAreaErrorKind};
use plotters::element::{PathElement, Rectangle, Text};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, RGBColor, TextStyle};
use plotters_backend::DrawingBackend;

use super::{FAINT, Figure, INK, ink};

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
    /// The colors of the bars of a panel, from the left.
    pub colors: Vec<RGBColor>,
    /// A value that every panel marks with a line.
    pub level: Option<f64>,
    /// Title and bars of each panel.
    pub panels: Vec<(String, Vec<Bar>)>,
}

const PANEL: (i32, i32) = (330, 270);
const COLUMNS: usize = 3;
const HEAD_PX: i32 = 44;
/// Space above a bar for its value.
const VALUE_PX: i32 = 18;

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
            self.panel(area, (left, top), title, bars)?;
        }
        Ok(())
    }
}

impl Bars {
    fn panel<B: DrawingBackend>(
        &self,
        area: &DrawingArea<B, Shift>,
        (left, top): (i32, i32),
        title: &str,
        bars: &[Bar],
    ) -> Result<(), DrawingAreaErrorKind<B::ErrorType>> {
        area.draw(&Text::new(
            title.to_owned(),
            (left + PANEL.0 / 2, top + 4),
            centered(VPos::Top),
        ))?;
        let ends = bars
            .iter()
            .flat_map(|bar| [bar.mean - bar.sd, bar.mean + bar.sd])
            .chain(self.level)
            .filter(|v| v.is_finite());
        let (low, high) = ends.fold((0.0_f64, 0.0_f64), |(low, high), v| (low.min(v), high.max(v)));
        let span = if high > low { high - low } else { 1.0 };
        let (plot_top, plot_height) = (top + 44, PANEL.1 - 44 - 40);
        let y = |v: f64| plot_top + ((high - v) / span * f64::from(plot_height)).round() as i32;
        let (x0, step) = (left + 12, (PANEL.0 - 24) / bars.len().max(1) as i32);
        let line =
            |v: f64, color: RGBColor| PathElement::new(vec![(x0, y(v)), (left + PANEL.0 - 12, y(v))], color);
        area.draw(&line(0.0, FAINT))?;
        for (index, bar) in bars.iter().enumerate().filter(|(_, bar)| bar.mean.is_finite()) {
            let (a, b) = (x0 + index as i32 * step + 5, x0 + (index as i32 + 1) * step - 5);
            let color = self.colors[index % self.colors.len()];
            column(area, (a, b), &y, (bar, color), self.level.map(&y))?;
            area.draw(&Text::new(
                bar.name.clone(),
                ((a + b) / 2, plot_top + plot_height + 8),
                centered(VPos::Top),
            ))?;
        }
        match self.level {
            Some(level) => area.draw(&line(level, INK)),
            None => Ok(()),
        }
    }
}

fn centered(vertical: VPos) -> TextStyle<'static> {
    ink().pos(Pos::new(HPos::Center, vertical))
}

/// Draws a bar with its value and error bar between two columns of the sheet.
fn column<B: DrawingBackend>(
    area: &DrawingArea<B, Shift>,
    (left, right): (i32, i32),
    y: &impl Fn(f64) -> i32,
    (bar, color): (&Bar, RGBColor),
    line: Option<i32>,
) -> Result<(), DrawingAreaErrorKind<B::ErrorType>> {
    let corners = [(left, y(bar.mean.max(0.0))), (right, y(bar.mean.min(0.0)))];
    area.draw(&Rectangle::new(corners, color.filled()))?;
    let middle = (left + right) / 2;
    let (upper, lower) = (y(bar.mean + bar.sd), y(bar.mean - bar.sd));
    for path in [
        vec![(middle, upper), (middle, lower)],
        vec![(middle - 4, upper), (middle + 4, upper)],
        vec![(middle - 4, lower), (middle + 4, lower)],
    ] {
        area.draw(&PathElement::new(path, INK.stroke_width(1)))?;
    }
    let top = upper.min(y(bar.mean));
    // A level line through the value would make it unreadable.
    let struck = line.filter(|&line| line < top && top - line < VALUE_PX);
    area.draw(&Text::new(
        number(bar.mean),
        (middle, struck.unwrap_or(top) - 2),
        centered(VPos::Bottom),
    ))
}

/// At most three significant digits.
fn number(value: f64) -> String {
    let digits = match value.abs() {
        v if v >= 99.95 => 0,
        v if v >= 9.995 => 1,
        _ => 2,
    };
    format!("{value:.digits$}")
}
