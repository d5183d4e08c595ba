//! The inner loop of every layer: one sample of a row times the weights of several outputs, a block of columns at a
//! time.
//!
//! Products and sums are separate instructions, never fused, so every CPU yields the same bits.

use pulp::Simd;

/// Sums of a block: `V` vectors of columns for each of `OUT` outputs.
pub(super) type SumBlock<S, const OUT: usize, const V: usize> = [[<S as Simd>::f32s; V]; OUT];

/// Adds samples × weights. `samples` begins at the first column of the block.
#[inline(always)]
pub(super) fn multiply<S: Simd, const OUT: usize, const V: usize>(
    simd: S,
    sums: &mut SumBlock<S, OUT, V>,
    samples: &[f32],
    weights: &[f32; OUT],
) {
    let columns = load::<S, V>(samples);
    for output in 0..OUT {
        let weight = simd.splat_f32s(weights[output]);
        for v in 0..V {
            let product = simd.mul_f32s(columns[v], weight);
            sums[output][v] = simd.add_f32s(sums[output][v], product);
        }
    }
}

/// Adds a row of a 3×3 filter. `samples` begins one column before the block.
#[inline(always)]
pub(super) fn multiply_row<S: Simd, const OUT: usize, const V: usize>(
    simd: S,
    sums: &mut SumBlock<S, OUT, V>,
    samples: &[f32],
    weights: &[[f32; OUT]],
) {
    let window = &samples[..V * S::F32_LANES + 2];
    for column in 0..3 {
        multiply(simd, sums, &window[column..], &weights[column]);
    }
}

/// The first `V` vectors of a row.
#[inline(always)]
pub(super) fn load<S: Simd, const V: usize>(samples: &[f32]) -> [S::f32s; V] {
    let (vectors, _) = S::as_simd_f32s(&samples[..V * S::F32_LANES]);
    std::array::from_fn(|v| vectors[v])
}

/// Writes a row of sums to the first `V` vectors of a row.
#[inline(always)]
pub(super) fn store<S: Simd, const V: usize>(samples: &mut [f32], sums: [S::f32s; V]) {
    let (vectors, _) = S::as_mut_simd_f32s(&mut samples[..V * S::F32_LANES]);
    vectors.copy_from_slice(&sums);
}

/// The same value in every lane of a block.
#[inline(always)]
pub(super) fn splat<S: Simd, const OUT: usize, const V: usize>(
    simd: S,
    values: &[f32; OUT],
) -> SumBlock<S, OUT, V> {
    values.map(|value| [simd.splat_f32s(value); V])
}
