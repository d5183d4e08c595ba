//! PoissonTable of Poisson's sums: F at the middle of every row of means, and a guide to the smallest k.

use std::sync::LazyLock;

use crate::sensor::model::POISSON_SWITCH;

/// Rows of the table for an electron.
pub(super) const ROWS_PER_E: usize = 4;
pub(super) const ROWS: usize = POISSON_SWITCH as usize * ROWS_PER_E;
/// Intervals of u.
pub(super) const PARTS: usize = 128;
/// Values of F in a row. Larger k have u in the last interval, which is summed.
pub(super) const COUNTS: usize = 64;
/// Values of F that separate three k.
pub(super) const WINDOW: usize = 4;
/// f32 rounding of u, the table and three products, each at most 1: about 1e-6. Also covers the rounding of f64 sums.
pub(super) const ROUNDING: f32 = 4e-6;
pub(super) struct PoissonTable {
    /// Start in `sums` of the window for a row and an interval of u.
    pub(super) starts: Vec<u16>,
    /// 0, 0, F(0), F(1), … of each row; then a window of NaN, which leaves every pixel open.
    pub(super) sums: Vec<f32>,
}

pub(super) static TABLE: LazyLock<PoissonTable> = LazyLock::new(table);

fn table() -> PoissonTable {
    let mut table = PoissonTable {
        starts: Vec::with_capacity(ROWS * PARTS),
        sums: Vec::with_capacity(ROWS * COUNTS + WINDOW),
    };
    for row in 0..ROWS {
        let [low, middle, high] =
            [0.0, 0.5, 1.0].map(|part| cumulative((row as f64 + part) / ROWS_PER_E as f64));
        for part in 0..PARTS {
            let least = least([&low, &high], part);
            let start = least.map_or(ROWS * COUNTS, |least| row * COUNTS + least);
            table.starts.push(start as u16);
        }
        table.sums.extend([0.0; 2]);
        table
            .sums
            .extend(middle[..COUNTS - 2].iter().map(|&sum| sum as f32));
    }
    table.sums.extend([f32::NAN; WINDOW]);
    table
}

/// The smallest k of an interval of u, from F at the edges of a row; `None` if k may be outside of a window.
fn least([at_low, at_high]: [&[f64; COUNTS]; 2], part: usize) -> Option<usize> {
    let [from, to] = [part, part + 1].map(|edge| edge as f64 / PARTS as f64);
    // F falls with the mean, so that k is smallest at the lower edge.
    let least = at_low.iter().position(|&sum| sum > from - f64::from(ROUNDING))?;
    let most = at_high.iter().position(|&sum| sum > to + f64::from(ROUNDING))?;
    (most <= least + 2 && least + WINDOW <= COUNTS).then_some(least)
}

/// F of 0, 1, ….
fn cumulative(mean: f64) -> [f64; COUNTS] {
    let (mut probability, mut sum) = (libm::exp(-mean), 0.0);
    std::array::from_fn(|k| {
        sum += probability;
        probability *= mean / (k + 1) as f64;
        sum
    })
}
