//! Several charts on one sheet.

use plotters::coord::Shift;
use plotters::drawing::{DrawingArea, DrawingAreaErrorKind};
use plotters_backend::DrawingBackend;

use super::lines::SIZE;
use super::{Figure, Lines};

/// Charts in two columns, row by row.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// The charts.
    pub panels: Vec<Lines>,
}

const COLUMNS: usize = 2;

impl Figure for Grid {
    fn size(&self) -> (u32, u32) {
        let rows = self.panels.len().div_ceil(COLUMNS);
        ((COLUMNS as i32 * SIZE.0) as u32, (rows as i32 * SIZE.1) as u32)
    }

    fn draw<B: DrawingBackend>(
        &self,
        area: &DrawingArea<B, Shift>,
    ) -> Result<(), DrawingAreaErrorKind<B::ErrorType>> {
        let parts = area.split_evenly((self.panels.len().div_ceil(COLUMNS), COLUMNS));
        for (panel, part) in self.panels.iter().zip(&parts) {
            panel.draw(part)?;
        }
        Ok(())
    }
}
