//! The part of a picture that is solved for: cells, each the columns of a tile and a few rows.

use imaging::Plane;

use super::tile::BLOCK;
use crate::blocks::QuadRegion;

/// Rows of a cell: even, and more than the reach of coefficients and windows.
pub(super) const ROWS: usize = 8;

#[derive(Debug, Clone)]
pub(super) struct CellSet {
    across: usize,
    down: usize,
    chosen: Vec<bool>,
}

impl CellSet {
    /// All cells of a picture.
    pub(super) fn whole(width: usize, height: usize) -> Self {
        Self::filled(width, height, true)
    }

    /// The cells with a value of at most `limit`.
    pub(super) fn at_most(plane: &Plane<f64>, limit: f64) -> Self {
        let mut cells = Self::filled(plane.width(), plane.height(), false);
        for (y, row) in plane.data().chunks_exact(plane.width()).enumerate() {
            let chosen = &mut cells.chosen[y / ROWS * cells.across..];
            for (chosen, values) in chosen.iter_mut().zip(row.chunks(BLOCK)) {
                *chosen |= values.iter().any(|&value| value <= limit);
            }
        }
        cells
    }

    /// Adds the cells of a region.
    pub(super) fn with_region(mut self, region: &QuadRegion) -> Self {
        for y in region.rows.start / ROWS..region.rows.end.div_ceil(ROWS) {
            let columns = region.columns.start / BLOCK..region.columns.end.div_ceil(BLOCK);
            self.chosen[y * self.across..][columns].fill(true);
        }
        self
    }

    /// Adds a margin of cells on each side.
    pub(super) fn grown(&self, columns: usize, rows: usize) -> Self {
        let mut grown = self.clone();
        for y in 0..self.down {
            let lines = y.saturating_sub(rows)..(y + rows + 1).min(self.down);
            for x in 0..self.across {
                let span = x.saturating_sub(columns)..(x + columns + 1).min(self.across);
                grown.chosen[y * self.across + x] = lines
                    .clone()
                    .any(|line| self.chosen[line * self.across..][span.clone()].contains(&true));
            }
        }
        grown
    }

    /// Whether the tile at a row of pixels is in the set.
    #[inline(always)]
    pub(super) fn has(&self, tile: usize, y: usize) -> bool {
        self.chosen[y / ROWS * self.across + tile]
    }

    /// Whether any of the columns `first..=last` of a row of pixels is in the set.
    pub(super) fn has_columns(&self, first: usize, last: usize, y: usize) -> bool {
        (first / BLOCK..=last / BLOCK).any(|tile| self.has(tile, y))
    }

    fn filled(width: usize, height: usize, chosen: bool) -> Self {
        let (across, down) = (width.div_ceil(BLOCK), height.div_ceil(ROWS));
        Self {
            across,
            down,
            chosen: vec![chosen; across * down],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_hold_the_low_values_and_grow_to_the_border() {
        let plane = Plane::from_fn(100, 30, |x, y| if (x, y) == (70, 9) { 0.5 } else { 1.0 });
        let cells = CellSet::at_most(&plane, 0.5);
        assert!(cells.has(2, 8) && cells.has_columns(10, 64, 15) && !cells.has_columns(10, 63, 15));
        assert!(!cells.has(2, 7) && !cells.has(2, 16));
        let grown = cells.grown(1, 2);
        assert!(grown.has(1, 0) && grown.has(3, 29) && !grown.has(0, 9));
        assert!(CellSet::whole(100, 30).has(3, 29));
    }
}
