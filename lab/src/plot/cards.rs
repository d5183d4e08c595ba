//! A table of colors: one card per cell.

use plotters::coord::Shift;
use plotters::drawing::{DrawingArea, DrawingAreaErrorKind};
use plotters::element::{Rectangle, Text};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, RGBColor};
use plotters_backend::DrawingBackend;

use super::{Figure, ink};

/// One cell of the table.
#[derive(Debug, Clone, PartialEq)]
pub struct Card {
    /// Color around the card.
    pub around: RGBColor,
    /// The card, in stripes of equal height.
    pub stripes: Vec<RGBColor>,
}

/// A table of cards.
#[derive(Debug, Clone, PartialEq)]
pub struct Cards {
    /// Title of the sheet.
    pub title: String,
    /// Footer of the sheet.
    pub foot: String,
    /// Names of the columns.
    pub columns: Vec<String>,
    /// Name and cells of each row.
    pub rows: Vec<(String, Vec<Card>)>,
}

const CELL: (i32, i32) = (84, 62);
/// Distance from the edge of a cell to the card.
const INSET: (i32, i32) = (16, 9);
const LEFT: i32 = 262;
const TOP: i32 = 66;
const FOOT: i32 = 32;

impl Figure for Cards {
    fn size(&self) -> (u32, u32) {
        let width = LEFT + self.columns.len() as i32 * CELL.0 + 12;
        let height = TOP + self.rows.len() as i32 * CELL.1 + FOOT;
        (width as u32, height as u32)
    }

    fn draw<B: DrawingBackend>(
        &self,
        area: &DrawingArea<B, Shift>,
    ) -> Result<(), DrawingAreaErrorKind<B::ErrorType>> {
        area.draw(&Text::new(self.title.clone(), (12, 12), ink()))?;
        let centered = ink().pos(Pos::new(HPos::Center, VPos::Center));
        for (column, name) in self.columns.iter().enumerate() {
            let x = LEFT + column as i32 * CELL.0 + CELL.0 / 2;
            area.draw(&Text::new(name.clone(), (x, TOP - 14), centered.clone()))?;
        }
        for (row, (name, cells)) in self.rows.iter().enumerate() {
            let y = TOP + row as i32 * CELL.1;
            let right = ink().pos(Pos::new(HPos::Right, VPos::Center));
            area.draw(&Text::new(name.clone(), (LEFT - 12, y + CELL.1 / 2), right))?;
            for (column, card) in cells.iter().enumerate() {
                let x = LEFT + column as i32 * CELL.0;
                let whole = [(x, y), (x + CELL.0 - 1, y + CELL.1 - 3)];
                area.draw(&Rectangle::new(whole, card.around.filled()))?;
                let height = CELL.1 - 2 - 2 * INSET.1;
                let count = card.stripes.len().max(1) as i32;
                for (stripe, color) in card.stripes.iter().enumerate() {
                    let stripe = stripe as i32;
                    let top = y + INSET.1 + stripe * height / count;
                    let bottom = y + INSET.1 + (stripe + 1) * height / count - 1;
                    let corners = [(x + INSET.0, top), (x + CELL.0 - INSET.0, bottom)];
                    area.draw(&Rectangle::new(corners, color.filled()))?;
                }
            }
        }
        let foot = TOP + self.rows.len() as i32 * CELL.1 + 6;
        area.draw(&Text::new(self.foot.clone(), (12, foot), ink()))?;
        Ok(())
    }
}
