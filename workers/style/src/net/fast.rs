//! The network in one pass over the frame: at full resolution only the last three rows of the features are stored.

mod across;
mod context;
mod multiply;
mod packed;
mod planes;

use imaging::{Plane, Rgb, cancel};
use pulp::{Simd, WithSimd};

use across::{Widened, place};
use context::Context;
use multiply::{SumBlock, load, multiply, multiply_row, splat, store};
use packed::Packed;
use planes::{close_row, stride};

use super::layer::{COLOR, OUTPUT, PIXEL, RANGE_COLOR, RANGE_PIXEL, Weights};

/// Vectors per block of features: with four of its eight outputs, eight sums.
const PIXEL_VECTORS: usize = 2;
/// Vectors per block of the result: with its three outputs, nine sums.
const OUTPUT_VECTORS: usize = 3;

/// Channels of a pixel: its color; a network with a range adds color times range, and range.
const PLAIN: usize = 3;
const RANGED: usize = 7;

/// A network with its weights packed for execution.
#[derive(Debug, Clone)]
pub struct Network {
    context: Context,
    pixel: Packed<4>,
    output: Packed<3>,
    color: Packed<3>,
    /// Channels of a pixel.
    channels: usize,
}

/// ContextBuffers reused between frames; their contents do not affect results.
#[derive(Debug, Default)]
pub struct Scratch {
    context: context::ContextBuffers,
    widened: Widened,
    /// The last three rows of the frame, with borders: `[row % 3][channel]`.
    image: Vec<f32>,
    /// The last three rows of the features, with borders.
    features: Vec<f32>,
    /// A row of the result.
    styled: [Vec<f32>; 3],
}

impl Network {
    /// Packs the weights.
    #[must_use]
    pub fn new(weights: &Weights) -> Self {
        let (mut pixel, mut color) = (Packed::new(weights, PIXEL), Packed::new(weights, COLOR));
        if weights.takes_range() {
            pixel.join(Packed::new(weights, RANGE_PIXEL));
            color.join(Packed::new(weights, RANGE_COLOR));
        }
        Self {
            context: Context::new(weights),
            pixel,
            output: Packed::new(weights, OUTPUT),
            color,
            channels: if weights.takes_range() { RANGED } else { PLAIN },
        }
    }

    /// Whether it has a range input.
    #[must_use]
    pub fn takes_range(&self) -> bool {
        self.channels == RANGED
    }

    /// Repaints a frame of sRGB-encoded samples in 0..=1 and returns the same encoding. An empty frame stays empty.
    /// `range` is that of the frame's pixels, 0 at the camera and 1 far away; absent, all pixels are at the camera. A
    /// network without a range input ignores it. The bits depend on frame and range only, not on the CPU.
    ///
    /// # Panics
    /// If the range is smaller than the frame.
    #[must_use]
    pub fn apply(&self, encoded: &Rgb<f32>, range: Option<&Plane<f32>>, scratch: &mut Scratch) -> Rgb<f32> {
        let (width, height) = encoded.size();
        let [mut r, mut g, mut b] = [const { Vec::new() }; 3];
        for plane in [&mut r, &mut g, &mut b] {
            plane.reserve_exact(width * height);
        }
        let mut planes = [r, g, b];
        if width > 0 && height > 0 {
            pulp::Arch::new().dispatch(NetworkRun {
                network: self,
                encoded,
                range: range.filter(|_| self.takes_range()),
                scratch,
                planes: &mut planes,
            });
        }
        let planes = planes.map(|plane| Plane::new(width, height, plane).expect("all rows were written"));
        Rgb::new(planes).expect("three planes of one size")
    }
}

struct NetworkRun<'a> {
    network: &'a Network,
    encoded: &'a Rgb<f32>,
    range: Option<&'a Plane<f32>>,
    scratch: &'a mut Scratch,
    planes: &'a mut [Vec<f32>; 3],
}

impl WithSimd for NetworkRun<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self {
            network,
            encoded,
            range,
            scratch,
            planes,
        } = self;
        let channels = network.channels;
        let (width, height) = encoded.size();
        let stride = stride(width);
        let context = network.context.run(encoded, &mut scratch.context);
        scratch.widened.start(width, context);
        scratch.image.resize(3 * channels * stride, 0.0);
        scratch.features.resize(3 * 8 * stride, 0.0);
        scratch.styled.iter_mut().for_each(|row| row.resize(stride, 0.0));
        let (mut copied, mut made) = (0, 0);
        for y in 0..height {
            cancel::check();
            while made < (y + 2).min(height) {
                while copied < (made + 2).min(height) {
                    let rows = &mut scratch.image[copied % 3 * channels * stride..][..channels * stride];
                    copy_row(encoded, range, copied, rows, stride);
                    copied += 1;
                }
                let place = place(made, height, context.height);
                scratch.widened.fetch(context, place);
                let slots = neighbors(made, height);
                let features = &mut scratch.features[made % 3 * 8 * stride..][..8 * stride];
                make_features(
                    simd,
                    &network.pixel,
                    FeatureRows {
                        rows: &scratch.image,
                        stride,
                        slots,
                    },
                    (&scratch.widened, place),
                    features,
                    width,
                );
                made += 1;
            }
            let slots = neighbors(y, height);
            let image = FeatureRows {
                rows: &scratch.image,
                stride,
                slots,
            };
            let features = FeatureRows {
                rows: &scratch.features,
                stride,
                slots,
            };
            finish(simd, network, image, features, &mut scratch.styled, width);
            for (plane, row) in planes.iter_mut().zip(&scratch.styled) {
                plane.extend_from_slice(&row[..width]);
            }
        }
    }
}

/// Row `y` of the network's input with borders: colors; then, for a network with a range, colors times range, and the
/// range.
#[inline(always)]
fn copy_row(encoded: &Rgb<f32>, range: Option<&Plane<f32>>, y: usize, rows: &mut [f32], stride: usize) {
    let width = encoded.width();
    let (colors, ranged) = rows.split_at_mut(PLAIN * stride);
    for (plane, row) in encoded.planes().iter().zip(colors.chunks_exact_mut(stride)) {
        row[1..=width].copy_from_slice(plane.row(y));
    }
    if let Some(range) = range {
        let range = &range.row(y)[..width];
        let (products, last) = ranged.split_at_mut(PLAIN * stride);
        for (plane, row) in encoded.planes().iter().zip(products.chunks_exact_mut(stride)) {
            for ((product, color), range) in row[1..=width].iter_mut().zip(plane.row(y)).zip(range) {
                *product = color * range;
            }
        }
        last[1..=width].copy_from_slice(range);
    } else {
        ranged.fill(0.0);
    }
    for row in rows.chunks_exact_mut(stride) {
        close_row(row, width);
    }
}

/// FeatureRows of several channels: `[slot][channel]`.
#[derive(Clone, Copy)]
struct FeatureRows<'a> {
    rows: &'a [f32],
    stride: usize,
    /// Slots of the previous, the current and the next row.
    slots: [usize; 3],
}

impl<'a> FeatureRows<'a> {
    #[inline(always)]
    fn row(self, slot: usize, channels: usize, channel: usize) -> &'a [f32] {
        &self.rows[(slot * channels + channel) * self.stride..][..self.stride]
    }
}

/// Slots of the rows above, at and below `y`, clamped to the edge.
fn neighbors(y: usize, height: usize) -> [usize; 3] {
    [y.saturating_sub(1) % 3, y % 3, (y + 1).min(height - 1) % 3]
}

/// One row of the features.
#[inline(always)]
fn make_features<S: Simd>(
    simd: S,
    pixel: &Packed<4>,
    image: FeatureRows<'_>,
    (widened, place): (&Widened, across::UpsamplePosition),
    features: &mut [f32],
    width: usize,
) {
    let zero = simd.splat_f32s(0.0);
    let share = simd.splat_f32s(place.share);
    let channels = pixel.groups[0].weights.len() / pixel.taps;
    for (index, group) in pixel.groups.iter().enumerate() {
        for x in (0..width).step_by(PIXEL_VECTORS * S::F32_LANES) {
            let mut sums: SumBlock<S, 4, PIXEL_VECTORS> = splat(simd, &group.bias);
            for channel in 0..channels {
                for row in 0..3 {
                    let samples = &image.row(image.slots[row], channels, channel)[x..];
                    let weights = &group.weights[9 * channel + 3 * row..];
                    multiply_row(simd, &mut sums, samples, weights);
                }
            }
            for (output, mut sums) in sums.into_iter().enumerate() {
                let channel = 4 * index + output;
                let low = load::<S, PIXEL_VECTORS>(&widened.row(place.low, channel)[x..]);
                let high = load::<S, PIXEL_VECTORS>(&widened.row(place.high, channel)[x..]);
                for ((sum, low), high) in sums.iter_mut().zip(low).zip(high) {
                    let between = simd.mul_f32s(simd.sub_f32s(high, low), share);
                    let context = simd.add_f32s(low, between);
                    *sum = simd.max_f32s(simd.add_f32s(*sum, context), zero);
                }
                store::<S, PIXEL_VECTORS>(&mut features[channel * image.stride + 1 + x..], sums);
            }
        }
    }
    for row in features.chunks_exact_mut(image.stride) {
        close_row(row, width);
    }
}

/// One row of the result.
#[inline(always)]
fn finish<S: Simd>(
    simd: S,
    network: &Network,
    image: FeatureRows<'_>,
    features: FeatureRows<'_>,
    styled: &mut [Vec<f32>; 3],
    width: usize,
) {
    let (zero, one) = (simd.splat_f32s(0.0), simd.splat_f32s(1.0));
    let (output, color) = (&network.output.groups[0], &network.color.groups[0]);
    let bias = std::array::from_fn(|channel| output.bias[channel] + color.bias[channel]);
    for x in (0..width).step_by(OUTPUT_VECTORS * S::F32_LANES) {
        let mut sums: SumBlock<S, 3, OUTPUT_VECTORS> = splat(simd, &bias);
        for (channel, weights) in color.weights.iter().enumerate() {
            let samples = &image.row(image.slots[1], network.channels, channel)[1 + x..];
            multiply(simd, &mut sums, samples, weights);
        }
        for channel in 0..8 {
            for row in 0..3 {
                let samples = &features.row(features.slots[row], 8, channel)[x..];
                let weights = &output.weights[9 * channel + 3 * row..];
                multiply_row(simd, &mut sums, samples, weights);
            }
        }
        for (row, sums) in styled.iter_mut().zip(sums) {
            let sums = sums.map(|sum| simd.min_f32s(simd.max_f32s(sum, zero), one));
            store::<S, OUTPUT_VECTORS>(&mut row[x..], sums);
        }
    }
}
