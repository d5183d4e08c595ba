//! The fast variant: the circular Gaussian as two short passes, in single precision.
//!
//! One sweep down the picture. The rows that a column sum needs are kept in a ring, so nothing leaves the cache
//! between the logarithm and the finished row. Padding never exists in memory: each pass asks which sample stands at
//! a padded position.

use imaging::Plane;
use pulp::{Simd, WithSimd};

use super::TABLE1_LUMA_MIN;
use super::padding::{padded_side, source};
use crate::elementary::{exp_nonpositive, ln};
use crate::hscm::luma::Luma;
use crate::hscm::options::{Options, Profile, Settings};

/// Columns whose sums are held in registers at once: four vectors of eight.
const BLOCK: usize = 32;

/// The code of every pixel.
pub(super) fn codes(luma: &Luma, options: &Options, kernel_x: &[f32], kernel_y: &[f32]) -> Plane<u8> {
    let rounding = match options.settings().profile {
        Profile::Standard => 0.5,
        Profile::Table1 => 0.0,
    };
    let (width, height) = luma.codes().size();
    let mut codes = Plane::filled(width, height, 0u8);
    let finish = |y: usize, row: &[f32]| {
        for (code, &x) in codes.row_mut(y).iter_mut().zip(row) {
            *code = (255.0 * exp_nonpositive(x.min(0.0)) + rounding) as i32 as u8;
        }
    };
    pulp::Arch::new().dispatch(Sweep {
        luma,
        options,
        kernel_x,
        kernel_y,
        finish,
    });
    codes
}

/// The filtered logarithm `x`.
pub(super) fn filtered_log(luma: &Luma, options: &Options, kernel_x: &[f32], kernel_y: &[f32]) -> Plane<f32> {
    let (width, height) = luma.codes().size();
    let mut logs = Plane::filled(width, height, 0.0f32);
    let finish = |y: usize, row: &[f32]| logs.row_mut(y).copy_from_slice(row);
    pulp::Arch::new().dispatch(Sweep {
        luma,
        options,
        kernel_x,
        kernel_y,
        finish,
    });
    logs
}

struct Sweep<'a, F> {
    luma: &'a Luma,
    options: &'a Options,
    /// Half kernels, centre first.
    kernel_x: &'a [f32],
    kernel_y: &'a [f32],
    /// Takes each finished row of `x`, from the top down.
    finish: F,
}

impl<F: FnMut(usize, &[f32])> WithSimd for Sweep<'_, F> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, _: S) {
        let Settings {
            r_high,
            r_low,
            profile,
            ..
        } = *self.options.settings();
        let (gain, drop) = (r_high as f32, (r_high - r_low) as f32);
        let (width, height) = self.luma.codes().size();
        let padded = padded_side(height);
        let radius = self.kernel_y.len() - 1;
        let mut rows = RowPass::new(self.luma, self.options, self.kernel_x);
        let mut logs = Ring::new(2 * radius + 1, rows.stride);
        let mut blurred = Ring::new(2 * radius + 1, rows.stride);
        let mut filtered = vec![0.0f32; rows.stride];
        // Positions count from `radius` rows above the picture, on a circle of `padded` rows.
        for position in 0..height + 2 * radius {
            match source((position + padded - radius) % padded, height, profile) {
                Some(y) => rows.run(y, logs.row_mut(position), blurred.row_mut(position)),
                None => blurred.row_mut(position).fill(0.0),
            }
            let Some(y) = position.checked_sub(2 * radius) else {
                continue;
            };
            let centre = y + radius;
            let blocks = filtered
                .chunks_exact_mut(BLOCK)
                .zip(logs.row(centre).chunks_exact(BLOCK));
            for (block, (x, log)) in blocks.enumerate() {
                let sums = weighted_sum(self.kernel_y, |offset| {
                    &blurred.row(centre.wrapping_add_signed(offset))[block * BLOCK..]
                });
                for i in 0..BLOCK {
                    x[i] = gain * log[i] - drop * sums[i];
                }
            }
            (self.finish)(y, &filtered[..width]);
        }
    }
}

/// The last rows of a sweep, by their position.
struct Ring {
    rows: usize,
    stride: usize,
    samples: Vec<f32>,
}

impl Ring {
    fn new(rows: usize, stride: usize) -> Self {
        Self {
            rows,
            stride,
            samples: vec![0.0; rows * stride],
        }
    }

    #[inline(always)]
    fn row(&self, position: usize) -> &[f32] {
        &self.samples[position % self.rows * self.stride..][..self.stride]
    }

    #[inline(always)]
    fn row_mut(&mut self, position: usize) -> &mut [f32] {
        &mut self.samples[position % self.rows * self.stride..][..self.stride]
    }
}

/// Logarithm and row sums of one row of the picture.
struct RowPass<'a> {
    luma: &'a Luma,
    kernel: &'a [f32],
    scale: f32,
    least: f32,
    offset: f32,
    /// Columns of the picture that stand before and after it on the padded circle; `None` where the padding is 0.
    before: Vec<Option<usize>>,
    after: Vec<Option<usize>>,
    /// A row with what stands before and after it, rounded up to whole blocks.
    line: Vec<f32>,
    /// Width rounded up to whole blocks.
    stride: usize,
}

impl<'a> RowPass<'a> {
    fn new(luma: &'a Luma, options: &Options, kernel: &'a [f32]) -> Self {
        let Settings { eps, profile, .. } = *options.settings();
        let (least, offset) = match profile {
            Profile::Standard => (0.0, eps as f32),
            Profile::Table1 => (TABLE1_LUMA_MIN as f32, 0.0),
        };
        let width = luma.codes().width();
        let padded = padded_side(width);
        let radius = kernel.len() - 1;
        let stride = width.next_multiple_of(BLOCK);
        Self {
            luma,
            kernel,
            scale: 1.0 / luma.white() as f32,
            least,
            offset,
            before: (0..radius)
                .map(|i| source(padded - radius + i, width, profile))
                .collect(),
            after: (0..radius)
                .map(|i| source((width + i) % padded, width, profile))
                .collect(),
            line: vec![0.0; stride + 2 * radius],
            stride,
        }
    }

    #[inline(always)]
    fn run(&mut self, y: usize, logs: &mut [f32], blurred: &mut [f32]) {
        let Self {
            scale, least, offset, ..
        } = *self;
        let codes = self.luma.codes().row(y);
        let logs = &mut logs[..codes.len()];
        // Codes stay below 2^26, and the signed conversion is the one that vector units have.
        for (log, &code) in logs.iter_mut().zip(codes) {
            *log = ln((code as i32 as f32 * scale).max(least) + offset);
        }
        let (before, line) = self.line.split_at_mut(self.before.len());
        let (inside, after) = line.split_at_mut(logs.len());
        inside.copy_from_slice(logs);
        for (sample, column) in before
            .iter_mut()
            .zip(&self.before)
            .chain(after.iter_mut().zip(&self.after))
        {
            *sample = column.map_or(0.0, |x| logs[x]);
        }
        let radius = self.before.len();
        for (block, out) in blurred.chunks_exact_mut(BLOCK).enumerate() {
            let window = &self.line[block * BLOCK..][..BLOCK + 2 * radius];
            out.copy_from_slice(&weighted_sum(self.kernel, |offset| {
                &window[radius.wrapping_add_signed(offset)..]
            }));
        }
    }
}

/// `k_0 s(0) + Σ k_t (s(-t) + s(t))` for `BLOCK` neighbouring columns; `samples(t)` starts at the block, shifted by t.
#[inline(always)]
fn weighted_sum<'a>(kernel: &[f32], samples: impl Fn(isize) -> &'a [f32]) -> [f32; BLOCK] {
    let mut sums = [0.0f32; BLOCK];
    let centre = &samples(0)[..BLOCK];
    for i in 0..BLOCK {
        sums[i] = kernel[0] * centre[i];
    }
    for (t, &weight) in kernel.iter().enumerate().skip(1) {
        let before = &samples(-(t as isize))[..BLOCK];
        let after = &samples(t as isize)[..BLOCK];
        for i in 0..BLOCK {
            sums[i] += weight * (before[i] + after[i]);
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use imaging::{Raster, Rgb8};

    use super::super::recipe::Recipe;
    use super::*;

    #[test]
    fn the_width_of_the_vector_unit_changes_no_bit() {
        let picture = Rgb8::from_fn(131, 97, |x, y| [(x * y) as u8, (7 * x) as u8, (3 * y) as u8]);
        let (luma, options) = (Luma::of(&Raster::from(picture)), Options::default());
        let Recipe::Separable { kernel_x, kernel_y } = Recipe::choose((131, 97), &options) else {
            panic!("the default cut-off is separable at this size");
        };
        let mut plain = Plane::filled(131, 97, 0.0f32);
        let finish = |y: usize, row: &[f32]| plain.row_mut(y).copy_from_slice(row);
        let sweep = Sweep {
            luma: &luma,
            options: &options,
            kernel_x: &kernel_x,
            kernel_y: &kernel_y,
            finish,
        };
        sweep.with_simd(pulp::Scalar);
        let dispatched = filtered_log(&luma, &options, &kernel_x, &kernel_y);
        assert!(
            plain
                .data()
                .iter()
                .zip(dispatched.data())
                .all(|(a, b)| a.to_bits() == b.to_bits())
        );
    }
}
