//! A heat map over two quantities, with some cells outlined.

use super::svg::{INK, Svg};

/// A heat map: rows of cells, each a number.
#[derive(Debug, Clone, PartialEq)]
pub struct HeatMap {
    /// Title of the sheet.
    pub title: String,
    /// Name and cells of each row; a cell without a finite number is grey.
    pub rows: Vec<(String, Vec<f64>)>,
    /// The neutral value, drawn white.
    pub neutral: f64,
    /// The distance from neutral with fully saturated colors; negative if low values are good.
    pub span: f64,
    /// Cells to outline: column, row.
    pub outlined: Vec<(usize, usize)>,
}

const CELL: (f64, f64) = (62.0, 28.0);
const LEFT_PX: f64 = 230.0;
const TOP_PX: f64 = 40.0;
const GOOD: [f64; 3] = [33.0, 102.0, 172.0];
const BAD: [f64; 3] = [178.0, 24.0, 43.0];

impl HeatMap {
    /// The chart as SVG text.
    #[must_use]
    pub fn svg(&self) -> String {
        let columns = self.rows.first().map_or(0, |(_, cells)| cells.len());
        let height = TOP_PX + self.rows.len() as f64 * CELL.1 + 12.0;
        let mut svg = Svg::new(LEFT_PX + columns as f64 * CELL.0 + 16.0, height, &self.title);
        for (row, (name, cells)) in self.rows.iter().enumerate() {
            let y = TOP_PX + row as f64 * CELL.1;
            svg.text((LEFT_PX - 10.0, y + 18.0), name, "end");
            for (column, &value) in cells.iter().enumerate() {
                let x = LEFT_PX + column as f64 * CELL.0;
                let is_outlined = self.outlined.contains(&(column, row));
                let stroke = if is_outlined {
                    "stroke=\"#000000\" stroke-width=\"2\""
                } else {
                    ""
                };
                let style = format!("fill=\"{}\" {stroke}", self.color(value));
                svg.rectangle((x, y), (CELL.0 - 3.0, CELL.1 - 3.0), &style);
                let is_dark = self.strength(value).abs() > 0.6;
                let ink = if is_dark { "#ffffff" } else { INK };
                let (center, style) = ((x + 30.0, y + 18.0), format!("fill=\"{ink}\""));
                svg.styled_text(center, &format!("{value:.2}"), "middle", &style);
            }
        }
        svg.finish()
    }

    /// Saturation of the color from -1, bad, to 1, good; 0 without a number.
    fn strength(&self, value: f64) -> f64 {
        let strength = ((value - self.neutral) / self.span).clamp(-1.0, 1.0);
        if strength.is_finite() { strength } else { 0.0 }
    }

    fn color(&self, value: f64) -> String {
        if !value.is_finite() {
            return "#bebebe".to_owned();
        }
        let strength = self.strength(value);
        let full = if strength < 0.0 { BAD } else { GOOD };
        let [r, g, b] = full.map(|full| (255.0 + strength.abs() * (full - 255.0)).round());
        format!("rgb({r},{g},{b})")
    }
}
