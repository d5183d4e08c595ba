//! The network by definition, in f64: the reference for the fast variant and for the trained files.

use imaging::{Plane, Rgb};

use super::layer::{
    BLOCKS, COLOR, ENTER, LEAVE, Layer, OUTPUT, PIXEL, RANGE_COLOR, RANGE_PIXEL, REDUCE, Weights,
};

type PlaneList = Vec<Plane<f64>>;

/// Repaints a picture; empty ones stay empty. Slow, and of unlimited size. `range` is that of the picture's pixels, 0
/// at the camera and 1 far away; absent, all pixels are at the camera. A network without a range input ignores it.
#[must_use]
pub fn apply_reference(weights: &Weights<f64>, encoded: &Rgb<f64>, range: Option<&Plane<f64>>) -> Rgb<f64> {
    let (width, height) = encoded.size();
    if width == 0 || height == 0 {
        return encoded.clone();
    }
    let image: PlaneList = encoded.planes().to_vec();
    let quarter = relu(convolved(weights, ENTER, &pooled(&image), 1));
    let mut context = relu(convolved(weights, REDUCE, &quarter, 2));
    for [spread_a, mix_a, spread_b, mix_b] in BLOCKS {
        let first = convolved(weights, mix_a, &convolved(weights, spread_a, &context, 1), 1);
        let second = convolved(weights, spread_b, &relu(first), 1);
        context = sum(context, &convolved(weights, mix_b, &second, 1));
    }
    let left = convolved(weights, LEAVE, &context, 1);
    let resized: PlaneList = left.iter().map(|plane| resize(plane, width, height)).collect();
    let mut features = sum(convolved(weights, PIXEL, &image, 1), &resized);
    let mut toned = convolved(weights, COLOR, &image, 1);
    if weights.takes_range() {
        let ranged = ranged(&image, range);
        features = sum(features, &convolved(weights, RANGE_PIXEL, &ranged, 1));
        toned = sum(toned, &convolved(weights, RANGE_COLOR, &ranged, 1));
    }
    let styled = sum(toned, &convolved(weights, OUTPUT, &relu(features), 1));
    Rgb::from_fn(width, height, |x, y| {
        [0, 1, 2].map(|channel| styled[channel].pixel(x, y).clamp(0.0, 1.0))
    })
}

/// The colors times their range, and the range.
fn ranged(image: &[Plane<f64>], range: Option<&Plane<f64>>) -> PlaneList {
    let (width, height) = image[0].size();
    let range = range.map_or_else(
        || Plane::filled(width, height, 0.0),
        |range| Plane::from_fn(width, height, |x, y| range.pixel(x, y)),
    );
    let colors = image
        .iter()
        .map(|plane| Plane::from_fn(width, height, |x, y| plane.pixel(x, y) * range.pixel(x, y)));
    let mut ranged: PlaneList = colors.collect();
    ranged.push(range);
    ranged
}

fn relu(planes: PlaneList) -> PlaneList {
    planes
        .iter()
        .map(|plane| plane.map(|&value| value.max(0.0)))
        .collect()
}

fn sum(planes: PlaneList, other: &[Plane<f64>]) -> PlaneList {
    let pairs = planes.into_iter().zip(other);
    pairs
        .map(|(mut sum, other)| {
            for (a, b) in sum.data_mut().iter_mut().zip(other.data()) {
                *a += b;
            }
            sum
        })
        .collect()
}

/// Means of 4×4 pixels, clipped at the right and lower edge.
fn pooled(image: &[Plane<f64>]) -> PlaneList {
    let pooled = image.iter().map(|plane| {
        let (width, height) = plane.size();
        Plane::from_fn(width.div_ceil(4), height.div_ceil(4), |x, y| {
            let rows = 4 * y..(4 * y + 4).min(height);
            let columns = 4 * x..(4 * x + 4).min(width);
            let count = rows.len() * columns.len();
            let sum: f64 = rows
                .flat_map(|v| columns.clone().map(move |u| plane.pixel(u, v)))
                .sum();
            sum / count as f64
        })
    });
    pooled.collect()
}

/// A convolution that extends the picture by its edge.
fn convolved(weights: &Weights<f64>, layer: Layer, input: &[Plane<f64>], step: usize) -> PlaneList {
    let (width, height) = input[0].size();
    let (weight, bias) = (weights.weight(layer), weights.bias(layer));
    let reach = layer.side / 2;
    let outputs = (0..layer.outputs).map(|output| {
        Plane::from_fn(width.div_ceil(step), height.div_ceil(step), |x, y| {
            let mut sum = bias[output];
            for index in 0..layer.inputs {
                let plane = &input[if layer.inputs == 1 { output } else { index }];
                for row in 0..layer.side {
                    for column in 0..layer.side {
                        let v = (y * step + row).saturating_sub(reach).min(height - 1);
                        let u = (x * step + column).saturating_sub(reach).min(width - 1);
                        let position =
                            ((output * layer.inputs + index) * layer.side + row) * layer.side + column;
                        sum += weight[position] * plane.pixel(u, v);
                    }
                }
            }
            sum
        })
    });
    outputs.collect()
}

/// Bilinear, pixel centers at half integers, clamped to the edge.
fn resize(plane: &Plane<f64>, width: usize, height: usize) -> Plane<f64> {
    Plane::from_fn(width, height, |x, y| {
        let (left, right, u) = locate(x, width, plane.width());
        let (upper, lower, v) = locate(y, height, plane.height());
        let [upper, lower] =
            [upper, lower].map(|y| plane.pixel(left, y) * (1.0 - u) + plane.pixel(right, y) * u);
        upper * (1.0 - v) + lower * v
    })
}

/// The neighbors of output sample `i` among the inputs, and the weight of the second.
fn locate(i: usize, outputs: usize, inputs: usize) -> (usize, usize, f64) {
    let place = ((i as f64 + 0.5) * inputs as f64 / outputs as f64 - 0.5).clamp(0.0, (inputs - 1) as f64);
    let low = place.floor();
    (low as usize, (low as usize + 1).min(inputs - 1), place - low)
}
