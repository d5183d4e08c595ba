//! Small plots over the same axes, with values from 0 to 1.

use plotters::coord::Shift;
use plotters::drawing::{DrawingArea, DrawingAreaErrorKind};
use plotters::element::{PathElement, Text};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, RGBColor};
use plotters_backend::DrawingBackend;

use super::{FAINT, Figure, INK, ink};

/// One small plot: its name and its curves, each with a color and points (x, 0..=1).
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    /// Title of the plot.
    pub title: String,
    /// The curves of the plot.
    pub curves: Vec<(RGBColor, Vec<(f64, f64)>)>,
}

/// Small plots in rows.
#[derive(Debug, Clone, PartialEq)]
pub struct Panels {
    /// Title of the sheet.
    pub title: String,
    /// Footer of the sheet: the quantity of the horizontal axes.
    pub foot: String,
    /// End of the horizontal axes; they begin at 0.
    pub most: f64,
    /// Values with a line and a number on the horizontal axes.
    pub ticks: Vec<f64>,
    /// The plots.
    pub panels: Vec<Panel>,
    /// Plots per row.
    pub columns: usize,
}

const PLOT: (i32, i32) = (196, 120);
const CELL: (i32, i32) = (262, 186);
const LEFT: i32 = 48;
const ABOVE: i32 = 24;
const TOP: i32 = 44;
const FOOT: i32 = 34;

impl Figure for Panels {
    fn size(&self) -> (u32, u32) {
        let rows = self.panels.len().div_ceil(self.columns.max(1)) as i32;
        let width = self.columns as i32 * CELL.0 + 12;
        (width as u32, (TOP + rows * CELL.1 + FOOT) as u32)
    }

    fn draw<B: DrawingBackend>(
        &self,
        area: &DrawingArea<B, Shift>,
    ) -> Result<(), DrawingAreaErrorKind<B::ErrorType>> {
        area.draw(&Text::new(self.title.clone(), (12, 12), ink()))?;
        for (index, panel) in self.panels.iter().enumerate() {
            let column = (index % self.columns) as i32;
            let row = (index / self.columns) as i32;
            let (left, top) = (LEFT + column * CELL.0, TOP + ABOVE + row * CELL.1);
            let at = |x: f64, y: f64| {
                let across = (x / self.most * f64::from(PLOT.0)).round() as i32;
                (
                    left + across,
                    top + ((1.0 - y) * f64::from(PLOT.1)).round() as i32,
                )
            };
            area.draw(&Text::new(panel.title.clone(), (left, top - 20), ink()))?;
            for y in [0.0, 0.5, 1.0] {
                area.draw(&PathElement::new(vec![at(0.0, y), at(self.most, y)], FAINT))?;
                let style = ink().pos(Pos::new(HPos::Right, VPos::Center));
                area.draw(&Text::new(format!("{y}"), (left - 6, at(0.0, y).1), style))?;
            }
            for &x in &self.ticks {
                area.draw(&PathElement::new(vec![at(x, 0.0), at(x, 1.0)], FAINT))?;
                let style = ink().pos(Pos::new(HPos::Center, VPos::Top));
                area.draw(&Text::new(
                    format!("{x}"),
                    (at(x, 0.0).0, top + PLOT.1 + 4),
                    style,
                ))?;
            }
            area.draw(&PathElement::new(
                vec![at(0.0, 1.0), at(0.0, 0.0), at(self.most, 0.0)],
                INK,
            ))?;
            for (color, points) in &panel.curves {
                let path: Vec<_> = points.iter().map(|&(x, y)| at(x, y)).collect();
                area.draw(&PathElement::new(path, color.stroke_width(2)))?;
            }
        }
        let rows = self.panels.len().div_ceil(self.columns.max(1)) as i32;
        area.draw(&Text::new(
            self.foot.clone(),
            (12, TOP + rows * CELL.1 + 6),
            ink(),
        ))?;
        Ok(())
    }
}
