//! The coefficients of the matting Laplacian.

use imaging::{Plane, vectorized};

/// What is added to the covariance of each window, for colors in 0..=255.
const RIDGE: f64 = 1e-7 / 9.0 * 255.0 * 255.0;
/// Pixels around the picture that hold zeros: the reach of a coefficient.
pub(super) const RIM: usize = 2;
/// From a pixel to itself and to the later ones of its neighborhood: columns and rows.
pub(super) const STEPS: [(isize, usize); 13] = [
    (0, 0),
    (1, 0),
    (2, 0),
    (-2, 1),
    (-1, 1),
    (0, 1),
    (1, 1),
    (2, 1),
    (-2, 2),
    (-1, 2),
    (0, 2),
    (1, 2),
    (2, 2),
];

/// A symmetric matrix over the pixels of a picture that reaches two pixels far. Planes have a rim of zeros.
pub(super) struct Laplacian {
    pub(super) width: usize,
    pub(super) height: usize,
    /// For each of [`STEPS`] the coefficient of each pixel.
    coefficients: [Vec<f64>; STEPS.len()],
}

impl Laplacian {
    /// Of a picture of at least 3 × 3 pixels.
    pub(super) fn new(channels: &[Plane<u8>; 3]) -> Self {
        let (width, height) = channels[0].size();
        let mut laplacian = Self {
            width,
            height,
            coefficients: std::array::from_fn(|_| vec![0.0; (width + 2 * RIM) * (height + 2 * RIM)]),
        };
        for y in 1..height - 1 {
            for x in 1..width - 1 {
                let colors = std::array::from_fn(|i| {
                    [0, 1, 2].map(|c: usize| i32::from(channels[c].pixel(x + i % 3 - 1, y + i / 3 - 1)))
                });
                laplacian.add_window((x - 1, y - 1), &colors);
            }
        }
        laplacian
    }

    /// Columns of a plane with its rim.
    pub(super) fn stride(&self) -> usize {
        self.width + 2 * RIM
    }

    /// Position of a pixel in a plane with its rim.
    pub(super) fn position(&self, x: usize, y: usize) -> usize {
        (y + RIM) * self.stride() + x + RIM
    }

    /// The coefficients of a pixel, in the order of [`STEPS`].
    pub(super) fn of_pixel(&self, x: usize, y: usize) -> [f64; STEPS.len()] {
        let position = self.position(x, y);
        self.coefficients.each_ref().map(|plane| plane[position])
    }

    /// The main diagonal.
    pub(super) fn diagonal(&self) -> &[f64] {
        &self.coefficients[0]
    }

    /// Adds the window whose first pixel is given.
    fn add_window(&mut self, (x, y): (usize, usize), colors: &[[i32; 3]; 9]) {
        let sums = [0, 1, 2].map(|c| colors.iter().map(|color| color[c]).sum::<i32>());
        // Nine times the distance from the mean, exact.
        let away = colors.map(|color| [0, 1, 2].map(|c| f64::from(9 * color[c] - sums[c]) / 9.0));
        let covariance = |a: usize, b: usize| {
            let products: i32 = colors.iter().map(|color| color[a] * color[b]).sum();
            let ridge = if a == b { RIDGE } else { 0.0 };
            f64::from(9 * products - sums[a] * sums[b]) / 81.0 + ridge
        };
        let white = whitened(away, covariance);
        for i in 0..9 {
            let position = self.position(x + i % 3, y + i / 3);
            for j in i..9 {
                let (columns, rows) = ((j % 3) as isize - (i % 3) as isize, j / 3 - i / 3);
                let step = step_of(columns, rows);
                let product: f64 = (0..3).map(|c| white[i][c] * white[j][c]).sum();
                let own = if i == j { 1.0 } else { 0.0 };
                self.coefficients[step][position] += own - (1.0 + product) / 9.0;
            }
        }
    }

    /// `out = (L + λ E) x`, both with their rim; the rim of `x` is 0, and that of `out` stays as it is.
    pub(super) fn apply(&self, closeness: f64, x: &[f64], out: &mut [f64]) {
        vectorized!(apply(self, closeness, x, out));
    }
}

/// `C⁻¹ v` of each vector, `C Cᵀ` the covariance: their products are those with its inverse. Of colors along a line the adjugate
/// would lose the ridge to rounding, and the matrix would not stay positive.
fn whitened(vectors: [[f64; 3]; 9], covariance: impl Fn(usize, usize) -> f64) -> [[f64; 3]; 9] {
    let c11 = covariance(0, 0).sqrt();
    let (c21, c31) = (covariance(0, 1) / c11, covariance(0, 2) / c11);
    let c22 = (covariance(1, 1) - c21 * c21).sqrt();
    let c32 = (covariance(1, 2) - c31 * c21) / c22;
    let c33 = (covariance(2, 2) - c31 * c31 - c32 * c32).sqrt();
    vectors.map(|[r, g, b]| {
        let r = r / c11;
        let g = (g - c21 * r) / c22;
        [r, g, (b - c31 * r - c32 * g) / c33]
    })
}

/// Place in [`STEPS`].
fn step_of(columns: isize, rows: usize) -> usize {
    // The row of the pixel itself has no steps to the left.
    let first = if rows == 0 { 0 } else { 5 * rows };
    first.wrapping_add_signed(columns)
}

#[inline(always)]
fn apply(laplacian: &Laplacian, closeness: f64, x: &[f64], out: &mut [f64]) {
    let (width, stride) = (laplacian.width, laplacian.stride());
    for y in 0..laplacian.height {
        let row = laplacian.position(0, y);
        let out = &mut out[row..row + width];
        let (own, x_own) = (&laplacian.coefficients[0][row..row + width], &x[row..row + width]);
        for i in 0..width {
            out[i] = (own[i] + closeness) * x_own[i];
        }
        for (plane, (columns, rows)) in laplacian.coefficients.iter().zip(STEPS).skip(1) {
            let reach = rows as isize * stride as isize + columns;
            let (after, before) = (row.wrapping_add_signed(reach), row.wrapping_add_signed(-reach));
            let (to_after, x_after) = (&plane[row..row + width], &x[after..after + width]);
            let (to_before, x_before) = (&plane[before..before + width], &x[before..before + width]);
            for i in 0..width {
                out[i] += to_after[i] * x_after[i] + to_before[i] * x_before[i];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_stand_in_their_order() {
        for (place, (columns, rows)) in STEPS.into_iter().enumerate() {
            assert_eq!(step_of(columns, rows), place);
        }
    }

    #[test]
    fn rows_sum_to_nothing() {
        let channel = |seed: usize| Plane::from_fn(9, 7, |x, y| ((x * x * seed + 31 * y) % 251) as u8);
        let laplacian = Laplacian::new(&[channel(3), channel(5), channel(17)]);
        let mut ones = vec![0.0; laplacian.diagonal().len()];
        for y in 0..7 {
            for x in 0..9 {
                ones[laplacian.position(x, y)] = 1.0;
            }
        }
        let mut sums = vec![0.0; ones.len()];
        laplacian.apply(0.0, &ones, &mut sums);
        assert!(sums.iter().all(|sum| sum.abs() < 1e-9));
        assert!(laplacian.of_pixel(4, 3)[0] > 1.0);
    }
}
