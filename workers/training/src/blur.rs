//! Gaussian blur of short reach, continued by the edge.

use imaging::vectorized;

use crate::tensor::Tensor;

/// Blurs all channels; `sigma` in pixels, nothing happens below 0.1.
pub(crate) fn gaussian(picture: &mut Tensor<f32>, sigma: f64) {
    if sigma < 0.1 {
        return;
    }
    let reach = (3.0 * sigma).ceil() as usize;
    let mut weights: Vec<f32> = (0..=2 * reach)
        .map(|at| {
            let away = (at as f64 - reach as f64) / sigma;
            libm::exp(-0.5 * away * away) as f32
        })
        .collect();
    let sum: f32 = weights.iter().sum();
    weights.iter_mut().for_each(|weight| *weight /= sum);
    let (width, height) = (picture.width, picture.height);
    for channel in 0..picture.channels {
        let plane = picture.plane_mut(channel);
        let mut across = vec![0.0f32; plane.len()];
        let mut line = vec![0.0f32; width + 2 * reach];
        for (row, out) in plane.chunks_exact(width).zip(across.chunks_exact_mut(width)) {
            line[..reach].fill(row[0]);
            line[reach..reach + width].copy_from_slice(row);
            line[reach + width..].fill(row[width - 1]);
            vectorized!({
                for (at, &weight) in weights.iter().enumerate() {
                    add_scaled(out, &line[at..at + width], weight);
                }
            });
        }
        for (y, out) in plane.chunks_exact_mut(width).enumerate() {
            out.fill(0.0);
            vectorized!({
                for (at, &weight) in weights.iter().enumerate() {
                    let row = (y + at).saturating_sub(reach).min(height - 1);
                    add_scaled(out, &across[row * width..(row + 1) * width], weight);
                }
            });
        }
    }
}

#[inline(always)]
fn add_scaled(sums: &mut [f32], values: &[f32], factor: f32) {
    for (sum, &value) in sums.iter_mut().zip(values) {
        *sum += value * factor;
    }
}
