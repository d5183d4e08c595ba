//! UISM, sharpness: contrast of edges, channel by channel (Panetta, Gao and Agaian 2016, eq. 5-6).
//!
//! With the edge strength `E = c · sqrt(gx² + gy²)` of a channel with codes c and Sobel derivatives gx, gy, `EME = 2 /
//! (k1 k2) Σ ln(max E / min E)` over blocks of 10 × 10; a block with smallest strength 0 adds 0. `UISM = 0.299 EME_R +
//! 0.587 EME_G + 0.114 EME_B`.
//!
//! `funie` weights blue by 0.144, a transposition of its program. `table1` uses blocks of 4 × 4 and only the vertical
//! derivative, clipped at 255; it rescales each channel to codes, within a mask by the extremes of its blocks, and a block
//! with a 0 then adds 1.

use imaging::simd::{larger, smaller};
use imaging::{Plane, vectorized};

use crate::blocks::BlockGrid;
use crate::sobel::{Border, Sobel};
use crate::work::{ChannelPlanes, MetricInput, SharedPart};

const BLOCK_PX: usize = 10;
const TABLE1_BLOCK_PX: usize = 4;

/// UISM of the article.
pub(crate) fn panetta(work: &MetricInput) -> f64 {
    let Sharpness([r, g, b]) = *work.part();
    0.299 * r + 0.587 * g + 0.114 * b
}

/// UISM with more blue.
pub(crate) fn funie(work: &MetricInput) -> f64 {
    let Sharpness([r, g, b]) = *work.part();
    0.299 * r + 0.587 * g + 0.144 * b
}

/// UISM of vertical derivatives in small blocks.
pub(crate) fn table1(work: &MetricInput) -> f64 {
    let channels = work.part::<ChannelPlanes>();
    let [r, g, b] = channels
        .0
        .each_ref()
        .map(|channel| vectorized!(vertical(channel, work.mask())));
    0.299 * r + 0.587 * g + 0.114 * b
}

/// EME of the three channels.
struct Sharpness([f64; 3]);

impl SharedPart for Sharpness {
    fn new(work: &MetricInput) -> Self {
        let channels = work.part::<ChannelPlanes>();
        let mask = work.mask();
        Self(
            channels
                .0
                .each_ref()
                .map(|channel| vectorized!(eme(channel, mask))),
        )
    }
}

#[inline(always)]
fn eme(channel: &Plane<u8>, mask: Option<&Plane<u8>>) -> f64 {
    let blocks = BlockGrid::new(channel.size(), BLOCK_PX);
    let mut sobel = Sobel::new(channel, Border::Replicate);
    let (mut gx, mut gy) = (vec![0i16; channel.width()], vec![0i16; channel.width()]);
    // E² is an integer below 2^38: f64 holds it, and the order of the extremes is that of E.
    let extremes = blocks.extremes(1, |y, row: &mut [f64]| {
        let count = row.len();
        sobel.row(y, &mut gx[..count], &mut gy[..count]);
        for (((square, &gx), &gy), &code) in row.iter_mut().zip(&gx).zip(&gy).zip(channel.row(y)) {
            let (gx, gy, code) = (i32::from(gx), i32::from(gy), i32::from(code));
            *square = f64::from(gx * gx + gy * gy) * f64::from(code * code);
        }
    });
    let extremes = blocks.keep_inside(extremes, mask);
    let sum: f64 = extremes
        .iter()
        .filter(|(low, _)| *low > 0.0)
        .map(|(low, high)| 0.5 * (high / low).ln())
        .sum();
    2.0 / extremes.len().max(1) as f64 * sum
}

/// EME of vertical derivatives, rescaled to codes.
#[inline(always)]
fn vertical(channel: &Plane<u8>, mask: Option<&Plane<u8>>) -> f64 {
    let (width, height) = channel.size();
    let blocks = BlockGrid::new((width, height), TABLE1_BLOCK_PX);
    let mut sobel = Sobel::new(channel, Border::Reflect);
    let (mut gx, mut gy) = (vec![0i16; width], vec![0i16; width]);
    let mut strength = vec![0.0f64; width];
    // The extremes outside the blocks; those of the blocks are known.
    let (mut least, mut greatest) = (f64::INFINITY, 0.0f64);
    let mut measure_row = |y: usize, row: &mut [f64]| {
        sobel.row(y, &mut gx, &mut gy);
        // Ties of the rounding below depend on this order of the products.
        for ((strength, &gy), &code) in strength.iter_mut().zip(&gy).zip(channel.row(y)) {
            let cut = i32::from(gy).abs().min(255);
            *strength = f64::from(code) * (std::f64::consts::SQRT_2 * f64::from(cut));
        }
        let (inside, beside) = strength.split_at(row.len());
        row.copy_from_slice(inside);
        for &value in beside {
            least = smaller(value, least);
            greatest = larger(value, greatest);
        }
    };
    let extremes = blocks.extremes(1, &mut measure_row);
    for y in blocks.rows()..height {
        measure_row(y, &mut []);
    }
    if mask.is_some() {
        (least, greatest) = (f64::INFINITY, 0.0);
    }
    let extremes = blocks.keep_inside(extremes, mask);
    for &(low, high) in &extremes {
        least = least.min(low);
        greatest = greatest.max(high);
    }
    let spread = greatest - least;
    // Rescaling keeps the order, so only the extremes of the blocks need it.
    let code = |value: f64| {
        if spread > 0.0 {
            (value * 255.0 / spread - least)
                .round_ties_even()
                .clamp(0.0, 255.0)
        } else {
            0.0
        }
    };
    let sum: f64 = extremes
        .iter()
        .map(|&(low, high)| {
            let (low, high) = (code(low), code(high));
            if low > 0.0 { (high / low).ln() } else { 1.0 }
        })
        .sum();
    2.0 / extremes.len().max(1) as f64 * sum
}
