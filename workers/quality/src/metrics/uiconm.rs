//! UIConM, contrast of blocks as an entropy-like mean (Panetta, Gao and Agaian 2016, eq. 7-8).
//!
//! For a block with largest intensity M and smallest m, of `I = (R + G + B) / 3` in blocks of 10 × 10, `q = [γ (M - m)
//! / (γ - m)] / [M + m - M m / γ]` with γ = 1026: a difference over a sum of the parameterized logarithmic image model.
//! `UIConM = -1 / (k1 k2) Σ q ln q`, 0 for M = m.
//!
//! `funie` uses M and m over the three channels together and the ordinary `q = (M - m) / (M + m)`, so a plain color has
//! contrast. `table1` uses integer thirds of the channels and blocks of 4 × 4; with `t = γ (m - M) / m / (γ - M m / γ)`
//! and `φ(z) = -γ ln(1 - z / γ)` it is the mean of `γ (1 - exp(-φ(t) φ(ln |t|) / γ))` over blocks with 0 < m < M. It is
//! practically unbounded below for a dark pixel next to a bright one, and higher is not better.

use crate::blocks::BlockGrid;
use crate::work::MetricInput;

const GAMMA: f64 = 1026.0;
const BLOCK_PX: usize = 10;
const TABLE1_BLOCK_PX: usize = 4;

/// UIConM of the article.
pub(crate) fn panetta(work: &MetricInput) -> f64 {
    mean(work, BLOCK_PX, 1, sum_channels, |low, high| {
        let (m, top) = (f64::from(low) / 3.0, f64::from(high) / 3.0);
        weighted_log((GAMMA * (top - m) / (GAMMA - m)) / (top + m - top * m / GAMMA))
    })
}

/// UIConM over the channels together.
pub(crate) fn funie(work: &MetricInput) -> f64 {
    mean(work, BLOCK_PX, 3, copy_codes, |low, high| {
        let (m, top) = (f64::from(low), f64::from(high));
        weighted_log((top - m) / (top + m))
    })
}

/// UIConM of the comparison table.
pub(crate) fn table1(work: &MetricInput) -> f64 {
    // Many blocks share their extremes: each pair is computed once.
    let mut known = vec![None; 1 << 16];
    mean(work, TABLE1_BLOCK_PX, 1, sum_thirds, |low, high| {
        let pair = usize::from(low) << 8 | usize::from(high);
        *known[pair].get_or_insert_with(|| match low {
            0 => 0.0,
            _ => table1_term(f64::from(low), f64::from(high)),
        })
    })
}

/// The mean over blocks of `term` of the smallest and the largest sample, 0 if they are equal. `fill` computes the
/// samples of a row from its codes, `samples` per pixel.
fn mean<T: Copy + PartialOrd + Default>(
    work: &MetricInput,
    side_px: usize,
    samples: usize,
    fill: impl Fn(&[u8], &mut [T]),
    mut term: impl FnMut(T, T) -> f64,
) -> f64 {
    let blocks = BlockGrid::new((work.picture().width(), work.picture().height()), side_px);
    let extremes = blocks.extremes(samples, |y, row: &mut [T]| fill(work.picture_row(y), row));
    let extremes = blocks.keep_inside(extremes, work.mask());
    let count = extremes.len().max(1) as f64;
    let uneven = extremes.into_iter().filter(|(low, high)| low < high);
    uneven.map(|(low, high)| term(low, high)).sum::<f64>() / count
}

/// The term of a block with these extremes.
fn table1_term(m: f64, top: f64) -> f64 {
    let t = GAMMA * (m - top) / m / (GAMMA - top * m / GAMMA);
    let [phi_t, phi_log] = [t, t.abs().ln()].map(|z| -GAMMA * (1.0 - z / GAMMA).ln());
    GAMMA * (1.0 - (-phi_t * phi_log / GAMMA).exp())
}

fn sum_channels(codes: &[u8], sums: &mut [u16]) {
    for (sum, p) in sums.iter_mut().zip(codes.chunks_exact(3)) {
        *sum = u16::from(p[0]) + u16::from(p[1]) + u16::from(p[2]);
    }
}

fn copy_codes(codes: &[u8], row: &mut [u8]) {
    row.copy_from_slice(&codes[..row.len()]);
}

fn sum_thirds(codes: &[u8], sums: &mut [u8]) {
    for (sum, p) in sums.iter_mut().zip(codes.chunks_exact(3)) {
        *sum = p[0] / 3 + p[1] / 3 + p[2] / 3;
    }
}

/// `-q ln q`.
fn weighted_log(q: f64) -> f64 {
    -q * q.ln()
}
