//! Spatial variants without a transform: a truncated kernel, and Gaussians window by window.

use std::collections::BTreeMap;

use imaging::Plane;
use optics::kernel;

/// The kernel of each pixel up to `radius` pixels, scaled to conserve light.
pub(super) fn truncated(light: &Plane<f32>, gamma: &Plane<f32>, radius: usize) -> Plane<f32> {
    let (width, height) = light.size();
    let side = 2 * radius + 1;
    let mut kernels: BTreeMap<u32, Vec<f32>> = BTreeMap::new();
    let (wide, tall) = (width + 2 * radius, height + 2 * radius);
    let mut paper = vec![0.0f32; wide * tall];
    for (index, (&u, &scale)) in light.data().iter().zip(gamma.data()).enumerate() {
        if u == 0.0 {
            continue;
        }
        let kernel = kernels
            .entry(scale.to_bits())
            .or_insert_with(|| cut(scale, radius));
        let (x, y) = (index % width, index / width);
        for (row, line) in kernel.chunks_exact(side).enumerate() {
            let start = (y + row) * wide + x;
            for (sum, k) in paper[start..start + side].iter_mut().zip(line) {
                *sum += u * k;
            }
        }
    }
    // Light outside the frame is mirrored back.
    let mut sum = Plane::filled(width, height, 0.0f32);
    for (row, line) in paper.chunks_exact(wide).enumerate() {
        let y = mirrored(row as i64 - radius as i64, height);
        for (column, value) in line.iter().enumerate() {
            let x = mirrored(column as i64 - radius as i64, width);
            sum.data_mut()[y * width + x] += value;
        }
    }
    sum
}

fn cut(scale: f32, radius: usize) -> Vec<f32> {
    let reach = radius as i64;
    let offsets = (-reach..=reach).flat_map(|j| (-reach..=reach).map(move |i| (i, j)));
    let kernel: Vec<f64> = offsets
        .map(|(i, j)| kernel::pixel(i, j, f64::from(scale)))
        .collect();
    let total: f64 = kernel.iter().sum();
    kernel.iter().map(|k| (k / total) as f32).collect()
}

fn mirrored(at: i64, side: usize) -> usize {
    let side = side as i64;
    let folded = at.rem_euclid(2 * side);
    folded.min(2 * side - 1 - folded) as usize
}

/// The method of published code: the frame in square windows, each blurred by the Gaussian of its mean scale, `sigma = factor γ`.
pub(super) fn windows(light: &Plane<f32>, gamma: &Plane<f32>, window: usize, factor: f32) -> Plane<f32> {
    let (width, height) = light.size();
    let mut blurred = Plane::filled(width, height, 0.0f32);
    for top in (0..height).step_by(window) {
        for left in (0..width).step_by(window) {
            let (right, bottom) = ((left + window).min(width), (top + window).min(height));
            let pixels = (top..bottom).flat_map(|y| (left..right).map(move |x| (x, y)));
            let mean = pixels.clone().map(|(x, y)| gamma.pixel(x, y)).sum::<f32>() / pixels.count() as f32;
            blur(light, (left, top, right, bottom), factor * mean, &mut blurred);
        }
    }
    blurred
}

/// A separable Gaussian truncated at three sigma, on one window.
fn blur(
    light: &Plane<f32>,
    (left, top, right, bottom): (usize, usize, usize, usize),
    sigma: f32,
    to: &mut Plane<f32>,
) {
    let (width, height) = light.size();
    let reach = (3.0 * sigma).ceil() as i64;
    let taps: Vec<f32> = (-reach..=reach)
        .map(|i| (-0.5 * (i as f32 / sigma.max(1e-3)).powi(2)).exp())
        .collect();
    let total: f32 = taps.iter().sum();
    let columns = right - left;
    let mut rows = vec![0.0f32; columns * taps.len().max(1) + columns * (bottom - top)];
    let lines = (bottom - top) + 2 * reach as usize;
    rows.resize(columns * lines, 0.0);
    for (line, row) in rows.chunks_exact_mut(columns).enumerate() {
        let y = mirrored(top as i64 + line as i64 - reach, height);
        for (x, value) in row.iter_mut().enumerate() {
            let center = (left + x) as i64;
            let taps = taps.iter().enumerate();
            *value = taps
                .map(|(i, tap)| tap * light.pixel(mirrored(center + i as i64 - reach, width), y))
                .sum::<f32>()
                / total;
        }
    }
    for y in top..bottom {
        for x in left..right {
            let taps = taps.iter().enumerate();
            let sum: f32 = taps
                .map(|(i, tap)| tap * rows[(y - top + i) * columns + x - left])
                .sum();
            to.data_mut()[y * width + x] = sum / total;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use optics::forward_scatter::scatter_reference;

    #[test]
    fn a_kernel_cut_far_out_is_the_kernel() {
        let light = Plane::from_fn(12, 9, |x, y| ((3 * x + 5 * y) % 7) as f32);
        let gamma = Plane::from_fn(12, 9, |x, _| if x < 6 { 0.3 } else { 0.6 });
        let exact = scatter_reference(&light.map(|&v| f64::from(v)), &gamma.map(|&v| f64::from(v)));
        let worst = |radius| {
            let cut = truncated(&light, &gamma, radius);
            let pairs = cut.data().iter().zip(exact.data());
            pairs.map(|(a, b)| (f64::from(*a) - b).abs()).fold(0.0, f64::max)
        };
        assert!(worst(60) < 0.03 && worst(60) < worst(8) && worst(8) < worst(2));
    }

    #[test]
    fn windows_keep_a_uniform_field() {
        let field = windows(&Plane::filled(20, 13, 0.5), &Plane::filled(20, 13, 2.0), 8, 1.5);
        assert!(field.data().iter().all(|v| (v - 0.5).abs() < 1e-6));
    }
}
