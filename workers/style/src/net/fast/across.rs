//! Bilinear upsampling of the context: each row is widened at first use, and two neighbors are mixed for every row of
//! the frame.

use super::planes::{BorderedPlanes, stride};

/// Position of a frame sample between two context samples.
#[derive(Debug, Clone, Copy)]
pub(super) struct UpsamplePosition {
    pub(super) low: usize,
    pub(super) high: usize,
    /// Weight of `high`, 0..=1.
    pub(super) share: f32,
}

/// Pixel centers at half integers, clamped to the edge.
pub(super) fn place(at: usize, to: usize, from: usize) -> UpsamplePosition {
    let exact = ((at as f64 + 0.5) * from as f64 / to as f64 - 0.5).clamp(0.0, (from - 1) as f64);
    let low = exact as usize;
    UpsamplePosition {
        low,
        high: (low + 1).min(from - 1),
        share: (exact - low as f64) as f32,
    }
}

/// The two most recently widened rows of the context.
#[derive(Debug, Default)]
pub(super) struct Widened {
    columns: Vec<UpsamplePosition>,
    /// Row number in each slot.
    held: [Option<usize>; 2],
    rows: [Vec<f32>; 2],
    stride: usize,
}

impl Widened {
    /// Prepares for a frame of this width.
    pub(super) fn start(&mut self, width: usize, context: &BorderedPlanes) {
        self.columns.clear();
        self.columns
            .extend((0..width).map(|x| place(x, width, context.width)));
        self.held = [None; 2];
        self.stride = stride(width);
        for row in &mut self.rows {
            row.resize(8 * self.stride, 0.0);
        }
    }

    /// Widens the rows of a position unless they are cached.
    pub(super) fn fetch(&mut self, context: &BorderedPlanes, place: UpsamplePosition) {
        for y in [place.low, place.high] {
            let slot = y % 2;
            if self.held[slot] == Some(y) {
                continue;
            }
            for channel in 0..8 {
                let narrow = &context.row(channel, y + 1)[1..];
                let wide = &mut self.rows[slot][channel * self.stride..][..self.columns.len()];
                for (wide, column) in wide.iter_mut().zip(&self.columns) {
                    let (left, right) = (narrow[column.low], narrow[column.high]);
                    *wide = left + (right - left) * column.share;
                }
            }
            self.held[slot] = Some(y);
        }
    }

    /// A channel of row `y` of the context at the width of the frame.
    #[inline(always)]
    pub(super) fn row(&self, y: usize, channel: usize) -> &[f32] {
        &self.rows[y % 2][channel * self.stride..][..self.stride]
    }
}
