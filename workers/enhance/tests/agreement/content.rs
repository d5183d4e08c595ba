//! Pictures for comparing variants: content × size.

use imaging::Rgb8;

/// Odd, prime, one pixel, smaller than every window, 16:9.
pub(crate) const SIZES: [(usize, usize); 13] = [
    (1, 1),
    (1, 37),
    (53, 1),
    (2, 2),
    (7, 5),
    (11, 3),
    (31, 29),
    (97, 61),
    (127, 101),
    (160, 120),
    (33, 250),
    (320, 180),
    (320, 239),
];

pub(crate) fn noise(x: usize, y: usize) -> u8 {
    let mut hash = (x as u32).wrapping_mul(0x9e37_79b1) ^ (y as u32).wrapping_mul(0x85eb_ca77);
    hash = (hash ^ (hash >> 15)).wrapping_mul(0x2c1b_3c6d);
    (hash >> 24) as u8
}

type Pixel = fn(usize, usize) -> [u8; 3];

pub(crate) fn pictures(width: usize, height: usize) -> [(&'static str, Rgb8); 8] {
    let pixels: [(&str, Pixel); 8] = [
        ("noise", |x, y| {
            [noise(x, y), noise(x + 999, y), noise(x, y + 999)]
        }),
        ("ramp", |x, y| {
            [(x % 256) as u8, (y % 256) as u8, ((x + y) / 2 % 256) as u8]
        }),
        ("one lamp in the dark", |x, y| {
            if (x, y) == (3, 2) { [255; 3] } else { [0; 3] }
        }),
        ("edge", |x, _| if x % 40 < 20 { [0; 3] } else { [255; 3] }),
        ("constant", |_, _| [60, 120, 140]),
        ("black", |_, _| [0; 3]),
        ("nearly one color", |x, y| {
            [60, 120 + u8::from(noise(x, y) > 250), 140]
        }),
        ("hazed", |x, y| {
            let far = 255 - (x * 255 / (x + 40)) as u32;
            let plate = u32::from(noise(x / 9, y / 7)) * far / 255;
            [plate / 5 + 8, plate / 2 + 70, plate / 2 + 85]
                .map(|code| (code + u32::from(noise(x, y) >> 6)) as u8)
        }),
    ];
    pixels.map(|(name, pixel)| (name, Rgb8::from_fn(width, height, pixel)))
}
