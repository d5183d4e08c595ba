//! Arriving electrons for means below [`super::POISSON_SWITCH`]: the smallest k with `u < F(k; μ)`, `F(k; μ) = Σ e^{-μ}
//! μ^i / i!` over `i ≤ k`, summed upward in f64.
//!
//! Most pixels need no sum. A table holds F at the middle c of every quarter of an electron, from which `F(k; c + d) =
//! F(k) - d p(k) + d²/2 (p(k) - p(k-1)) + e` with `p(k) = F(k) - F(k-1)` and `|e| ≤ |d|³/6 · 2`, because `dF(k)/dμ =
//! -p(k)`, `dp(k)/dμ = p(k-1) - p(k)` and every p is at most 1. A guide maps each interval of u to the smallest
//! possible k. If u is closer to a step than the error, or k is not among the next three, the sum is computed: k always
//! equals that of the sum.

mod table;

use imaging::vectorized;

use table::{COUNTS, PARTS, PoissonTable, ROUNDING, ROWS_PER_E, TABLE, WINDOW};

use super::model::MOST_COUNTED;
use super::noise::BLOCK;
use crate::elementary::{exponential_of_minus, whole};

/// Pixels that are summed together.
const LANES: usize = 8;

/// Counts the electrons of a block of pixels, with its look-up buffers.
pub(super) struct Counter {
    /// Row and interval of u of each pixel.
    cells: [u16; BLOCK],
    /// The mean minus that of the row.
    d: [f32; BLOCK],
    starts: [u16; BLOCK],
    windows: [[f32; WINDOW]; BLOCK],
    /// Whether the sum must decide.
    is_open: [bool; BLOCK],
}

impl Default for Counter {
    fn default() -> Self {
        Self {
            cells: [0; BLOCK],
            d: [0.0; BLOCK],
            starts: [0; BLOCK],
            windows: [[0.0; WINDOW]; BLOCK],
            is_open: [false; BLOCK],
        }
    }
}

impl Counter {
    /// Replaces means below [`super::POISSON_SWITCH`] by arriving electrons, from uniform numbers in 0..1.
    ///
    /// # Panics
    /// For more than [`BLOCK`] pixels.
    pub(super) fn count(&mut self, electrons: &mut [f64], units: &[f64]) {
        let mut means = [0.0; BLOCK];
        let means = &mut means[..electrons.len()];
        means.copy_from_slice(electrons);
        vectorized!(place(means, units, &mut self.cells, &mut self.d));
        self.look_up(&TABLE, means.len());
        vectorized!(decide(&mut *electrons, units, self));
        let mut open = [0; BLOCK];
        let many = listed(&self.is_open[..means.len()], &mut open);
        vectorized!(sum(&mut *electrons, means, units, &open[..many]));
    }

    fn look_up(&mut self, table: &PoissonTable, length: usize) {
        let cells = self.cells[..length].iter();
        for ((&cell, start), window) in cells.zip(&mut self.starts).zip(&mut self.windows) {
            *start = table.starts[usize::from(cell)];
            let origin = usize::from(*start);
            window.copy_from_slice(&table.sums[origin..origin + WINDOW]);
        }
    }
}

#[inline(always)]
fn place(means: &[f64], units: &[f64], cells: &mut [u16; BLOCK], d: &mut [f32; BLOCK]) {
    let places = cells.iter_mut().zip(d);
    for ((&mean, &unit), (cell, d)) in means.iter().zip(units).zip(places) {
        let scaled = mean * ROWS_PER_E as f64;
        let row = scaled.floor();
        let part = (unit * PARTS as f64).floor();
        *cell = whole(row * PARTS as f64 + part) as u16;
        *d = ((scaled - (row + 0.5)) * (1.0 / ROWS_PER_E as f64)) as f32;
    }
}

#[inline(always)]
fn decide(electrons: &mut [f64], units: &[f64], counter: &mut Counter) {
    let looked_up = counter.starts.iter().zip(&counter.windows).zip(&counter.d);
    let pixels = electrons.iter_mut().zip(&mut counter.is_open).zip(units);
    for (((electrons, is_open), &unit), ((&start, window), &d)) in pixels.zip(looked_up) {
        let curved = 0.5 * d * d;
        let (own, before) = (1.0 - d + curved, d - 2.0 * curved);
        let first = unit as f32 - (own * window[2] + before * window[1] + curved * window[0]);
        let second = unit as f32 - (own * window[3] + before * window[2] + curved * window[1]);
        let error = d.abs() * curved * (2.0 / 3.0) + ROUNDING;
        let k = (start as usize % COUNTS) as u32 + u32::from(first >= 0.0) + u32::from(second >= 0.0);
        *electrons = f64::from(k);
        // Negated, so that NaN stays open.
        *is_open = !((first.abs() > error) & (second.abs() > error));
    }
}

/// Lists the open pixels and returns their number.
fn listed(is_open: &[bool], list: &mut [u8; BLOCK]) -> usize {
    let mut many = 0;
    for (pixel, &is_open) in is_open.iter().enumerate() {
        // Branch-free, since the outcome is unpredictable.
        list[many] = pixel as u8;
        many += usize::from(is_open);
    }
    many
}

/// Counts some pixels by the sum.
#[inline(always)]
fn sum(electrons: &mut [f64], means: &[f64], units: &[f64], pixels: &[u8]) {
    for pixels in pixels.chunks(LANES) {
        // Lanes without a pixel stop immediately.
        let (mut mean, mut unit) = ([0.0; LANES], [-1.0; LANES]);
        for (lane, &pixel) in pixels.iter().enumerate() {
            let pixel = usize::from(pixel);
            (mean[lane], unit[lane]) = (means[pixel], units[pixel]);
        }
        let found = sum_lanes(&mean, &unit);
        for (&pixel, found) in pixels.iter().zip(found) {
            electrons[usize::from(pixel)] = found;
        }
    }
}

#[inline(always)]
fn sum_lanes(mean: &[f64; LANES], unit: &[f64; LANES]) -> [f64; LANES] {
    let mut probability = mean.map(exponential_of_minus);
    let (mut sum, mut found) = ([0.0; LANES], [0.0; LANES]);
    for k in 1..=MOST_COUNTED {
        let per_k = 1.0 / k as f64;
        let mut open = 0.0;
        for lane in 0..LANES {
            sum[lane] += probability[lane];
            let more = if unit[lane] >= sum[lane] { 1.0 } else { 0.0 };
            found[lane] += more;
            open += more;
            probability[lane] *= mean[lane] * per_k;
        }
        if open == 0.0 {
            break;
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::super::reference::counted;
    use super::table::ROWS;
    use super::*;
    use crate::sensor::model::POISSON_SWITCH;

    /// The definition with the exponential of the fast variant, so that every bit must agree.
    fn summed(mean: f64, unit: f64) -> f64 {
        let (mut probability, mut sum) = (exponential_of_minus(mean), 0.0);
        for k in 0..MOST_COUNTED {
            sum += probability;
            if unit < sum {
                return k as f64;
            }
            probability *= mean * (1.0 / (k + 1) as f64);
        }
        MOST_COUNTED as f64
    }

    fn counts(mean: f64, units: &[f64]) -> Vec<f64> {
        let mut counter = Counter::default();
        let mut electrons = vec![mean; units.len()];
        let blocks = electrons.chunks_mut(BLOCK).zip(units.chunks(BLOCK));
        blocks.for_each(|(electrons, units)| counter.count(electrons, units));
        electrons
    }

    /// Both sides of every edge of the table, values next to 0 and to the switch, and some between.
    fn means() -> Vec<f64> {
        let edges = (0..=2 * ROWS).map(|half| half as f64 / (2 * ROWS_PER_E) as f64);
        let beside = edges.flat_map(|edge| [edge.next_down().max(0.0), edge, edge.next_up()]);
        let extreme = [0.0, f64::MIN_POSITIVE, 1e-300, 1e-16, POISSON_SWITCH.next_down()];
        let between = (0..300).map(|i| 0.1003 * f64::from(i));
        let all = beside.chain(extreme).chain(between);
        all.filter(|&mean| mean < POISSON_SWITCH).collect()
    }

    /// Both sides of every step of F and of every interval of u, and the extreme draws.
    fn units(mean: f64) -> Vec<f64> {
        let (mut probability, mut sum) = (exponential_of_minus(mean), 0.0);
        let steps = (1..=MOST_COUNTED).map(|k| {
            sum += probability;
            probability *= mean * (1.0 / k as f64);
            sum
        });
        let parts = (0..PARTS).map(|part| part as f64 / PARTS as f64);
        let edges: Vec<f64> = steps.chain(parts).collect();
        let near = [0.0, 1e-15, 1e-7, 4e-6, 1e-5, 1e-4, 1e-3];
        let beside = edges.iter().flat_map(|edge| {
            let near = near.into_iter().flat_map(move |d| [edge - d, edge + d]);
            near.chain([edge.next_down(), edge.next_up()])
        });
        let least = f64::EPSILON / 2.0;
        let all = beside.chain([0.0, least, 1.0 - least]);
        all.filter(|unit| (0.0..1.0).contains(unit)).collect()
    }

    #[test]
    fn counts_are_those_of_the_sum_to_the_bit() {
        for mean in means() {
            let units = units(mean);
            for (&unit, count) in units.iter().zip(counts(mean, &units)) {
                assert_eq!(count, summed(mean, unit), "{mean:e} {unit:e}");
            }
        }
    }

    #[test]
    fn counts_are_those_of_the_reference() {
        let units: Vec<f64> = (0..1000).map(|i| (f64::from(i) + 0.37) * 1e-3).collect();
        for mean in means() {
            for (&unit, count) in units.iter().zip(counts(mean, &units)) {
                assert_eq!(count, counted(mean, unit), "{mean:e} {unit}");
            }
        }
    }

    #[test]
    fn the_table_decides_most_pixels() {
        let counter = &mut Counter::default();
        let (mut open, mut all) = (0, 0);
        for mean in (0..300).map(|i| 0.1 * f64::from(i) + 0.05) {
            let units: [f64; BLOCK] = std::array::from_fn(|i| (i as f64 + 0.5) / BLOCK as f64);
            counter.count(&mut [mean; BLOCK], &units);
            open += counter.is_open.iter().filter(|&&is_open| is_open).count();
            all += BLOCK;
        }
        assert!(20 * open < all, "{open} of {all}");
    }
}
