//! Low-pass of a plane with gaps: a Gaussian as three box averages along each axis (Wells 1986).

use imaging::{Plane, cancel};

/// The standard deviation is the longer side over this: half of a wave of 12 periods along it passes.
const SIDES_PER_SIGMA: f64 = 64.0;
const PASSES: usize = 3;

/// Replaces each value by the mean of the known ones around it with Gaussian weights, truncated at the border. NaN is
/// unknown; where all values around are unknown, the result is NaN.
pub(crate) fn smooth(plane: &Plane<f32>) -> Plane<f32> {
    let sigma = plane.width().max(plane.height()) as f64 / SIDES_PER_SIGMA;
    // Three boxes of 2 r + 1 pixels have the variance ((2 r + 1)² - 1) / 4.
    let radius = ((4.0 * sigma * sigma + 1.0).sqrt() / 2.0 - 0.5).round() as usize;
    let mut values = plane.map(|value| if value.is_nan() { 0.0 } else { *value });
    let mut weights = plane.map(|value| f32::from(u8::from(!value.is_nan())));
    for averaged in [&mut values, &mut weights] {
        for _ in 0..PASSES {
            average_rows(averaged, radius);
            average_columns(averaged, radius);
        }
    }
    for (value, weight) in values.data_mut().iter_mut().zip(weights.data()) {
        *value = if *weight > LEAST_WEIGHT {
            *value / weight
        } else {
            f32::NAN
        };
    }
    values
}

/// Weights below are rounding of the running sums.
const LEAST_WEIGHT: f32 = 1e-6;

/// Averages over windows of `2 radius + 1` pixels, with 0 outside of the plane.
fn average_rows(plane: &mut Plane<f32>, radius: usize) {
    let (width, height) = plane.size();
    let scale = 1.0 / (2 * radius + 1) as f64;
    // Sums of all values before a column.
    let mut sums = vec![0.0f64; width + 1];
    for y in 0..height {
        cancel::check();
        let row = plane.row_mut(y);
        for x in 0..width {
            sums[x + 1] = sums[x] + f64::from(row[x]);
        }
        for (x, value) in row.iter_mut().enumerate() {
            let (start, end) = (x.saturating_sub(radius), (x + radius + 1).min(width));
            *value = ((sums[end] - sums[start]) * scale) as f32;
        }
    }
}

fn average_columns(plane: &mut Plane<f32>, radius: usize) {
    let (width, height) = plane.size();
    let scale = 1.0 / (2 * radius + 1) as f64;
    let source = plane.clone();
    let mut sums = vec![0.0f64; width];
    for y in 0..radius.min(height) {
        add_row(&mut sums, source.row(y), 1.0);
    }
    for y in 0..height {
        cancel::check();
        if y + radius < height {
            add_row(&mut sums, source.row(y + radius), 1.0);
        }
        if y > radius {
            add_row(&mut sums, source.row(y - radius - 1), -1.0);
        }
        for (value, sum) in plane.row_mut(y).iter_mut().zip(&sums) {
            *value = (sum * scale) as f32;
        }
    }
}

fn add_row(sums: &mut [f64], row: &[f32], sign: f64) {
    for (sum, &value) in sums.iter_mut().zip(row) {
        *sum += sign * f64::from(value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One percent of the contrast: three boxes differ from the Gaussian, most where the border truncates each of them.
    const TOLERANCE: f64 = 0.04;

    /// Normalized convolution with the Gaussian at one pixel.
    fn smooth_by_definition(plane: &Plane<f32>, x: usize, y: usize) -> f64 {
        let sigma = plane.width().max(plane.height()) as f64 / SIDES_PER_SIGMA;
        let (mut sum, mut total) = (0.0, 0.0);
        for j in 0..plane.height() {
            for i in 0..plane.width() {
                let value = f64::from(plane.pixel(i, j));
                let square = (i as f64 - x as f64).powi(2) + (j as f64 - y as f64).powi(2);
                let weight = (-0.5 * square / (sigma * sigma)).exp();
                if !value.is_nan() {
                    sum += weight * value;
                    total += weight;
                }
            }
        }
        sum / total
    }

    #[test]
    fn boxes_agree_with_the_gaussian() {
        // At this width the boxes of seven pixels have exactly the variance of the Gaussian.
        let lamp = Plane::from_fn(222, 64, |x, y| {
            let (u, v) = ((x as f32 - 60.0) / 50.0, (y as f32 - 20.0) / 40.0);
            if (90..94).contains(&x) && y > 30 {
                f32::NAN
            } else {
                4.0 / (1.0 + u * u + v * v)
            }
        });
        let smoothed = smooth(&lamp);
        for y in (0..64).step_by(7) {
            for x in (0..222).step_by(7) {
                let difference = f64::from(smoothed.pixel(x, y)) - smooth_by_definition(&lamp, x, y);
                assert!(difference.abs() < TOLERANCE, "{x} {y}: {difference}");
            }
        }
    }

    #[test]
    fn constants_stay_and_gaps_without_neighbors_remain() {
        let plane = Plane::from_fn(256, 4, |x, _| if x > 30 { f32::NAN } else { 2.5 });
        let smoothed = smooth(&plane);
        assert!((smoothed.pixel(0, 0) - 2.5).abs() < 1e-5);
        assert!((smoothed.pixel(31, 3) - 2.5).abs() < 1e-5);
        assert!(smoothed.pixel(200, 2).is_nan());
        assert_eq!(smooth(&Plane::filled(1, 1, 3.0)), Plane::filled(1, 1, 3.0));
    }
}
