//! Cloudy noise: random values on grids, one finer than the other, smoothly joined.

use imaging::random::Stream;

/// Noise of mean 0 and variance 1, row by row: octave k has `cells * 2^k` cells across and amplitude `2^(-1.2 k)`.
/// Deterministic in (seed, name).
pub(crate) fn clouds(
    seed: u64,
    name: &str,
    (width, height): (usize, usize),
    cells: f64,
    octaves: u64,
) -> Vec<f32> {
    let stream = Stream::stage(seed, name);
    let mut sums = vec![0.0f64; width * height];
    for octave in 0..octaves {
        let cell = width as f64 / (cells * (1u64 << octave) as f64);
        let amplitude = libm::exp2(-1.2 * octave as f64);
        let columns = (width as f64 / cell) as usize + 2;
        let rows = (height as f64 / cell) as usize + 2;
        let grid: Vec<f64> = (0..(columns * rows) as u64)
            .map(|at| stream.unit(octave, at) - 0.5)
            .collect();
        for y in 0..height {
            let (row, v) = split(y as f64 / cell);
            let (upper, lower) = (&grid[row * columns..], &grid[(row + 1) * columns..]);
            for x in 0..width {
                let (column, u) = split(x as f64 / cell);
                let above = upper[column] + (upper[column + 1] - upper[column]) * u;
                let below = lower[column] + (lower[column + 1] - lower[column]) * u;
                sums[y * width + x] += amplitude * (above + (below - above) * v);
            }
        }
    }
    let count = sums.len().max(1) as f64;
    let mean = sums.iter().sum::<f64>() / count;
    let variance = sums.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / count;
    let scale = 1.0 / variance.sqrt().max(1e-9);
    sums.into_iter().map(|v| ((v - mean) * scale) as f32).collect()
}

/// Cell and smooth place in it.
fn split(place: f64) -> (usize, f64) {
    let cell = place.floor();
    let inside = place - cell;
    (cell as usize, inside * inside * (3.0 - 2.0 * inside))
}
