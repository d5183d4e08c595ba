//! For pictures so wide that the Gaussian is short down the columns: the picture has half its width, as in
//! [`decimated`](super::decimated), and its full height, as in [`separable`](super::separable). The Gaussian is as many bins wide on
//! both axes, so at 16:9 its σ is 5.1 pixels along a row but 2.9 down a column, where every second row would not be enough.

use super::decimated::{Narrowing, REACH, blur_line, widen_row};
use super::padding::padded_side;
use super::parameters::Filter;
use super::recipe::PassKernels;
use super::separable::{BLOCK, RowRing};
use crate::methods::hscm::luma::Luma;

/// Filters a picture; calls `finish` with each finished row of `x`, from the top down. Compile it by `vectorized!`.
#[inline(always)]
pub(super) fn sweep(
    luma: &Luma,
    filter: &Filter,
    kernels: &PassKernels,
    finish: &mut impl FnMut(usize, &[f32]),
) {
    let (gain, drop) = (filter.gain_high as f32, filter.drop() as f32);
    let (width, height) = luma.codes().size();
    let padded = padded_side(height);
    let [along, radius] = [&kernels.x, &kernels.y].map(|kernel| kernel.len() - 1);
    let mut narrowing = Narrowing::new(luma, filter.eps);
    let half = narrowing.half;
    let stride = half.next_multiple_of(BLOCK);
    let mut line = vec![0.0f32; stride + 2 * along.max(REACH)];
    let mut logs = RowRing::new(2 * radius + 1, width);
    let mut narrow = vec![0.0f32; half];
    let mut small = RowRing::new(2 * radius + 1, stride);
    let mut row = vec![0.0f32; width];
    // Positions count from `radius` rows above the picture, on a circle of `padded` rows.
    for position in 0..height + 2 * radius {
        let turned = (position + padded - radius) % padded;
        narrowing.run(turned, logs.row_mut(position), &mut narrow);
        line[along..along + half].copy_from_slice(&narrow);
        blur_line(&kernels.x, &mut line, half, small.row_mut(position));
        let Some(y) = position.checked_sub(2 * radius) else {
            continue;
        };
        widen_row(&small, y + radius, &kernels.y, &mut line, half, &mut row);
        for (x, &log) in row.iter_mut().zip(logs.row(y + radius)) {
            *x = gain * log - drop * *x;
        }
        finish(y, &row);
    }
}
