//! The integer DCT of 8×8 blocks after Loeffler, Ligtenberg and Moschytz (1989), with constants of 13 bits. Rounding
//! is that of `jfdctint` of the Independent JPEG Group as the `image` crate has it, so that files keep their bytes.

const fn fixed(constant: f64) -> i32 {
    (constant * 8192.0 + 0.5) as i32
}

/// Bits that the rows' pass keeps beyond whole numbers.
const KEPT_BITS: u32 = 2;
const ROWS_SHIFT: u32 = 13 - KEPT_BITS;
const COLUMNS_SHIFT: u32 = 13 + KEPT_BITS;

/// Transforms a block of codes; coefficients are 8 times those of an orthonormal transform.
pub(super) fn forward(codes: &[u8; 64]) -> [i32; 64] {
    let mut block = codes.map(|code| i32::from(code) - 128);
    for row in block.as_chunks_mut::<8>().0 {
        *row = pass(*row, ROWS_SHIFT, |sum| sum << KEPT_BITS);
    }
    for column in 0..8 {
        let values = std::array::from_fn(|row| block[8 * row + column]);
        let round = 1 << (KEPT_BITS - 1);
        let done = pass(values, COLUMNS_SHIFT, |sum| (sum + round) >> KEPT_BITS);
        for (row, value) in done.into_iter().enumerate() {
            block[8 * row + column] = value;
        }
    }
    block
}

/// One line of eight values; `plain` scales the sums that no constant multiplies.
fn pass(v: [i32; 8], shift: u32, plain: impl Fn(i32) -> i32) -> [i32; 8] {
    let sum: [i32; 4] = std::array::from_fn(|i| v[i] + v[7 - i]);
    let [d0, d1, d2, d3]: [i32; 4] = std::array::from_fn(|i| v[i] - v[7 - i]);

    let (outer, inner) = (sum[0] + sum[3], sum[1] + sum[2]);
    let (outer_step, inner_step) = (sum[0] - sum[3], sum[1] - sum[2]);
    let even = (outer_step + inner_step) * fixed(0.541196100) + (1 << (shift - 1));

    // Both passes round the odd part as the rows' does.
    let odd = (d0 + d2 + d1 + d3) * fixed(1.175875602) + (1 << (ROWS_SHIFT - 1));
    let even_pair = odd - (d0 + d2) * fixed(0.390180644);
    let odd_pair = odd - (d1 + d3) * fixed(1.961570560);
    let far = (d0 + d3) * -fixed(0.899976223);
    let near = (d1 + d2) * -fixed(2.562915447);

    [
        plain(outer + inner),
        (d0 * fixed(1.501321110) + far + even_pair) >> shift,
        (even + outer_step * fixed(0.765366865)) >> shift,
        (d1 * fixed(3.072711026) + near + odd_pair) >> shift,
        plain(outer - inner),
        (d2 * fixed(2.053119869) + near + even_pair) >> shift,
        (even - inner_step * fixed(1.847759065)) >> shift,
        (d3 * fixed(0.298631336) + far + odd_pair) >> shift,
    ]
}
