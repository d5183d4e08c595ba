//! A heat map over two quantities, with some cells outlined.

use plotters::coord::Shift;
use plotters::drawing::{DrawingArea, DrawingAreaErrorKind};
use plotters::element::{PathElement, Rectangle, Text};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, RGBColor, WHITE};
use plotters_backend::DrawingBackend;

use super::{Figure, ink};

/// A heat map: rows of cells, each a number.
#[derive(Debug, Clone, PartialEq)]
pub struct HeatMap {
    /// Title of the sheet.
    pub title: String,
    /// Names of the columns.
    pub columns: Vec<String>,
    /// Name and cells of each row; a cell without a finite number is grey.
    pub rows: Vec<(String, Vec<f64>)>,
    /// The neutral value, drawn white.
    pub neutral: f64,
    /// The distance from neutral with fully saturated colors.
    pub span: f64,
    /// Whether values below the neutral one are bad.
    pub low_is_bad: bool,
    /// Cells to outline: column, row.
    pub outlined: Vec<(usize, usize)>,
    /// Footer of the sheet.
    pub foot: String,
}

const CELL: (i32, i32) = (62, 28);
const LEFT_PX: i32 = 210;
const TOP_PX: i32 = 62;
const FOOT_PX: i32 = 30;
const GOOD: RGBColor = RGBColor(33, 102, 172);
const BAD: RGBColor = RGBColor(178, 24, 43);
const NOTHING: RGBColor = RGBColor(190, 190, 190);
const OUTLINE: RGBColor = RGBColor(0, 0, 0);

impl HeatMap {
    /// Saturation of the color from -1 to 1; the sign is the side of the neutral value.
    fn strength(&self, value: f64) -> f64 {
        let t = ((value - self.neutral) / self.span).clamp(-1.0, 1.0);
        if t.is_finite() { t } else { 0.0 }
    }

    fn color(&self, value: f64) -> RGBColor {
        if !value.is_finite() {
            return NOTHING;
        }
        let t = self.strength(value);
        let full = if (t < 0.0) == self.low_is_bad { BAD } else { GOOD };
        let mix = |full: u8| (255.0 + t.abs() * (f64::from(full) - 255.0)).round() as u8;
        RGBColor(mix(full.0), mix(full.1), mix(full.2))
    }
}

impl Figure for HeatMap {
    fn size(&self) -> (u32, u32) {
        let width = LEFT_PX + self.columns.len() as i32 * CELL.0 + 16;
        let height = TOP_PX + self.rows.len() as i32 * CELL.1 + FOOT_PX;
        let text = 10 * self.title.chars().count().max(self.foot.chars().count()) as i32 + 24;
        (width.max(text) as u32, height as u32)
    }

    fn draw<B: DrawingBackend>(
        &self,
        area: &DrawingArea<B, Shift>,
    ) -> Result<(), DrawingAreaErrorKind<B::ErrorType>> {
        let at = |column: usize, row: usize| (LEFT_PX + column as i32 * CELL.0, TOP_PX + row as i32 * CELL.1);
        area.draw(&Text::new(self.title.clone(), (12, 10), ink()))?;
        let centered = ink().pos(Pos::new(HPos::Center, VPos::Center));
        for (column, name) in self.columns.iter().enumerate() {
            let (x, _) = at(column, 0);
            area.draw(&Text::new(
                name.clone(),
                (x + CELL.0 / 2, TOP_PX - 14),
                centered.clone(),
            ))?;
        }
        for (row, (name, cells)) in self.rows.iter().enumerate() {
            let (_, y) = at(0, row);
            let right = ink().pos(Pos::new(HPos::Right, VPos::Center));
            area.draw(&Text::new(name.clone(), (LEFT_PX - 10, y + CELL.1 / 2), right))?;
            for (column, &value) in cells.iter().enumerate() {
                let (x, y) = at(column, row);
                let corners = [(x, y), (x + CELL.0 - 1, y + CELL.1 - 1)];
                area.draw(&Rectangle::new(corners, self.color(value).filled()))?;
                let text = if value.is_finite() {
                    format!("{value:.2}")
                } else {
                    "-".to_owned()
                };
                let readable = match self.strength(value).abs() > 0.6 {
                    true => centered.clone().color(&WHITE),
                    false => centered.clone(),
                };
                area.draw(&Text::new(text, (x + CELL.0 / 2, y + CELL.1 / 2), readable))?;
            }
        }
        for &(column, row) in &self.outlined {
            let ((x, y), marked) = (at(column, row), |c: i64, r: i64| {
                self.outlined.iter().any(|&(a, b)| (a as i64, b as i64) == (c, r))
            });
            let (c, r) = (column as i64, row as i64);
            let (x1, y1) = (x + CELL.0 - 1, y + CELL.1 - 1);
            // Outlines only the border of the region, not each of its cells.
            for (outer, path) in [
                (!marked(c, r - 1), vec![(x, y), (x1, y)]),
                (!marked(c, r + 1), vec![(x, y1), (x1, y1)]),
                (!marked(c - 1, r), vec![(x, y), (x, y1)]),
                (!marked(c + 1, r), vec![(x1, y), (x1, y1)]),
            ] {
                if outer {
                    area.draw(&PathElement::new(path, OUTLINE.stroke_width(3)))?;
                }
            }
        }
        let (_, y) = at(0, self.rows.len());
        area.draw(&Text::new(self.foot.clone(), (12, y + 8), ink()))?;
        Ok(())
    }
}
