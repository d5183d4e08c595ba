//! Variants that spread weighted copies of the light, each with one transfer function: `F = DCT⁻¹ Σ_k H_k DCT(w_k U)`.
//! They differ from the production variant only in the weights and the functions.

use imaging::Plane;
use imaging::dct::{Folding, PairDct};
use imaging::fft::Complex;
use optics::kernel::Transfer;

/// A copy: its transfer function on the grid of the frame, column-major, and its weight at a kernel scale.
pub(super) struct Copy {
    pub(super) transfer: Vec<f32>,
    pub(super) weight: Box<dyn Fn(f32) -> f32 + Sync>,
}

/// Spreads the light by all copies.
pub(super) fn spread(light: &Plane<f32>, gamma: &Plane<f32>, copies: &[Copy]) -> Plane<f32> {
    let (width, height) = light.size();
    let (mut transform, folding) = (PairDct::new(width, height), Folding::new(width, height));
    let [light, gamma] = [light, gamma].map(|plane| {
        let mut folded = vec![0.0; plane.data().len()];
        folding.fold(plane.data(), &mut folded);
        folded
    });
    let mut sum = vec![0.0f32; light.len()];
    for pair in copies.chunks(2) {
        let second = &pair.last().unwrap_or(&pair[0]).transfer;
        transform.forward(
            |place, row| {
                let start = place * width;
                let pixels = light[start..].iter().zip(&gamma[start..]);
                for (sample, (&u, &gamma)) in row.iter_mut().zip(pixels) {
                    let second = pair.get(1).map_or(0.0, |copy| (copy.weight)(gamma));
                    *sample = Complex::new(u * (pair[0].weight)(gamma), u * second);
                }
            },
            width,
            |p, column| {
                let start = p * height;
                let transfers = pair[0].transfer[start..].iter().zip(&second[start..]);
                for ((sum, value), (a, b)) in sum[start..].iter_mut().zip(column).zip(transfers) {
                    *sum += value.re * a + value.im * b;
                }
            },
        );
    }
    let mut plane = vec![0.0; sum.len()];
    transform.inverse(
        |p, column| {
            let column = column.iter_mut().zip(&sum[p * height..]);
            column.for_each(|(value, &sum)| *value = Complex::new(sum, 0.0));
        },
        width,
        |place, row| {
            let row_of_plane = &mut plane[folding.row(place) * width..][..width];
            folding.unfold_row(row, |value| value.re.max(0.0), row_of_plane);
        },
    );
    Plane::new(width, height, plane).expect("the size of the light")
}

/// Minimum logarithmic span of the layers. A wall has only one kernel scale.
const FLAT: f64 = 1e-3;

/// Kernel scales in a geometric progression.
fn ladder(least: f64, most: f64, steps: usize) -> Vec<f64> {
    (0..steps)
        .map(|k| least * (most / least).powf((k as f64 + 0.5) / steps as f64))
        .collect()
}

/// Each pixel has the kernel of its layer of range.
pub(super) fn hard_layers(least: f64, most: f64, steps: usize, size: (usize, usize)) -> Vec<Copy> {
    let span = (most / least).ln().max(FLAT);
    let layer = move |gamma: f32| {
        let share = (f64::from(gamma) / least).ln() / span;
        ((share * steps as f64) as usize).min(steps - 1)
    };
    let copy = |(k, scale): (usize, f64)| Copy {
        transfer: Transfer::new(scale).grid_f32(size.0, size.1),
        weight: Box::new(move |gamma| f32::from(u8::from(layer(gamma) == k))),
    };
    ladder(least, most, steps)
        .into_iter()
        .enumerate()
        .map(copy)
        .collect()
}

/// Each pixel interpolates between the kernels of the two nearest layers.
pub(super) fn linear_layers(least: f64, most: f64, steps: usize, size: (usize, usize)) -> Vec<Copy> {
    let span = (most / least).ln().max(FLAT) / (steps - 1) as f64;
    let copy = |k: usize| Copy {
        transfer: Transfer::new(least * (span * k as f64).exp()).grid_f32(size.0, size.1),
        weight: Box::new(move |gamma: f32| {
            let place = ((f64::from(gamma) / least).ln() / span).clamp(0.0, (steps - 1) as f64);
            (1.0 - (place - k as f64).abs()).max(0.0) as f32
        }),
    };
    (0..steps).map(copy).collect()
}

/// The kernel as a mixture of Gaussians of fixed widths, `e^{-2πγf} = ∫ e^{-2π²tf²} p(t; γ) dt` with Lévy's density
/// `p = γ/√(2π t³) e^{-γ²/2t}`: its heavy tail needs widths far beyond γ.
pub(super) fn gaussians(least: f64, most: f64, steps: usize, (width, height): (usize, usize)) -> Vec<Copy> {
    const NARROWEST: f64 = 0.35;
    let widest = (30.0 * most).min(2.0 * width.max(height) as f64);
    let widths = ladder(NARROWEST * least, widest, steps);
    let density = |sigma: f64, gamma: f64| gamma / sigma * (-0.5 * (gamma / sigma).powi(2)).exp();
    let copy = |sigma: f64| {
        let widths = widths.clone();
        Copy {
            transfer: gaussian(sigma, width, height),
            weight: Box::new(move |gamma: f32| {
                let gamma = f64::from(gamma);
                let total: f64 = widths.iter().map(|&w| density(w, gamma)).sum();
                (density(sigma, gamma) / total) as f32
            }),
        }
    };
    widths.iter().map(|&sigma| copy(sigma)).collect()
}

/// A Gaussian on the grid of the cosine transform, column-major.
fn gaussian(sigma: f64, width: usize, height: usize) -> Vec<f32> {
    let along = |n: usize, side: usize| {
        let f = n as f64 / (2 * side) as f64;
        (-2.0 * (std::f64::consts::PI * sigma * f).powi(2)).exp()
    };
    let rows: Vec<f64> = (0..height).map(|q| along(q, height)).collect();
    (0..width)
        .flat_map(|p| rows.iter().map(move |row| (along(p, width) * row) as f32))
        .collect()
}
