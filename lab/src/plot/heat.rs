//! A heat map over two quantities, with some cells outlined.

use super::svg::{Anchor, Svg};

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

const CELL: (f64, f64) = (62.0, 28.0);
const LEFT_PX: f64 = 230.0;
const TOP_PX: f64 = 62.0;
const GOOD: [f64; 3] = [33.0, 102.0, 172.0];
const BAD: [f64; 3] = [178.0, 24.0, 43.0];

impl HeatMap {
    /// Saturation of the color from -1 to 1; the sign is the side of the neutral value. `None` without a number.
    fn strength(&self, value: f64) -> Option<f64> {
        let t = ((value - self.neutral) / self.span).clamp(-1.0, 1.0);
        t.is_finite().then_some(t)
    }

    fn color(&self, value: f64) -> String {
        let Some(t) = self.strength(value) else {
            return "#bebebe".to_owned();
        };
        let full = if (t < 0.0) == self.low_is_bad { BAD } else { GOOD };
        let [r, g, b] = full.map(|full| (255.0 + t.abs() * (full - 255.0)).round());
        format!("rgb({r},{g},{b})")
    }

    pub(super) fn svg(&self) -> String {
        let width = LEFT_PX + self.columns.len() as f64 * CELL.0 + 16.0;
        let text = 8 * self.title.chars().count().max(self.foot.chars().count()) + 24;
        let height = TOP_PX + self.rows.len() as f64 * CELL.1;
        let mut svg = Svg::new(width.max(text as f64), height + 30.0);
        svg.text((12.0, 24.0), &self.title, Anchor::Start);
        for (column, name) in self.columns.iter().enumerate() {
            let x = LEFT_PX + (column as f64 + 0.5) * CELL.0;
            svg.text((x, TOP_PX - 8.0), name, Anchor::Middle);
        }
        for (row, (name, cells)) in self.rows.iter().enumerate() {
            let y = TOP_PX + row as f64 * CELL.1;
            svg.text((LEFT_PX - 10.0, y + 18.0), name, Anchor::End);
            for (column, &value) in cells.iter().enumerate() {
                self.draw_cell(&mut svg, (LEFT_PX + column as f64 * CELL.0, y), value);
            }
        }
        for &(column, row) in &self.outlined {
            let (x, y) = (LEFT_PX + column as f64 * CELL.0, TOP_PX + row as f64 * CELL.1);
            let (right, bottom) = (x + CELL.0 - 1.0, y + CELL.1 - 1.0);
            svg.line(
                &[(x, y), (right, y), (right, bottom), (x, bottom), (x, y)],
                "#000000",
                2.0,
            );
        }
        svg.text((12.0, height + 20.0), &self.foot, Anchor::Start);
        svg.finish()
    }

    fn draw_cell(&self, svg: &mut Svg, (x, y): (f64, f64), value: f64) {
        svg.rectangle((x, y), (CELL.0 - 1.0, CELL.1 - 1.0), &self.color(value));
        let text = self
            .strength(value)
            .map_or_else(|| "-".to_owned(), |_| format!("{value:.2}"));
        let is_dark = self.strength(value).is_some_and(|t| t.abs() > 0.6);
        let ink = if is_dark {
            "fill=\"#ffffff\""
        } else {
            "fill=\"#1e2226\""
        };
        let middle = (x + CELL.0 / 2.0, y + 18.0);
        svg.text_with(middle, &text, Anchor::Middle, ink);
    }
}
