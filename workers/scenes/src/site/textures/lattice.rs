//! Random values and gradients at the points of a lattice.

use crate::site::lanes::{Lane, Lane3};

/// NoiseSample values, about -1..1 and 0 on average, and their slopes per meter.
#[derive(Clone, Copy, Default)]
pub(crate) struct NoiseSample {
    pub(crate) value: Lane,
    pub(crate) slope: Lane3,
}

#[inline(always)]
pub(crate) fn hash([x, y, z]: [u32; 3]) -> u32 {
    let mut h = x ^ y ^ z;
    h = (h ^ (h >> 15)).wrapping_mul(0x2c1b_3c6d);
    h = (h ^ (h >> 12)).wrapping_mul(0x297a_2d39);
    h ^ (h >> 15)
}

/// The integers to hash for a cell of a lattice. The coordinates must be whole numbers.
#[inline(always)]
pub(crate) fn lattice(cell: [f32; 3], key: u32) -> [u32; 3] {
    // 1.5 * 2^23 shifts the integer into the mantissa.
    let [x, y, z] = cell.map(|below| (below + 12_582_912.0).to_bits());
    [
        x.wrapping_mul(0x9e37_79b1) ^ key,
        y.wrapping_mul(0x85eb_ca77),
        z.wrapping_mul(0xc2b2_ae3d),
    ]
}

/// The gradient at a corner, in units of [`GRADIENT_UNIT`]: the hash as a signed number, and the same without its top
/// ten and top twenty bits.
#[inline(always)]
pub(crate) fn gradient(corner: [u32; 3]) -> [f32; 3] {
    let h = hash(corner);
    [h as i32 as f32, (h << 10) as i32 as f32, (h << 20) as i32 as f32]
}

/// Scales a gradient component to -1..1.
pub(crate) const GRADIENT_UNIT: f32 = 1.0 / 2_147_483_648.0;
