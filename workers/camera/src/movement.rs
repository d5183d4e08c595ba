//! Error bounds of means over movement. The pictures of a path are averaged with a weight each; an uploaded picture is
//! the mean of its copies along a line. Weights are not negative and sum to 1: the gain of both is 1.

use crate::rounding;

/// Largest f32 error of a weighted mean of pictures, added one by one. No sample is larger than `peak` in magnitude.
#[must_use]
pub fn average_bound(pictures: usize, peak: f64) -> f64 {
    // The weight, its product and a sum for each picture.
    rounding::absolute(pictures as f64 + 2.0, peak)
}

/// Number of copies of a picture that moves by this many columns and rows: at most a pixel apart.
#[must_use]
pub fn copies([across, down]: [f64; 2]) -> usize {
    across.hypot(down).ceil() as usize + 1
}

/// Largest f32 error of the mean of a picture's bilinear copies, added one by one and divided by their number. No
/// sample is negative or larger than `peak`. A single copy is the picture itself.
#[must_use]
pub fn shift_bound(shift_px: [f64; 2], peak: f64) -> f64 {
    match copies(shift_px) {
        1 => 0.0,
        // Seven for a bilinear sample, one for each sum, one for the quotient.
        copies => rounding::absolute(copies as f64 + 8.0, peak),
    }
}

#[cfg(test)]
mod tests {
    use imaging::random::Stream;

    use super::*;

    #[test]
    fn means_err_by_no_more_than_their_bound() {
        let stream = Stream::stage(6, "means");
        for pictures in [1, 2, 3, 8, 64] {
            let weight = 1.0 / pictures as f64;
            let mut nearest = 0.0f64;
            for case in 0..2000 {
                let light = |k: usize| (1.0 - 1e-3 * stream.unit(case, k as u64)) as f32;
                let mean: f32 = (0..pictures).fold(0.0, |sum, k| sum + weight as f32 * light(k));
                let exact: f64 = (0..pictures).map(|k| weight * f64::from(light(k))).sum();
                let error = (f64::from(mean) - exact).abs();
                nearest = nearest.max(error / average_bound(pictures, 1.0));
            }
            assert!(nearest <= 1.0, "{pictures}: {nearest}");
        }
    }

    #[test]
    fn a_shifted_sample_errs_by_no_more_than_its_bound() {
        let stream = Stream::stage(7, "shifts");
        for shift in [[0.4, 0.0], [3.0, -1.5], [64.0, 64.0]] {
            let copies = copies(shift);
            for case in 0..2000 {
                let (mut sum, mut exact) = (0.0f32, 0.0f64);
                for copy in 0..copies {
                    let unit = |element: usize| stream.unit(case, (6 * copy + element) as u64);
                    let [x, y] = [unit(4), unit(5)];
                    // Full-range steps, the hardest samples.
                    let sample = |k: usize| unit(k).round();
                    let [a, b, c, d] = [0, 1, 2, 3].map(|k| sample(k) as f32);
                    let [upper, lower] = [a + (b - a) * x as f32, c + (d - c) * x as f32];
                    sum += upper + (lower - upper) * y as f32;
                    let [a, b, c, d] = [0, 1, 2, 3].map(sample);
                    exact += (a + (b - a) * x) * (1.0 - y) + (c + (d - c) * x) * y;
                }
                let (sum, exact) = (sum / copies as f32, exact / copies as f64);
                let bound = shift_bound(shift, 1.0);
                assert!((f64::from(sum) - exact).abs() <= bound, "{copies} copies");
            }
        }
        assert_eq!(shift_bound([0.0, 0.0], 1.0), 0.0);
    }
}
