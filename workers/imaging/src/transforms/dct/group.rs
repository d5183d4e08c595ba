//! Groups of columns for the fast transform.

use super::Direction;
use super::butterfly;
use crate::fft::Complex;

/// Columns that are transformed together, and as many mirrored ones: eight complex numbers are a cache line.
pub(super) const TILE: usize = 16;

/// Columns joined by a butterfly: `low..low + count` and their mirrors, `width − k` for each k, in ascending order; or
/// a single self-mirrored column.
#[derive(Clone, Copy)]
pub(super) struct ColumnGroup {
    low: usize,
    count: usize,
    mirrored: usize,
}

impl ColumnGroup {
    /// The columns below a limit with their mirrors, for this width: self-mirrored ones first.
    pub(super) fn select_below(limit: usize, width: usize) -> impl Iterator<Item = Self> {
        let middle = (width > 1 && width.is_multiple_of(2)).then_some(width / 2);
        let pairs = width.div_ceil(2);
        let joined = (1..pairs).step_by(TILE).map(move |low| {
            let count = TILE.min(pairs - low);
            Self {
                low,
                count,
                mirrored: width + 1 - low - count,
            }
        });
        let single = (0..width.min(1)).chain(middle).map(|low| Self {
            low,
            count: 1,
            mirrored: low,
        });
        single.chain(joined).filter(move |group| group.low < limit)
    }

    /// Number of columns below the limit. Columns ascend within both halves; the mirrored ones are larger.
    pub(super) fn below_limit(self, limit: usize) -> usize {
        let low = limit.saturating_sub(self.low).min(self.count);
        let mirrored = limit.saturating_sub(self.mirrored).min(self.count);
        if self.is_alone() { low } else { low + mirrored }
    }

    fn is_alone(self) -> bool {
        self.low == self.mirrored
    }

    pub(super) fn columns(self) -> usize {
        if self.is_alone() { 1 } else { 2 * self.count }
    }

    /// The columns in the order of their lines.
    pub(super) fn places(self) -> impl Iterator<Item = usize> {
        let mirrored = if self.is_alone() { 0 } else { self.count };
        (self.low..self.low + self.count).chain(self.mirrored..self.mirrored + mirrored)
    }

    /// Copies the columns of a row-major plane into contiguous lines.
    pub(super) fn load(
        self,
        plane: &[Complex<f32>],
        width: usize,
        lines: &mut [Complex<f32>],
        height: usize,
    ) {
        for top in (0..height).step_by(TILE) {
            let bottom = (top + TILE).min(height);
            for (line, x) in lines.chunks_exact_mut(height).zip(self.places()) {
                for (value, y) in line[top..bottom].iter_mut().zip(top..bottom) {
                    *value = plane[y * width + x];
                }
            }
        }
    }

    /// Inverse of [`ColumnGroup::load`].
    pub(super) fn store(
        self,
        lines: &[Complex<f32>],
        height: usize,
        plane: &mut [Complex<f32>],
        width: usize,
    ) {
        for top in (0..height).step_by(TILE) {
            let bottom = (top + TILE).min(height);
            for (line, x) in lines.chunks_exact(height).zip(self.places()) {
                for (value, y) in line[top..bottom].iter().zip(top..bottom) {
                    plane[y * width + x] = *value;
                }
            }
        }
    }

    /// Joins each column and its mirror.
    #[inline(always)]
    pub(super) fn join(
        self,
        direction: Direction,
        twiddles: &[Complex<f32>],
        lines: &mut [Complex<f32>],
        height: usize,
    ) {
        if self.low == 0 {
            return;
        }
        if self.is_alone() {
            return butterfly::middle(direction, twiddles[self.low], lines);
        }
        let (low, high) = lines.split_at_mut(self.count * height);
        let pairs = low
            .chunks_exact_mut(height)
            .zip(high.chunks_exact_mut(height).rev());
        for (k, (one, other)) in (self.low..).zip(pairs) {
            butterfly::across(direction, twiddles[k], one, other);
        }
    }
}
