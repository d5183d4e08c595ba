//! The slow method in f64: the exact kernel of every pixel, without interpolation.
//!
//! Pixels of one kernel scale are transformed together, which is exact, so a frame costs one transform for each distinct
//! scale. That is minutes for a small frame of continuous range; the size is limited.

use std::collections::BTreeMap;

use imaging::Plane;
use imaging::dct::Dct2;

use crate::kernel::Transfer;

/// Largest frame of the reference: with a different range in every pixel it runs for some minutes.
pub const MAX_REFERENCE_PIXELS: usize = 1 << 16;

/// `F(x) = Σ_y U(y) K(x, y; γ(y))`.
///
/// # Panics
/// When the planes differ in size.
#[must_use]
pub fn scatter_reference(source: &Plane<f64>, gamma: &Plane<f64>) -> Plane<f64> {
    scatter_with(Transfer::new, source, gamma)
}

/// The same for light that passes gates.
#[must_use]
pub(crate) fn scatter_behind_gates(source: &Plane<f64>, gamma: &Plane<f64>) -> Plane<f64> {
    scatter_with(Transfer::behind_gates, source, gamma)
}

fn scatter_with(transfer_of: fn(f64) -> Transfer, source: &Plane<f64>, gamma: &Plane<f64>) -> Plane<f64> {
    assert_eq!(
        source.size(),
        gamma.size(),
        "light and kernel scale belong to one frame"
    );
    let (width, height) = source.size();
    let mut transform = Dct2::new(width, height);
    let mut sum = vec![0.0; source.data().len()];
    for (scale, pixels) in groups(gamma) {
        if pixels.iter().all(|&index| source.data()[index] == 0.0) {
            continue;
        }
        let mut work = vec![0.0; sum.len()];
        pixels
            .iter()
            .for_each(|&index| work[index] = source.data()[index]);
        transform.forward(&mut work);
        let transfer = transfer_of(scale).grid(width, height);
        for ((sum, sample), h) in sum.iter_mut().zip(&work).zip(&transfer) {
            *sum += sample * h;
        }
    }
    transform.inverse(&mut sum);
    plane(width, height, sum)
}

/// `F(x) = Σ_y K(x, y; γ(x)) I(y)`.
///
/// # Panics
/// When the planes differ in size.
#[must_use]
pub fn gather_reference(image: &Plane<f64>, gamma: &Plane<f64>) -> Plane<f64> {
    assert_eq!(
        image.size(),
        gamma.size(),
        "light and kernel scale belong to one frame"
    );
    let (width, height) = image.size();
    let mut transform = Dct2::new(width, height);
    let mut spectrum = image.data().to_vec();
    transform.forward(&mut spectrum);
    let mut collected = vec![0.0; spectrum.len()];
    for (scale, pixels) in groups(gamma) {
        let transfer = Transfer::new(scale).grid(width, height);
        let mut work: Vec<f64> = spectrum
            .iter()
            .zip(&transfer)
            .map(|(value, h)| value * h)
            .collect();
        transform.inverse(&mut work);
        pixels.iter().for_each(|&index| collected[index] = work[index]);
    }
    plane(width, height, collected)
}

/// Pixels by their kernel scale.
fn groups(gamma: &Plane<f64>) -> Vec<(f64, Vec<usize>)> {
    let mut groups: BTreeMap<u64, Vec<usize>> = BTreeMap::new();
    for (index, gamma) in gamma.data().iter().enumerate() {
        groups.entry(gamma.to_bits()).or_default().push(index);
    }
    groups
        .into_iter()
        .map(|(bits, pixels)| (f64::from_bits(bits), pixels))
        .collect()
}

fn plane(width: usize, height: usize, data: Vec<f64>) -> Plane<f64> {
    Plane::new(width, height, data).expect("the size of the source")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernel;
    use imaging::random::Stream;

    /// The definition in space: the kernel at every mirror image of the source within a radius. Light from beyond it is spread
    /// evenly over the frame.
    fn direct_sum(source: &Plane<f64>, gamma: &Plane<f64>) -> Plane<f64> {
        let (width, height) = (source.width() as i64, source.height() as i64);
        let images = 40i64;
        let mut sum = Plane::filled(source.width(), source.height(), 0.0);
        for y in 0..source.height() {
            for x in 0..source.width() {
                let (light, scale) = (source.pixel(x, y), gamma.pixel(x, y));
                let mut arrived = Plane::filled(source.width(), source.height(), 0.0);
                for v in -images..=images {
                    for u in -images..=images {
                        let mirror = |at: i64, side: i64, image: i64| {
                            image * side + if image % 2 == 0 { at } else { side - 1 - at }
                        };
                        let (sx, sy) = (mirror(x as i64, width, u), mirror(y as i64, height, v));
                        for ty in 0..height {
                            for tx in 0..width {
                                arrived.data_mut()[(ty * width + tx) as usize] +=
                                    kernel::pixel(tx - sx, ty - sy, scale);
                            }
                        }
                    }
                }
                let rest = (1.0 - arrived.data().iter().sum::<f64>()) / (width * height) as f64;
                for (sum, share) in sum.data_mut().iter_mut().zip(arrived.data()) {
                    *sum += light * (share + rest);
                }
            }
        }
        sum
    }

    #[test]
    fn the_transform_agrees_with_the_sum_over_mirror_images() {
        let stream = Stream::stage(1, "scatter");
        let source = Plane::from_fn(6, 5, |x, y| stream.unit(x as u64, y as u64));
        let gamma = Plane::from_fn(6, 5, |x, y| [0.1, 0.6, 2.5][(x + 2 * y) % 3]);
        let (fast, slow) = (scatter_reference(&source, &gamma), direct_sum(&source, &gamma));
        let worst = fast
            .data()
            .iter()
            .zip(slow.data())
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f64::max);
        // The light beyond 40 images is not quite even: γ (side/R)² of it remains.
        assert!(worst < 2e-5, "{worst}");
    }

    #[test]
    fn scatter_keeps_all_light_and_gather_keeps_a_uniform_field() {
        let stream = Stream::stage(2, "scatter");
        let gamma = Plane::from_fn(13, 7, |x, y| 5.0 * stream.unit(x as u64, y as u64));
        let source = Plane::from_fn(13, 7, |x, y| stream.unit(y as u64, x as u64));
        let spread = scatter_reference(&source, &gamma);
        assert!((spread.data().iter().sum::<f64>() - source.data().iter().sum::<f64>()).abs() < 1e-6);
        let uniform = gather_reference(&Plane::filled(13, 7, 0.5), &gamma);
        assert!(uniform.data().iter().all(|v| (v - 0.5).abs() < 1e-8));
    }

    #[test]
    fn scatter_and_gather_are_adjoint() {
        let stream = Stream::stage(3, "scatter");
        let plane = |e: u64| Plane::from_fn(11, 9, |x, y| stream.unit((9 * x + y) as u64, e));
        let (u, v, gamma) = (plane(0), plane(1), plane(2).map(|g| 3.0 * g));
        let dot =
            |a: &Plane<f64>, b: &Plane<f64>| a.data().iter().zip(b.data()).map(|(a, b)| a * b).sum::<f64>();
        let (left, right) = (
            dot(&scatter_reference(&u, &gamma), &v),
            dot(&u, &gather_reference(&v, &gamma)),
        );
        assert!((left - right).abs() < 1e-10 * left.abs());
    }
}
