//! The part of a picture inside a mask.

use imaging::{Plane, Rgb8};

/// The pixels inside the mask, those of values other than 0, in one row.
pub(crate) fn select_pixels(picture: &Rgb8, mask: &Plane<u8>) -> Rgb8 {
    let counted = picture.pixels().zip(mask.data()).filter(|(_, code)| **code > 0);
    let codes: Vec<u8> = counted.flat_map(|(pixel, _)| pixel).collect();
    Rgb8::from_fn(codes.len() / 3, 1, |x, _| {
        [codes[3 * x], codes[3 * x + 1], codes[3 * x + 2]]
    })
}

/// Whether the mask is 0 nowhere in a block of columns and rows.
pub(crate) fn contains_block(
    mask: &Plane<u8>,
    columns: std::ops::Range<usize>,
    mut rows: std::ops::Range<usize>,
) -> bool {
    rows.all(|y| mask.row(y)[columns.clone()].iter().all(|&code| code > 0))
}
