//! UCIQE: spread of chroma, contrast of lightness and mean saturation in CIE Lab (Yang and Sowmya 2015).
//!
//! sRGB codes → linear light → XYZ (sRGB primaries) → Lab with white (0.95047, 1, 1.08883); `l = L / 100`, `C = sqrt(a²
//! + b²) / 100` (0 below 1e-6, which is rounding of a gray). `UCIQE = 0.4680 σ_C + 0.2745 con_l + 0.2576 μ_s`: σ_C the
//! standard deviation of C; con_l the mean of the k largest l less the mean of the k smallest, k one hundredth of the
//! pixels, at least 1; μ_s the mean of `s = C / sqrt(C² + l²)`.

use imaging::{lab, vectorized};

use crate::colors::Colors;
use crate::linear::LINEAR;
use crate::work::{MetricInput, SharedPart};

/// The weighted sum.
pub(crate) fn uciqe(work: &MetricInput) -> f64 {
    let Terms { sigma_c, con_l, mu_s } = *work.part();
    0.4680 * sigma_c + 0.2745 * con_l + 0.2576 * mu_s
}

/// Standard deviation of chroma.
pub(crate) fn sigma_c(work: &MetricInput) -> f64 {
    work.part::<Terms>().sigma_c
}

/// Contrast of lightness.
pub(crate) fn con_l(work: &MetricInput) -> f64 {
    work.part::<Terms>().con_l
}

/// Mean saturation.
pub(crate) fn mu_s(work: &MetricInput) -> f64 {
    work.part::<Terms>().mu_s
}

/// The three terms of a picture.
struct Terms {
    sigma_c: f64,
    con_l: f64,
    mu_s: f64,
}

impl SharedPart for Terms {
    fn new(work: &MetricInput) -> Self {
        let colors = work.part::<Colors>();
        vectorized!(terms(&colors, &LINEAR))
    }
}

/// Colors converted together.
const BATCH: usize = 64;
/// Independent partial sums, added in a fixed order on any vector unit.
const LANES: usize = 8;

#[inline(always)]
fn terms(colors: &Colors, linear: &[f64; 256]) -> Terms {
    let Colors {
        codes,
        counts,
        pixels,
    } = colors;
    let mut lightness = vec![0.0f64; counts.len()];
    // Chroma relative to the first color's, so that its variance does not cancel.
    let origin = ColorBatch::new(linear, &codes[..3]).chroma[0];
    let [mut chroma_sums, mut square_sums, mut saturation_sums] = [[0.0f64; LANES]; 3];
    let weighted = lightness.chunks_mut(BATCH).zip(counts.chunks(BATCH));
    for (codes, (lightness, counts)) in codes.chunks(3 * BATCH).zip(weighted) {
        let batch = ColorBatch::new(linear, codes);
        let count = lightness.len();
        lightness.copy_from_slice(&batch.lightness[..count]);
        for i in 0..count {
            let (offset, count) = (batch.chroma[i] - origin, f64::from(counts[i]));
            chroma_sums[i % LANES] += count * offset;
            square_sums[i % LANES] += count * (offset * offset);
            saturation_sums[i % LANES] += count * batch.saturation[i];
        }
    }
    let [chroma, square, saturation] =
        [chroma_sums, square_sums, saturation_sums].map(|lanes| lanes.iter().sum::<f64>() / *pixels as f64);
    Terms {
        sigma_c: (square - chroma * chroma).max(0.0).sqrt(),
        con_l: contrast(&lightness, counts),
        mu_s: saturation,
    }
}

/// Lab quantities of a batch of colors.
struct ColorBatch {
    lightness: [f64; BATCH],
    chroma: [f64; BATCH],
    saturation: [f64; BATCH],
}

impl ColorBatch {
    #[inline(always)]
    fn new(linear: &[f64; 256], codes: &[u8]) -> Self {
        let [l, a, b] = lab::of_codes::<BATCH>(codes, [linear; 3]);
        let [mut lightness, mut chroma, mut saturation] = [[0.0; BATCH]; 3];
        for i in 0..BATCH {
            let l = l[i] / 100.0;
            let length = (a[i] * a[i] + b[i] * b[i]).sqrt() / 100.0;
            let length = if length < 1e-6 { 0.0 } else { length };
            let norm = (length * length + l * l).sqrt();
            lightness[i] = l;
            chroma[i] = length;
            saturation[i] = if length > 0.0 { length / norm } else { 0.0 };
        }
        Self {
            lightness,
            chroma,
            saturation,
        }
    }
}

/// Mean of the k largest values less the mean of the k smallest, k a hundredth of them, rounded, at least 1. `counts`
/// are the multiplicities of the values.
fn contrast(lightness: &[f64], counts: &[u32]) -> f64 {
    const BINS: usize = 4096;
    let total: usize = counts.iter().map(|&count| count as usize).sum();
    let k = ((total as f64 * 0.01 + 0.5) as usize).max(1);
    let bin_of = |l: f64| ((l * BINS as f64) as usize).min(BINS - 1);
    let mut bins = vec![0usize; BINS];
    for (&l, &count) in lightness.iter().zip(counts) {
        bins[bin_of(l)] += count as usize;
    }
    let low = boundary((0..BINS).map(|bin| (bin, bins[bin])), k);
    let high = boundary((0..BINS).rev().map(|bin| (bin, bins[bin])), k);
    let (mut low_sum, mut high_sum) = (0.0, 0.0);
    let (mut low_rest, mut high_rest) = (Vec::new(), Vec::new());
    for (&l, &count) in lightness.iter().zip(counts) {
        let bin = bin_of(l);
        if bin < low.bin {
            low_sum += f64::from(count) * l;
        }
        if bin > high.bin {
            high_sum += f64::from(count) * l;
        }
        if bin == low.bin {
            low_rest.push((l, count));
        }
        if bin == high.bin {
            high_rest.push((l, count));
        }
    }
    low_rest.sort_unstable_by(|a, b| a.0.total_cmp(&b.0));
    high_rest.sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
    low_sum += first(&low_rest, low.wanted);
    high_sum += first(&high_rest, high.wanted);
    (high_sum - low_sum) / k as f64
}

/// The sum of the first `wanted` values.
fn first(values: &[(f64, u32)], wanted: usize) -> f64 {
    let mut left = wanted;
    let mut sum = 0.0;
    for &(value, count) in values {
        let taken = left.min(count as usize);
        sum += taken as f64 * value;
        left -= taken;
    }
    sum
}

/// The bin that contains the k-th value, and the number of its values among the first k.
struct Boundary {
    bin: usize,
    wanted: usize,
}

fn boundary(bins: impl Iterator<Item = (usize, usize)>, k: usize) -> Boundary {
    let mut wanted = k;
    for (bin, count) in bins {
        if count >= wanted {
            return Boundary { bin, wanted };
        }
        wanted -= count;
    }
    unreachable!("k is at most the number of values")
}

#[cfg(test)]
mod tests {
    use imaging::Rgb8;

    use super::*;
    use crate::subject::Subject;

    #[test]
    fn contrast_takes_a_hundredth_at_either_end_and_at_least_one() {
        assert_eq!(contrast(&[0.25], &[1]), 0.0);
        assert_eq!(contrast(&[0.25, 0.75, 0.5], &[1; 3]), 0.5);
        let ramp: Vec<f64> = (0..1000).rev().map(|i| f64::from(i) / 1000.0).collect();
        // The ten smallest have the mean 0.0045, the ten largest 0.9945.
        assert!((contrast(&ramp, &[1; 1000]) - 0.99).abs() < 1e-12);
        // The same from counts: the lowest value five times, the others ten each.
        let steps: Vec<f64> = (0..100).map(f64::from).collect();
        let counts: Vec<u32> = (0..100).map(|i| if i == 0 { 5 } else { 10 }).collect();
        // 995 values: ten of the lowest are five of 0 and five of 1, ten of the highest all 99.
        assert!((contrast(&steps, &counts) - 98.5).abs() < 1e-12);
    }

    #[test]
    fn values_that_share_a_bin_are_told_apart() {
        let mut close: Vec<f64> = (0..150).map(|i| 0.5 + 1e-9 * f64::from(i)).collect();
        close.reverse();
        // k = 2: means of 148, 149 and of 0, 1.
        assert!((contrast(&close, &[1; 150]) - 148e-9).abs() < 1e-15);
    }

    #[test]
    fn gray_has_no_chroma() {
        let gray = Rgb8::from_fn(16, 16, |x, y| [(16 * y + x) as u8; 3]);
        let terms = MetricInput::new(&Subject::new(&gray)).part::<Terms>();
        assert_eq!((terms.sigma_c, terms.mu_s), (0.0, 0.0));
        // Black and white, three of 256 at either end.
        assert!(terms.con_l > 0.98 && terms.con_l < 1.0);
    }
}
