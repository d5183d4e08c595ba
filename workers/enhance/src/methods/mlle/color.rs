//! Step 1 for the codes of a picture: each channel is stretched by a line or filled from the largest one.

use imaging::Rgb8;

use crate::blocks::histogram::{self, histograms};

/// Color loss that ends the repetitions.
const LOSS: f64 = 1e-2;

/// The color transfer of a picture.
pub(super) struct Transfer {
    /// Channel with the largest mean, the first of several.
    largest: usize,
    channels: [ChannelTransfer; 3],
}

/// The transfer of one channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum ChannelTransfer {
    /// A line over the channel in 0..=1.
    Stretched(Line),
    /// `c + S_c l'`, with the line of l' over the codes of the largest channel.
    Filled(f64, Line),
}

/// `scale (c - low)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Line {
    pub(super) low: f64,
    pub(super) scale: f64,
}

impl Line {
    pub(super) fn value(self, c: f64) -> f64 {
        self.scale * (c - self.low)
    }
}

impl Transfer {
    pub(super) fn new(picture: &Rgb8) -> Self {
        let counts = histograms(picture);
        let sums = counts.each_ref().map(histogram::sum);
        let most = sums.iter().copied().max().unwrap_or(0);
        let largest = sums.iter().position(|&sum| sum == most).unwrap_or(0);
        let lines = counts.each_ref().map(|counts| {
            let (low, high) = histogram::ends(counts);
            match high - low {
                0 => Line { low: 0.0, scale: 1.0 },
                span => Line {
                    low: low as f64 / 255.0,
                    scale: 255.0 / span as f64,
                },
            }
        });
        let means = counts.each_ref().map(|counts| histogram::mean(counts) / 255.0);
        let reached = lines[largest].value(means[largest]);
        let missing = [0, 1, 2].map(|c| if sums[c] == most { 0.0 } else { reached - means[c] });
        let reach = reach(missing.iter().map(|missing| missing.abs()).sum(), reached);
        Self {
            largest,
            channels: std::array::from_fn(|c| {
                if sums[c] == most {
                    ChannelTransfer::Stretched(lines[c])
                } else {
                    ChannelTransfer::Filled(missing[c] * reach, lines[largest])
                }
            }),
        }
    }

    pub(super) fn largest(&self) -> usize {
        self.largest
    }

    pub(super) fn channels(&self) -> [ChannelTransfer; 3] {
        self.channels
    }

    /// The stretch of the largest channel.
    pub(super) fn stretch(&self) -> f64 {
        match self.channels[self.largest] {
            ChannelTransfer::Stretched(line) | ChannelTransfer::Filled(_, line) => line.scale,
        }
    }
}

/// `(1 - (1 - m)^K) / m` for the mean m of l' and the least K with `loss (1 - m)^K <= LOSS`.
fn reach(loss: f64, mean: f64) -> f64 {
    if loss <= LOSS || mean <= 0.0 {
        return 0.0;
    }
    if mean >= 1.0 {
        return 1.0;
    }
    let repetitions = ((LOSS / loss).ln() / (-mean).ln_1p()).ceil();
    -(repetitions * (-mean).ln_1p()).exp_m1() / mean
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_closed_form_equals_the_repetitions() {
        for (loss, mean) in [(0.5, 0.4), (0.02, 0.7), (1.2, 0.05), (0.3, 1.0)] {
            let (mut rest, mut sum) = (1.0, 0.0);
            while loss * rest > LOSS {
                sum += rest;
                rest -= rest * mean;
            }
            assert!((reach(loss, mean) - sum).abs() < 1e-9, "{loss} {mean}");
        }
        assert_eq!((reach(0.01, 0.5), reach(0.5, 0.0)), (0.0, 0.0));
    }

    #[test]
    fn the_largest_channel_is_stretched_and_the_others_are_filled() {
        // Means 0.2, 0.6 and 0.6 of 255.
        let picture = Rgb8::from_fn(2, 1, |x, _| [[51, 102, 153], [51, 204, 153]][x]);
        let transfer = Transfer::new(&picture);
        assert_eq!((transfer.largest(), transfer.stretch()), (1, 2.5));
        let [red, green, blue] = transfer.channels();
        assert_eq!(green, ChannelTransfer::Stretched(Line { low: 0.4, scale: 2.5 }));
        assert_eq!(blue, ChannelTransfer::Stretched(Line { low: 0.0, scale: 1.0 }));
        // l' has the mean 0.5; a loss of 0.3 needs five halvings.
        let ChannelTransfer::Filled(share, line) = red else {
            panic!("{red:?}")
        };
        assert_eq!(line, Line { low: 0.4, scale: 2.5 });
        assert!(
            (share - 0.3 * (1.0 - 0.5f64.powi(5)) / 0.5).abs() < 1e-12,
            "{share}"
        );
    }
}
