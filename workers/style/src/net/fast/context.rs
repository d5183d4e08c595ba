//! The context branch: all layers below full resolution.

use imaging::Rgb;
use pulp::{Simd, WithSimd};

use super::multiply::{SumBlock, load, multiply, multiply_row, splat, store};
use super::packed::Packed;
use super::planes::BorderedPlanes;
use crate::net::layer::{BLOCKS, ENTER, LEAVE, REDUCE, Weights};

/// Vectors of a block; with four outputs eight sums, which fit the registers of AVX2.
const VECTORS: usize = 2;

/// Weights of the branch.
#[derive(Debug, Clone)]
pub(super) struct Context {
    enter: Packed<4>,
    reduce: Packed<4>,
    blocks: [MixedBlock; 2],
    leave: Packed<4>,
}

#[derive(Debug, Clone)]
struct MixedBlock {
    spread_a: Packed<1>,
    mix_a: Packed<4>,
    spread_b: Packed<1>,
    mix_b: Packed<4>,
}

/// ContextBuffers of the branch, kept between frames.
#[derive(Debug, Default)]
pub(super) struct ContextBuffers {
    sums: Vec<f32>,
    pooled: BorderedPlanes,
    quarter: BorderedPlanes,
    /// Columns 0, 2, 4… and 1, 3, 5… of the bordered quarter.
    halves: [BorderedPlanes; 2],
    context: BorderedPlanes,
    spread: BorderedPlanes,
    mixed: BorderedPlanes,
    left: BorderedPlanes,
}

impl Context {
    pub(super) fn new(weights: &Weights) -> Self {
        Self {
            enter: Packed::new(weights, ENTER),
            reduce: Packed::new(weights, REDUCE),
            blocks: BLOCKS.map(|[spread_a, mix_a, spread_b, mix_b]| MixedBlock {
                spread_a: Packed::new(weights, spread_a),
                mix_a: Packed::new(weights, mix_a),
                spread_b: Packed::new(weights, spread_b),
                mix_b: Packed::new(weights, mix_b),
            }),
            leave: Packed::new(weights, LEAVE),
        }
    }

    /// The context features at an eighth of the resolution: 8 channels.
    pub(super) fn run<'a>(&self, image: &Rgb<f32>, buffers: &'a mut ContextBuffers) -> &'a BorderedPlanes {
        pool(image, &mut buffers.sums, &mut buffers.pooled);
        let (width, height) = (buffers.pooled.width, buffers.pooled.height);
        let (narrow, low) = (width.div_ceil(2), height.div_ceil(2));
        buffers.quarter.reshape(8, width, height);
        for half in &mut buffers.halves {
            half.reshape(8, narrow + 1, height);
        }
        for planes in [&mut buffers.context, &mut buffers.spread, &mut buffers.mixed] {
            planes.reshape(16, narrow, low);
        }
        buffers.left.reshape(8, narrow, low);
        pulp::Arch::new().dispatch(ContextRun {
            context: self,
            buffers,
        });
        &buffers.left
    }
}

struct ContextRun<'a> {
    context: &'a Context,
    buffers: &'a mut ContextBuffers,
}

impl WithSimd for ContextRun<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { context, buffers } = self;
        filter3(simd, &context.enter, &buffers.pooled, &mut buffers.quarter, true);
        split(&buffers.quarter, &mut buffers.halves);
        reduce(simd, &context.reduce, &buffers.halves, &mut buffers.context);
        for block in &context.blocks {
            let (spread, mixed) = (&mut buffers.spread, &mut buffers.mixed);
            spread_out(simd, &block.spread_a, &buffers.context, spread);
            mix(simd, &block.mix_a, spread, mixed, true);
            spread_out(simd, &block.spread_b, mixed, spread);
            mix(simd, &block.mix_b, spread, &mut buffers.context, false);
        }
        filter3(simd, &context.leave, &buffers.context, &mut buffers.left, false);
    }
}

/// Means of 4×4 pixels, clipped at the right and lower edge.
fn pool(image: &Rgb<f32>, sums: &mut Vec<f32>, pooled: &mut BorderedPlanes) {
    let (width, height) = image.size();
    pooled.reshape(3, width.div_ceil(4), height.div_ceil(4));
    for (channel, plane) in image.planes().iter().enumerate() {
        for y in 0..pooled.height {
            let rows = 4 * y..(4 * y + 4).min(height);
            sums.clear();
            sums.extend_from_slice(plane.row(rows.start));
            for row in rows.clone().skip(1) {
                for (sum, sample) in sums.iter_mut().zip(plane.row(row)) {
                    *sum += sample;
                }
            }
            let whole = 1.0 / (4 * rows.len()) as f32;
            let means = &mut pooled.row_mut(channel, y + 1)[1..];
            for (mean, four) in means.iter_mut().zip(sums.chunks(4)) {
                *mean = match four {
                    [a, b, c, d] => (a + b + c + d) * whole,
                    fewer => fewer.iter().sum::<f32>() / (fewer.len() * rows.len()) as f32,
                };
            }
        }
    }
    pooled.close();
}

/// A 3×3 filter over all channels.
#[inline(always)]
fn filter3<S: Simd>(
    simd: S,
    packed: &Packed<4>,
    input: &BorderedPlanes,
    output: &mut BorderedPlanes,
    relu: bool,
) {
    let inputs = packed.groups[0].weights.len() / packed.taps;
    for y in 0..input.height {
        for (index, group) in packed.groups.iter().enumerate() {
            for x in (0..input.width).step_by(VECTORS * S::F32_LANES) {
                let mut sums: SumBlock<S, 4, VECTORS> = splat(simd, &group.bias);
                for channel in 0..inputs {
                    let weights = &group.weights[9 * channel..9 * channel + 9];
                    for row in 0..3 {
                        let samples = &input.row(channel, y + row)[x..];
                        multiply_row(simd, &mut sums, samples, &weights[3 * row..]);
                    }
                }
                put(simd, output, 4 * index, y, x, sums, relu);
            }
        }
    }
    output.close();
}

/// Writes a block of four outputs, with or without ReLU.
#[inline(always)]
fn put<S: Simd>(
    simd: S,
    output: &mut BorderedPlanes,
    channel: usize,
    y: usize,
    x: usize,
    sums: SumBlock<S, 4, VECTORS>,
    relu: bool,
) {
    let zero = simd.splat_f32s(0.0);
    for (index, mut sums) in sums.into_iter().enumerate() {
        if relu {
            sums = sums.map(|sum| simd.max_f32s(sum, zero));
        }
        store::<S, VECTORS>(&mut output.row_mut(channel + index, y + 1)[1 + x..], sums);
    }
}

/// Splits the bordered rows into even and odd columns, so that a filter of stride 2 reads neighbors.
fn split(planes: &BorderedPlanes, halves: &mut [BorderedPlanes; 2]) {
    let [even, odd] = halves;
    let columns = even.width;
    for channel in 0..8 {
        for y in 0..planes.height + 2 {
            let row = planes.row(channel, y);
            let pairs = row.chunks_exact(2).take(columns);
            let (even, odd) = (even.row_mut(channel, y), odd.row_mut(channel, y));
            for ((pair, even), odd) in pairs.zip(even).zip(odd) {
                (*even, *odd) = (pair[0], pair[1]);
            }
        }
    }
}

/// A 3×3 filter of stride 2 with ReLU.
#[inline(always)]
fn reduce<S: Simd>(
    simd: S,
    packed: &Packed<4>,
    [even, odd]: &[BorderedPlanes; 2],
    output: &mut BorderedPlanes,
) {
    let inputs = packed.groups[0].weights.len() / packed.taps;
    for y in 0..output.height {
        for (index, group) in packed.groups.iter().enumerate() {
            for x in (0..output.width).step_by(VECTORS * S::F32_LANES) {
                let mut sums: SumBlock<S, 4, VECTORS> = splat(simd, &group.bias);
                for channel in 0..inputs {
                    for row in 0..3 {
                        let weights = &group.weights[9 * channel + 3 * row..][..3];
                        let (even, odd) = (even.row(channel, 2 * y + row), odd.row(channel, 2 * y + row));
                        multiply(simd, &mut sums, &even[x..], &weights[0]);
                        multiply(simd, &mut sums, &odd[x..], &weights[1]);
                        multiply(simd, &mut sums, &even[x + 1..], &weights[2]);
                    }
                }
                put(simd, output, 4 * index, y, x, sums, true);
            }
        }
    }
    output.close();
}

/// A 3×3 depthwise filter. The border of the result stays undefined: only [`mix`] reads it.
#[inline(always)]
fn spread_out<S: Simd>(simd: S, packed: &Packed<1>, input: &BorderedPlanes, output: &mut BorderedPlanes) {
    for (channel, group) in packed.groups.iter().enumerate() {
        for y in 0..input.height {
            for x in (0..input.width).step_by(VECTORS * S::F32_LANES) {
                let mut sums: SumBlock<S, 1, VECTORS> = splat(simd, &group.bias);
                for row in 0..3 {
                    let samples = &input.row(channel, y + row)[x..];
                    multiply_row(simd, &mut sums, samples, &group.weights[3 * row..]);
                }
                store::<S, VECTORS>(&mut output.row_mut(channel, y + 1)[1 + x..], sums[0]);
            }
        }
    }
}

/// Mixes the channels of each pixel: replaces the output with ReLU, or adds to it.
#[inline(always)]
fn mix<S: Simd>(
    simd: S,
    packed: &Packed<4>,
    input: &BorderedPlanes,
    output: &mut BorderedPlanes,
    replace: bool,
) {
    for y in 0..input.height {
        for (index, group) in packed.groups.iter().enumerate() {
            for x in (0..input.width).step_by(VECTORS * S::F32_LANES) {
                let mut sums: SumBlock<S, 4, VECTORS> = splat(simd, &group.bias);
                for (channel, weights) in group.weights.iter().enumerate() {
                    multiply(simd, &mut sums, &input.row(channel, y + 1)[1 + x..], weights);
                }
                if !replace {
                    for (output_index, sums) in sums.iter_mut().enumerate() {
                        let before = &output.row(4 * index + output_index, y + 1)[1 + x..];
                        let before = load::<S, VECTORS>(before);
                        for (sum, before) in sums.iter_mut().zip(before) {
                            *sum = simd.add_f32s(*sum, before);
                        }
                    }
                }
                put(simd, output, 4 * index, y, x, sums, replace);
            }
        }
    }
    output.close();
}
