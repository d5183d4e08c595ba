//! Statistics over paths: means and their standard errors.

use std::ops::Range;

use imaging::cancel;
use imaging::random::Stream;
use serde::Serialize;

use crate::dice::Address;
use crate::scene::{Along, TracedScene};
use crate::walk::{ORDERS, PathTally};

/// Equal batches of the paths of a pixel; the error follows from their scatter.
pub const BATCHES: usize = 16;

/// A mean and its standard error.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Level {
    /// The mean.
    pub mean: f64,
    /// Its standard error.
    pub error: f64,
}

/// Light by the number of scattering events.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum LightPart {
    /// None.
    Unscattered,
    /// One.
    Single,
    /// Two or more.
    Multiple,
    /// One or more.
    Scattered,
    /// Any.
    All,
}

impl LightPart {
    fn orders(self) -> Range<usize> {
        match self {
            Self::Unscattered => 0..1,
            Self::Single => 1..2,
            Self::Multiple => 2..ORDERS,
            Self::Scattered => 1..ORDERS,
            Self::All => 0..ORDERS,
        }
    }
}

/// Sums over the paths of a pixel by channel, order and batch.
#[derive(Debug, Clone, PartialEq)]
pub struct PixelSums {
    sums: [[[f64; BATCHES]; ORDERS]; 3],
    /// Paths ended by a limit.
    pub cut: u64,
}

impl PixelSums {
    pub(crate) const NOTHING: Self = Self {
        sums: [[[0.0; BATCHES]; ORDERS]; 3],
        cut: 0,
    };

    /// Traces some of the paths of a pixel. With `shared`, one path serves all channels.
    #[must_use]
    pub fn trace(
        scene: &TracedScene<'_>,
        along: Along,
        stream: Stream,
        at: Address,
        samples: Range<u64>,
        shared: bool,
    ) -> Self {
        let mut pixel = Self::NOTHING;
        for sample in samples {
            if sample % 64 == 0 {
                cancel::check();
            }
            if shared {
                let address = Address { sample, ..at };
                pixel.add([0, 1, 2], sample, scene.trace_shared(along, stream, address));
                continue;
            }
            for channel in 0..3 {
                let address = Address {
                    sample,
                    channel: channel as u64,
                    ..at
                };
                pixel.add([channel], sample, scene.trace(along, stream, address));
            }
        }
        pixel
    }

    pub(crate) fn add<const N: usize>(&mut self, channels: [usize; N], sample: u64, tally: PathTally<N>) {
        let batch = (sample % BATCHES as u64) as usize;
        for (i, channel) in channels.into_iter().enumerate() {
            for (order, light) in tally.orders.iter().enumerate() {
                self.sums[channel][order][batch] += light[i];
            }
        }
        self.cut += u64::from(tally.is_cut);
    }

    pub(crate) fn merge(&mut self, other: &Self) {
        let pairs = self
            .sums
            .iter_mut()
            .flatten()
            .flatten()
            .zip(other.sums.iter().flatten().flatten());
        pairs.for_each(|(sum, more)| *sum += more);
        self.cut += other.cut;
    }

    /// Mean and error of a channel after this many paths.
    fn level(&self, paths: u64, channel: usize, part: LightPart) -> Level {
        let share = BATCHES as f64 / paths as f64;
        let batches: [f64; BATCHES] = std::array::from_fn(|k| {
            share
                * part
                    .orders()
                    .map(|order| self.sums[channel][order][k])
                    .sum::<f64>()
        });
        level(&batches)
    }
}

/// Mean of batches and its standard error.
pub(crate) fn level(batches: &[f64]) -> Level {
    let n = batches.len() as f64;
    let mean = batches.iter().sum::<f64>() / n;
    let square = batches.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / (n - 1.0);
    Level {
        mean,
        error: (square / n).sqrt(),
    }
}

/// A frame divided into squares; those at its right and lower edge are smaller.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct PixelBlocks {
    /// Columns and rows of the frame.
    pub size: (usize, usize),
    /// Pixels on a side of a square.
    pub side: usize,
}

impl PixelBlocks {
    /// The pixels of each square by row-major number.
    pub fn pixels(self) -> impl Iterator<Item = Vec<usize>> {
        let (width, height) = self.size;
        let corners = (0..height).step_by(self.side);
        let corners = corners.flat_map(move |y| (0..width).step_by(self.side).map(move |x| (x, y)));
        corners.map(move |(left, top)| {
            let rows = top..(top + self.side).min(height);
            let columns = left..(left + self.side).min(width);
            rows.flat_map(|y| columns.clone().map(move |x| y * width + x))
                .collect()
        })
    }
}

/// The paths of a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Estimate {
    /// Columns and rows.
    pub size: (usize, usize),
    /// Paths of each pixel.
    pub paths: u64,
    pub(crate) pixels: Vec<PixelSums>,
}

/// Distribution of the errors of blocks.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ErrorSpread {
    /// Median.
    pub median: f64,
    /// 95th percentile.
    pub percentile_95: f64,
}

impl Estimate {
    /// Mean and error of a pixel.
    #[must_use]
    pub fn pixel(&self, pixel: usize, channel: usize, part: LightPart) -> Level {
        self.pixels[pixel].level(self.paths, channel, part)
    }

    /// Mean and error over several independent pixels.
    #[must_use]
    pub fn mean(&self, pixels: &[usize], channel: usize, part: LightPart) -> Level {
        let n = pixels.len() as f64;
        let levels = pixels.iter().map(|&pixel| self.pixel(pixel, channel, part));
        let (mean, square) = levels.fold((0.0, 0.0), |(mean, square), level| {
            (mean + level.mean, square + level.error * level.error)
        });
        Level {
            mean: mean / n,
            error: square.sqrt() / n,
        }
    }

    /// Mean and error of the frame.
    #[must_use]
    pub fn whole(&self, channel: usize, part: LightPart) -> Level {
        let all: Vec<usize> = (0..self.pixels.len()).collect();
        self.mean(&all, channel, part)
    }

    /// The errors of blocks.
    #[must_use]
    pub fn spread(&self, side: usize, channel: usize) -> ErrorSpread {
        let blocks = PixelBlocks {
            size: self.size,
            side,
        };
        let mut errors: Vec<f64> = blocks
            .pixels()
            .map(|pixels| self.mean(&pixels, channel, LightPart::All).error)
            .collect();
        errors.sort_by(f64::total_cmp);
        let [median, percentile_95] =
            [0.5, 0.95].map(|share| errors[((errors.len() - 1) as f64 * share).round() as usize]);
        ErrorSpread {
            median,
            percentile_95,
        }
    }

    /// Paths ended by a limit.
    #[must_use]
    pub fn cut(&self) -> u64 {
        self.pixels.iter().map(|pixel| pixel.cut).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_hold_every_pixel_once() {
        let blocks = PixelBlocks {
            size: (5, 3),
            side: 2,
        };
        let mut all: Vec<usize> = blocks.pixels().flatten().collect();
        all.sort_unstable();
        assert_eq!(all, (0..15).collect::<Vec<_>>());
        assert_eq!(blocks.pixels().next(), Some(vec![0, 1, 5, 6]));
    }
}
