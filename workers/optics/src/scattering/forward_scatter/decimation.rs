//! Rows of a plane on a coarser grid, for kernels that are many rows wide.
//!
//! A coarse row is a weighted sum of rows around its position. The weights are a box of `step` rows, convolved with itself [`ORDER`]
//! times: their response `w(f) = (sin(π s f) / (s sin(π f)))^ORDER` is 0 at the multiples of 1/s, which the coarse grid aliases to
//! f = 0. The cosine transform of the coarse rows, divided by w, equals the transform of the plane, except for aliases of order `(s
//! f)^ORDER`. A kernel of γ rows suppresses frequencies above 1/γ, so the error is below [`aliasing`] of the light.

use std::f64::consts::PI;

use imaging::dct::Folding;
use imaging::fft::Complex;
use imaging::vectorized;
use std::ops::Range;

/// Number of convolved boxes. The mirror at the sides of the frame needs an odd number.
const ORDER: usize = 7;
/// Widest step, rows.
const MOST_STEP: usize = 8;
/// The least scale of a kernel in steps.
const LEAST_RATIO: f64 = 5.0;
/// The largest sum of absolute errors of a kernel of [`LEAST_RATIO`] steps is 1.3e-6; that of wider ones falls faster than the power
/// [`ORDER`] of their scale.
const ALIASING: f64 = 1.5e-6;

/// Steps that divide both sides of a frame and are small enough for a kernel of `gamma_px`, the largest first. The last is 1.
pub(crate) fn steps(gamma_px: f64, (width, height): (usize, usize)) -> impl Iterator<Item = usize> {
    let divides = move |step: usize| width.is_multiple_of(step) && height.is_multiple_of(step);
    let fits = move |step: usize| step == 1 || gamma_px >= LEAST_RATIO * step as f64;
    (1..=MOST_STEP)
        .rev()
        .filter(move |&step| divides(step) && fits(step))
}

/// Bound of the error that coarse rows add to the sum of a kernel of `gamma_px` over light up to 1.
pub(crate) fn aliasing(gamma_px: f64, step: usize) -> f64 {
    if step <= 1 {
        return 0.0;
    }
    ALIASING * (LEAST_RATIO * step as f64 / gamma_px).powi(ORDER as i32)
}

/// Sums of rows of one height.
pub(super) struct Decimation {
    pub(super) step: usize,
    pub(super) height: usize,
    /// Coarse rows that each row contributes to, by its position in folded order.
    rows: Vec<Vec<Share>>,
    /// w at the frequencies of the coarse rows.
    response: Vec<f32>,
}

/// Share of a row in a coarse row.
#[derive(Clone, Copy)]
struct Share {
    /// The coarse row in folded order.
    place: usize,
    weight: f32,
}

impl Decimation {
    /// `height` is a multiple of `step`.
    pub(super) fn new(height: usize, step: usize) -> Self {
        let (coarse, taps) = (height / step, taps(step));
        let mut of_row = vec![Vec::new(); coarse];
        let folding = Folding::new(1, coarse);
        (0..coarse).for_each(|place| of_row[folding.row(place)].push(place));
        let folding = Folding::new(1, height);
        let rows = (0..height).map(|place| shares(folding.row(place), &taps, step, &of_row));
        let response = (0..coarse).map(|q| response(q as f64 / (2 * height) as f64, step) as f32);
        Self {
            step,
            height,
            rows: rows.collect(),
            response: response.collect(),
        }
    }

    /// How many coarse rows.
    pub(super) fn coarse_height(&self) -> usize {
        self.response.len()
    }

    /// w at the frequencies of the coarse rows.
    pub(super) fn response(&self) -> &[f32] {
        &self.response
    }

    /// Adds the row at a position in folded order to the coarse rows.
    pub(super) fn add_row(&self, place: usize, row: &[Complex<f32>], coarse: &mut [Complex<f32>]) {
        for Share { place, weight } in &self.rows[place] {
            let to = &mut coarse[line(*place, row.len())];
            let weight = *weight;
            vectorized!(add_scaled(to, row, weight));
        }
    }

    /// The row at a position in folded order, interpolated between the coarse rows.
    pub(super) fn row_between(&self, place: usize, coarse: &[Complex<f32>], row: &mut [Complex<f32>]) {
        row.fill(Complex::default());
        for Share { place, weight } in &self.rows[place] {
            let from = &coarse[line(*place, row.len())];
            let weight = *weight;
            vectorized!(add_scaled(row, from, weight));
        }
    }
}

#[inline(always)]
fn add_scaled(to: &mut [Complex<f32>], from: &[Complex<f32>], factor: f32) {
    for (to, from) in to.iter_mut().zip(from) {
        to.re += factor * from.re;
        to.im += factor * from.im;
    }
}

/// Weights of the rows around a coarse one; their sum is `step`.
fn taps(step: usize) -> Vec<f64> {
    let mut taps = vec![step as f64];
    for _ in 0..ORDER {
        let mut wider = vec![0.0; taps.len() + step - 1];
        for (at, tap) in taps.iter().enumerate() {
            for to in &mut wider[at..at + step] {
                *to += tap / step as f64;
            }
        }
        taps = wider;
    }
    taps
}

/// Shares of row `y` in the coarse rows. The frame is a mirror box.
fn shares(y: usize, taps: &[f64], step: usize, places: &[Vec<usize>]) -> Vec<Share> {
    let (coarse, step) = (places.len() as i64, step as i64);
    // The first row of coarse row j is `step j - before`.
    let before = (ORDER as i64 - 1) / 2 * (step - 1);
    let last = (y as i64 + before).div_euclid(step);
    let mut weights = vec![0.0; places.len()];
    for j in (last - taps.len() as i64 / step - 1)..=last {
        let tap = y as i64 + before - step * j;
        let mirrored = j.rem_euclid(2 * coarse);
        let mirrored = mirrored.min(2 * coarse - 1 - mirrored);
        weights[mirrored as usize] += taps.get(tap as usize).copied().unwrap_or(0.0);
    }
    let pairs = weights
        .into_iter()
        .zip(places)
        .filter(|(weight, _)| *weight > 0.0);
    pairs
        .flat_map(|(weight, places)| {
            places.iter().map(move |&place| Share {
                place,
                weight: weight as f32,
            })
        })
        .collect()
}

fn response(frequency: f64, step: usize) -> f64 {
    if frequency == 0.0 {
        return 1.0;
    }
    let box_response = (PI * step as f64 * frequency).sin() / (step as f64 * (PI * frequency).sin());
    box_response.powi(ORDER as i32)
}

pub(super) fn line(index: usize, length: usize) -> Range<usize> {
    index * length..(index + 1) * length
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Sum of the absolute errors of one row's light, spread across rows by a kernel with the spectrum `exp(−2πγf)`.
    fn error_sum(gamma: f64, height: usize, step: usize, y: usize) -> f64 {
        let decimation = Decimation::new(height, step);
        let mut coarse = vec![Complex::default(); decimation.coarse_height()];
        let folding = Folding::new(1, height);
        let place = (0..height).find(|&place| folding.row(place) == y).unwrap();
        decimation.add_row(place, &[Complex::new(1.0, 0.0)], &mut coarse);
        let coarse_folding = Folding::new(1, coarse.len());
        let cosine =
            |q: usize, y: usize, height: usize| (PI * q as f64 * (y as f64 + 0.5) / height as f64).cos();
        let errors = (0..height).map(|q| {
            let frequency = q as f64 / (2 * height) as f64;
            let waves = coarse.iter().enumerate().map(|(place, value)| {
                f64::from(value.re) * cosine(q, coarse_folding.row(place), coarse.len())
            });
            let found = match decimation.response().get(q) {
                Some(&response) => waves.sum::<f64>() / f64::from(response),
                None => 0.0,
            };
            (-2.0 * PI * gamma * frequency).exp() * (found - cosine(q, y, height))
        });
        let errors: Vec<f64> = errors.collect();
        let error = |y: usize| {
            let terms = errors.iter().enumerate();
            let weight = |q: usize| if q == 0 { 1.0 } else { 2.0 };
            terms
                .map(|(q, e)| weight(q) * e * cosine(q, y, height))
                .sum::<f64>()
                / height as f64
        };
        (0..height).map(|y| error(y).abs()).sum()
    }

    /// Rounding of f32 weights and sums, for light of 1.
    const ROUNDING: f64 = 2e-7;

    #[test]
    fn the_error_of_coarse_rows_is_within_its_bound_at_every_row() {
        let mut largest = 0.0f64;
        for (step, ratio) in [
            (2, 5.0),
            (2, 6.0),
            (2, 9.0),
            (3, 5.0),
            (4, 5.0),
            (4, 7.0),
            (8, 5.0),
        ] {
            let (gamma, height) = (ratio * step as f64, 48 * step);
            for y in [0, 1, 2, 3, 5, 7, height / 2, height / 2 + 1, height - 1] {
                let (error, bound) = (error_sum(gamma, height, step, y), aliasing(gamma, step));
                assert!(
                    error <= bound + ROUNDING,
                    "step {step}, γ {gamma}, row {y}: {error:e} of {bound:e}"
                );
                largest = largest.max(error / bound);
            }
        }
        assert!(largest > 0.5, "the bound is too wide: {largest}");
    }

    #[test]
    fn steps_divide_the_frame_and_are_small_beside_the_kernel() {
        assert_eq!(steps(21.0, (768, 492)).collect::<Vec<_>>(), [4, 3, 2, 1]);
        assert_eq!(steps(14.0, (768, 492)).collect::<Vec<_>>(), [2, 1]);
        assert_eq!(steps(50.0, (37, 20)).collect::<Vec<_>>(), [1]);
        assert_eq!(steps(0.0, (768, 492)).collect::<Vec<_>>(), [1]);
    }
}
