//! Shannon entropy, `H = -Σ p log2 p` in bits, of several distributions of a picture's codes.

use crate::colors::Colors;
use crate::work::{ChannelPlanes, Gray, MetricInput};

/// Entropy of the 256-bin histogram of gray codes, 0..=8.
pub(crate) fn gray(work: &MetricInput) -> f64 {
    of_codes(work.part::<Gray>().0.data())
}

/// Entropy of the red channel, 0..=8.
pub(crate) fn red(work: &MetricInput) -> f64 {
    of_codes(work.part::<ChannelPlanes>().0[0].data())
}

/// Entropy of the green channel, 0..=8.
pub(crate) fn green(work: &MetricInput) -> f64 {
    of_codes(work.part::<ChannelPlanes>().0[1].data())
}

/// Entropy of the blue channel, 0..=8.
pub(crate) fn blue(work: &MetricInput) -> f64 {
    of_codes(work.part::<ChannelPlanes>().0[2].data())
}

/// Entropy over distinct colors, 0..=24 and at most `log2` of the number of pixels.
pub(crate) fn joint(work: &MetricInput) -> f64 {
    let colors = work.part::<Colors>();
    of_counts(colors.counts.iter().copied(), colors.pixels)
}

/// Entropy of the pairs (gray code, mean gray code of the 3 × 3 neighborhood rounded down), 0..=16. The neighborhood
/// includes the center; the border is replicated.
pub(crate) fn with_neighborhood(work: &MetricInput) -> f64 {
    let gray = &work.part::<Gray>().0;
    let (width, height) = gray.size();
    let mut counts = vec![0u32; 1 << 16];
    let mut sums = vec![0u16; width];
    for y in 0..height {
        let rows = [
            gray.row(y.saturating_sub(1)),
            gray.row(y),
            gray.row((y + 1).min(height - 1)),
        ];
        for (x, sum) in sums.iter_mut().enumerate() {
            *sum = rows.iter().map(|row| u16::from(row[x])).sum();
        }
        for (x, &code) in rows[1].iter().enumerate() {
            let sum = sums[x.saturating_sub(1)] + sums[x] + sums[(x + 1).min(width - 1)];
            counts[usize::from(code) << 8 | usize::from(sum / 9)] += 1;
        }
        if let Some(mask) = work.mask() {
            for (x, &code) in rows[1].iter().enumerate().filter(|(x, _)| mask.pixel(*x, y) == 0) {
                let sum = sums[x.saturating_sub(1)] + sums[x] + sums[(x + 1).min(width - 1)];
                counts[usize::from(code) << 8 | usize::from(sum / 9)] -= 1;
            }
        }
    }
    let total = counts.iter().map(|&count| count as usize).sum();
    of_counts(counts.into_iter(), total)
}

fn of_codes(codes: &[u8]) -> f64 {
    let mut counts = [0u32; 256];
    for &code in codes {
        counts[usize::from(code)] += 1;
    }
    of_counts(counts.into_iter(), codes.len())
}

/// `-Σ p log2 p` with `p = count / total`, in the given order; `0 log 0` is 0.
fn of_counts(counts: impl Iterator<Item = u32>, total: usize) -> f64 {
    let total = total as f64;
    let mut entropy = 0.0;
    for count in counts.filter(|&count| count > 0) {
        let p = f64::from(count) / total;
        entropy -= p * p.log2();
    }
    entropy
}
