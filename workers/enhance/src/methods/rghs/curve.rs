//! Steps 1 and 2: the curve of each channel.

use imaging::Rgb8;

use crate::blocks::histogram::{self, CodeCounts, Curves, histograms};
use crate::variant::Variant;

/// Cubed residual energy after a unit of distance.
const TRANSMITTANCE: [f64; 3] = [0.83 * 0.83 * 0.83, 0.95 * 0.95 * 0.95, 0.97 * 0.97 * 0.97];
const K: [f64; 3] = [1.1, 0.9, 0.9];
/// Share of the codes beyond either end of the stretch.
const TAIL: f64 = 0.005;

pub(super) fn curves(picture: &Rgb8, variant: Variant) -> Curves {
    let counts = histograms(picture);
    let one_color = counts.iter().map(histogram::ends).all(|(low, high)| low == high);
    std::array::from_fn(|channel| {
        if one_color {
            return std::array::from_fn(|code| code as f64);
        }
        let gain = match histogram::mean(&counts[channel]) {
            mean if channel > 0 && mean > 0.0 => 127.5 / mean,
            _ => 1.0,
        };
        let equalized: [u8; 256] = std::array::from_fn(|code| (code as f64 * gain + 0.5).min(255.0) as u8);
        let ends = match variant {
            Variant::Fast => ends(&counts[channel], &equalized),
            Variant::Reference => ends_of_sorted(picture, channel, &equalized),
        };
        let line = StretchLine::new(&ends, channel);
        equalized.map(|code| line.value(f64::from(code)))
    })
}

/// The mode of a channel's codes, and the ends of the stretch.
struct StretchEnds {
    mode: u8,
    low: u8,
    high: u8,
}

fn ends(counts: &CodeCounts, equalized: &[u8; 256]) -> StretchEnds {
    let mut moved: CodeCounts = [0; 256];
    for (&code, count) in equalized.iter().zip(counts) {
        moved[usize::from(code)] += count;
    }
    let mode = (0..256).rev().max_by_key(|&code| moved[code]).unwrap_or(0);
    let below: u64 = moved[..mode].iter().sum();
    let others = histogram::total(&moved) - below;
    let low = if below > 0 {
        histogram::code_at(&moved, tail(below))
    } else {
        mode
    };
    let high = histogram::code_at(&moved, below + others - 1 - tail(others));
    StretchEnds {
        mode: mode as u8,
        low: low as u8,
        high: high as u8,
    }
}

fn ends_of_sorted(picture: &Rgb8, channel: usize, equalized: &[u8; 256]) -> StretchEnds {
    let mut sorted: Vec<u8> = picture
        .pixels()
        .map(|pixel| equalized[usize::from(pixel[channel])])
        .collect();
    sorted.sort_unstable();
    // Among runs of equal length the first, which has the smallest code.
    let longest = sorted.chunk_by(|a, b| a == b).rev().max_by_key(|run| run.len());
    let mode = longest.map_or(0, |run| run[0]);
    let below = sorted.partition_point(|&code| code < mode);
    let (left, right) = sorted.split_at(below);
    let low = left
        .get(tail(left.len() as u64) as usize)
        .copied()
        .unwrap_or(mode);
    let high = right[right.len() - 1 - tail(right.len() as u64) as usize];
    StretchEnds { mode, low, high }
}

fn tail(count: u64) -> u64 {
    (TAIL * count as f64) as u64
}

/// The line of step 2.
struct StretchLine {
    from: (f64, f64),
    to: (f64, f64),
}

impl StretchLine {
    fn new(ends: &StretchEnds, channel: usize) -> Self {
        let (mode, low, high) = (f64::from(ends.mode), f64::from(ends.low), f64::from(ends.high));
        let to_ends = if mode > 0.0 {
            let kt = K[channel] * TRANSMITTANCE[channel];
            let n = ((255.0 - high) * kt / mode).floor();
            let top = if n >= 1.0 {
                (1.526 + (n + 1.0) / 2.0) * mode / kt
            } else {
                255.0
            };
            (mode - 0.655 * mode, top.max(high).min(255.0))
        } else {
            (0.0, 255.0)
        };
        Self {
            from: (low, high),
            to: to_ends,
        }
    }

    fn value(&self, code: f64) -> f64 {
        let ((low, high), (bottom, top)) = (self.from, self.to);
        if high <= low {
            return code;
        }
        (bottom + (code - low) * (top - bottom) / (high - low)).clamp(0.0, 255.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_stretch_is_relative_to_the_mode() {
        // Red: 100 thrice, 60 and 140 once: mode 100, one code below, ends 60 and 140.
        let picture = Rgb8::from_fn(5, 1, |x, _| [[100, 60, 100, 140, 100][x], 128, 128]);
        for variant in [Variant::Fast, Variant::Reference] {
            let [red, ..] = curves(&picture, variant);
            let kt = 1.1 * 0.83f64.powi(3);
            // n = floor(115 · 0.629 / 100) = 0: up to 255.
            assert_eq!((115.0 * kt / 100.0).floor(), 0.0);
            assert!((red[60] - 34.5).abs() < 1e-12 && (red[140] - 255.0).abs() < 1e-12);
            assert!((red[100] - (34.5 + 255.0) / 2.0).abs() < 1e-12);
        }
    }

    #[test]
    fn a_dark_mode_bounds_the_top() {
        let picture = Rgb8::from_fn(4, 1, |x, _| [[20, 20, 10, 40][x], 0, 0]);
        for variant in [Variant::Fast, Variant::Reference] {
            let [red, green, _] = curves(&picture, variant);
            let kt = 1.1 * 0.83f64.powi(3);
            let n = (215.0 * kt / 20.0).floor();
            assert!((red[40] - (1.526 + (n + 1.0) / 2.0) * 20.0 / kt).abs() < 1e-12);
            // No light: nothing to scale, and a single code cannot be stretched.
            assert_eq!(green[0], 0.0);
        }
    }

    #[test]
    fn of_equally_frequent_codes_the_smallest_is_the_mode() {
        let picture = Rgb8::from_fn(4, 1, |x, _| [[80, 200, 200, 80][x], 0, 0]);
        for variant in [Variant::Fast, Variant::Reference] {
            let [red, ..] = curves(&picture, variant);
            // No code is below 80: it maps to 0.345 · 80.
            assert!((red[80] - 27.6).abs() < 1e-12, "{}", red[80]);
        }
    }
}
