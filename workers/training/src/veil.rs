//! Estimates the range order of a photo's pixels from the veil: distant parts have the color of the open water.
//!
//! The veil's color `V(y) = a + b y` is fitted over the flattest windows of the photo; light from above makes it
//! brighter at the top. The arriving light of a surface deviates from it by at most `(J − V) exp(−c Z)`, so the largest
//! deviation around a pixel falls with its range: `1 − deviation / largest deviation of the photo` rises with the
//! range. Only the order of the values is used, since neither the scale of the range nor the colors J of a photo are
//! known.

use crate::loss::pyramid::Pyramid;
use crate::tensor::Tensor;

/// Pyramid level in use: means of 4×4 pixels.
const LEVEL: usize = 2;
/// Half width of a window, in samples of that level.
const REACH: usize = 4;
/// Share of the windows that count as open water: the flattest.
const OPEN: f64 = 0.15;

/// The estimate for every pixel, one channel: 0 at the largest deviation from the veil, 1 at the veil.
pub(crate) fn estimate(photo: &Pyramid<f32>) -> Tensor<f32> {
    let picture = &photo.levels[LEVEL];
    let deviation = deviation(picture, &fitted(picture, &flattest(picture)));
    let largest = fold_windows(&deviation, (picture.width, picture.height), f64::max);
    let smooth = fold_windows(&largest, (picture.width, picture.height), |a, b| a + b);
    let most = smooth.iter().fold(1e-9f64, |most, &value| most.max(value));
    let full = &photo.levels[0];
    let mut out = Tensor::zeros(1, full.height, full.width);
    for y in 0..full.height {
        let row = (y >> LEVEL).min(picture.height - 1) * picture.width;
        for (x, value) in out.row_mut(0, y).iter_mut().enumerate() {
            let column = (x >> LEVEL).min(picture.width - 1);
            *value = (1.0 - smooth[row + column] / most) as f32;
        }
    }
    out
}

/// The positions of the flattest windows.
fn flattest(picture: &Tensor<f32>) -> Vec<usize> {
    let size = (picture.width, picture.height);
    let mut spread = vec![0.0; picture.width * picture.height];
    for channel in 0..3 {
        let samples: Vec<f64> = picture.plane(channel).iter().map(|&v| f64::from(v)).collect();
        let squares: Vec<f64> = samples.iter().map(|v| v * v).collect();
        let ones = vec![1.0; samples.len()];
        let [sums, squares, counts] =
            [&samples, &squares, &ones].map(|plane| fold_windows(plane, size, |a, b| a + b));
        for (at, spread) in spread.iter_mut().enumerate() {
            let mean = sums[at] / counts[at];
            *spread += squares[at] / counts[at] - mean * mean;
        }
    }
    let mut order: Vec<usize> = (0..spread.len()).collect();
    order.sort_by(|&a, &b| spread[a].total_cmp(&spread[b]));
    order.truncate(((spread.len() as f64 * OPEN) as usize).max(2));
    order
}

/// Offset and slope over the rows of each channel, by least squares over some positions.
fn fitted(picture: &Tensor<f32>, places: &[usize]) -> [[f64; 2]; 3] {
    let count = places.len() as f64;
    let rows = places.iter().map(|place| (place / picture.width) as f64);
    let middle = rows.clone().sum::<f64>() / count;
    let width = rows.clone().map(|row| (row - middle).powi(2)).sum::<f64>();
    [0, 1, 2].map(|channel| {
        let values = places
            .iter()
            .map(|&place| f64::from(picture.plane(channel)[place]));
        let mean = values.clone().sum::<f64>() / count;
        let product: f64 = rows
            .clone()
            .zip(values)
            .map(|(row, value)| (row - middle) * value)
            .sum();
        let slope = product / (width + 1.0);
        [mean - slope * middle, slope]
    })
}

/// The largest deviation of a channel from the veil, for every sample.
fn deviation(picture: &Tensor<f32>, veil: &[[f64; 2]; 3]) -> Vec<f64> {
    let samples = (0..picture.width * picture.height).map(|i| {
        let row = (i / picture.width) as f64;
        let [red, green, blue] = [0, 1, 2].map(|channel: usize| {
            let [offset, slope] = veil[channel];
            (f64::from(picture.plane(channel)[i]) - offset - slope * row).abs()
        });
        red.max(green).max(blue)
    });
    samples.collect()
}

/// Folds the window around every sample by `both`, along rows and then along columns.
fn fold_windows(
    samples: &[f64],
    (width, height): (usize, usize),
    both: impl Fn(f64, f64) -> f64,
) -> Vec<f64> {
    let rows = LineSet {
        step: 1,
        length: width,
        stride: width,
        count: height,
    };
    let columns = LineSet {
        step: width,
        length: height,
        stride: 1,
        count: width,
    };
    columns.fold(&rows.fold(samples, &both), &both)
}

/// Rows or columns of a plane.
struct LineSet {
    /// Distance between neighbors on a line.
    step: usize,
    length: usize,
    /// Distance between the starts of lines.
    stride: usize,
    count: usize,
}

impl LineSet {
    fn fold(&self, samples: &[f64], both: &impl Fn(f64, f64) -> f64) -> Vec<f64> {
        let mut out = samples.to_vec();
        for line in 0..self.count {
            let start = line * self.stride;
            for i in 0..self.length {
                let window = i.saturating_sub(REACH)..(i + REACH + 1).min(self.length);
                let first = samples[start + window.start * self.step];
                let rest = window.skip(1).map(|i| samples[start + i * self.step]);
                out[start + i * self.step] = rest.fold(first, both);
            }
        }
        out
    }
}
