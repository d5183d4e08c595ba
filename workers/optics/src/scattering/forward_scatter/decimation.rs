//! Rows of a plane on a coarser grid, for kernels that are some rows wide.
//!
//! A coarse row is a weighted sum of rows around its position. The weights are a spline of [`ORDER`] boxes, one coarse row wide each:
//! their response is `w(x) = sinc(x)^ORDER`, x in cycles per coarse row. It is 0 at all whole x, which the coarse grid aliases to
//! x = 0, so all light is kept. The cosine transform of the coarse rows, divided by w, equals the transform of the plane, except for
//! frequencies above x = ½ and aliases of order `(x / (1 − x))^ORDER`. A kernel of γ suppresses both: the error is below
//! [`aliasing`] of the light. Coarse rows need not be a whole number of rows apart.

use std::f64::consts::{PI, TAU};

use imaging::dct::Folding;
use imaging::fft::Complex;
use imaging::vectorized;
use std::ops::Range;

/// Number of convolved boxes. The mirror at the sides of the frame needs an odd number.
const ORDER: usize = 7;
/// Numbers of coarse rows: lengths of fast transforms.
const COUNTS: [usize; 15] = [
    16, 24, 32, 48, 64, 96, 128, 192, 256, 384, 512, 768, 1024, 1536, 2048,
];
/// More coarse rows than this share of the rows cost more than they save.
const MOST_SHARE: f64 = 0.8;
/// The largest sum of absolute errors in units of [`worst_alias`].
const ALIASING: f64 = 10.0;

/// Error of coarse rows that a part of the light may have.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Coarseness {
    /// The largest error for light of 1; 0 means all rows.
    pub limit: f64,
    /// Subtracted from γ, for light that passes a gate.
    pub origin: f64,
}

impl Coarseness {
    /// The fewest coarse rows for a kernel of `gamma_px` in a frame of `height` rows; `None` if it needs all rows.
    pub(crate) fn rows(self, gamma_px: f64, height: usize) -> Option<usize> {
        let most = MOST_SHARE * height as f64;
        let counts = COUNTS.iter().copied().take_while(|&count| count as f64 <= most);
        let ratio = |count: usize| (gamma_px - self.origin) * count as f64 / height as f64;
        counts
            .into_iter()
            .find(|&count| ratio(count) > 0.0 && aliasing(ratio(count)) <= self.limit)
    }
}

/// Bound of the error that coarse rows add to the sum of a kernel over light up to 1. `ratio` is the scale of the kernel in coarse
/// rows.
pub(crate) fn aliasing(ratio: f64) -> f64 {
    ALIASING * worst_alias(ratio)
}

/// The largest `(x / (1 − x))^ORDER exp(−2π ratio x)` for x up to ½.
fn worst_alias(ratio: f64) -> f64 {
    let order = ORDER as f64;
    let x = match 1.0 - 4.0 * order / (TAU * ratio) {
        beyond if beyond > 0.0 => (1.0 - beyond.sqrt()) / 2.0,
        _ => 0.5,
    };
    (x / (1.0 - x)).powi(ORDER as i32) * (-TAU * ratio * x).exp()
}

/// Weighted sums of the rows of a plane.
pub(super) struct Decimation {
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
    /// `coarse` rows for `height` rows, which stay as they are if there are as many.
    pub(super) fn new(height: usize, coarse: usize) -> Self {
        if coarse == height {
            return Self::identity(height);
        }
        let mut places = vec![0; coarse];
        let folding = Folding::new(1, coarse);
        (0..coarse).for_each(|place| places[folding.row(place)] = place);
        let folding = Folding::new(1, height);
        let rows = (0..height).map(|place| shares(folding.row(place), height, &places));
        let response = (0..coarse).map(|q| sinc(q as f64 / (2 * coarse) as f64).powi(ORDER as i32) as f32);
        Self {
            height,
            rows: rows.collect(),
            response: response.collect(),
        }
    }

    fn identity(height: usize) -> Self {
        Self {
            height,
            rows: (0..height)
                .map(|place| vec![Share { place, weight: 1.0 }])
                .collect(),
            response: vec![1.0; height],
        }
    }

    /// How many coarse rows.
    pub(super) fn coarse_height(&self) -> usize {
        self.response.len()
    }

    /// Rows from one coarse row to the next.
    pub(super) fn step(&self) -> f64 {
        self.height as f64 / self.coarse_height() as f64
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

/// The spline of [`ORDER`] boxes of width 1 around 0: `Σ_i (−1)^i C(n, i) max(0, u + n/2 − i)^{n−1} / (n−1)!`.
fn spline(u: f64) -> f64 {
    let (mut sum, mut term) = (0.0, 1.0);
    for i in 0..=ORDER {
        let beyond = -u.abs() + ORDER as f64 / 2.0 - i as f64;
        sum += term * beyond.max(0.0).powi(ORDER as i32 - 1);
        term *= -((ORDER - i) as f64) / (i + 1) as f64;
    }
    sum / (1..ORDER).map(|i| i as f64).product::<f64>()
}

/// Shares of row `y` in the coarse rows. The frame is a mirror box.
fn shares(y: usize, height: usize, places: &[usize]) -> Vec<Share> {
    let count = places.len() as i64;
    let position = (y as f64 + 0.5) * count as f64 / height as f64 - 0.5;
    let mut weights = vec![0.0; places.len()];
    let reach = ORDER as f64 / 2.0;
    for j in (position - reach).ceil() as i64..=(position + reach).floor() as i64 {
        let mirrored = j.rem_euclid(2 * count);
        let mirrored = mirrored.min(2 * count - 1 - mirrored);
        weights[mirrored as usize] += spline(position - j as f64);
    }
    let pairs = weights.into_iter().zip(places);
    pairs
        .filter(|(weight, _)| *weight > 0.0)
        .map(|(weight, &place)| Share {
            place,
            weight: weight as f32,
        })
        .collect()
}

fn sinc(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { (PI * x).sin() / (PI * x) }
}

pub(super) fn line(index: usize, length: usize) -> Range<usize> {
    index * length..(index + 1) * length
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel::Transfer;
    use imaging::dct::Dct2;

    const WIDTH: usize = 96;

    /// Sum of the absolute errors of the light of one pixel in row `y`, spread by a kernel.
    fn error_sum(gamma: f64, height: usize, count: usize, y: usize) -> f64 {
        let decimation = Decimation::new(height, count);
        let mut coarse = vec![Complex::default(); count];
        let folding = Folding::new(1, height);
        let place = (0..height).find(|&place| folding.row(place) == y).unwrap();
        decimation.add_row(place, &[Complex::new(1.0, 0.0)], &mut coarse);
        let coarse_folding = Folding::new(1, count);
        let cosine =
            |q: usize, y: usize, height: usize| (PI * q as f64 * (y as f64 + 0.5) / height as f64).cos();
        let transfer = Transfer::new(gamma).grid(WIDTH, height);
        let mut errors = vec![0.0; WIDTH * height];
        for (q, errors) in errors.chunks_exact_mut(WIDTH).enumerate() {
            let waves = coarse.iter().enumerate();
            let waves =
                waves.map(|(place, value)| f64::from(value.re) * cosine(q, coarse_folding.row(place), count));
            let response = decimation.response().get(q);
            let found = response.map_or(0.0, |&response| waves.sum::<f64>() / f64::from(response));
            for (p, error) in errors.iter_mut().enumerate() {
                let light = cosine(p, WIDTH / 3, WIDTH);
                *error = transfer[q * WIDTH + p] * light * (found - cosine(q, y, height));
            }
        }
        Dct2::new(WIDTH, height).inverse(&mut errors);
        errors.iter().map(|error| error.abs()).sum()
    }

    /// Rounding of f32 weights and sums, for light of 1.
    const ROUNDING: f64 = 3e-7;

    #[test]
    fn the_error_of_coarse_rows_is_within_its_bound_at_every_row() {
        let mut largest = 0.0f64;
        for (count, height) in [(16, 32), (24, 33), (24, 82), (16, 96), (48, 62)] {
            for ratio in [0.5, 1.0, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 4.5, 5.0, 6.0, 7.5] {
                let gamma = ratio * height as f64 / count as f64;
                for y in [0, 1, 2, 3, 5, 7, height / 2, height / 2 + 1, height - 1] {
                    let (error, bound) = (error_sum(gamma, height, count, y), aliasing(ratio));
                    assert!(
                        error <= bound + ROUNDING,
                        "{count} of {height} rows, γ {gamma}, row {y}: {error:e} of {bound:e}"
                    );
                    largest = largest.max(error / bound);
                }
            }
        }
        assert!(largest > 0.5, "the bound is too wide: {largest}");
    }

    #[test]
    fn a_row_has_one_unit_of_light_at_any_position() {
        for (count, height) in [(16, 33), (24, 82), (48, 61), (3, 5)] {
            for row in Decimation::new(height, count).rows {
                let sum: f32 = row.iter().map(|share| share.weight).sum();
                assert!((sum - 1.0).abs() < 1e-6, "{count} of {height} rows: {sum}");
            }
        }
    }

    #[test]
    fn wider_kernels_need_fewer_rows_and_narrow_ones_all() {
        let coarse = Coarseness {
            limit: 1e-4,
            origin: 0.0,
        };
        let rows = [0.0, 2.0, 9.0, 18.0, 40.0].map(|gamma| coarse.rows(gamma, 492));
        assert!(
            rows[..2] == [None; 2] && rows[2..].is_sorted_by(|a, b| a > b),
            "{rows:?}"
        );
        let beyond = Coarseness {
            origin: 9.0,
            ..coarse
        };
        assert_eq!([beyond.rows(9.0, 492), beyond.rows(18.0, 492)], [None, rows[2]]);
        assert_eq!(Coarseness::default().rows(1e3, 492), None);
    }
}
