//! Small handmade files.

use imaging::codec::{encode_npy_plane, encode_png};
use imaging::{Plane, Rgb8};

/// An image with a gradient.
pub(crate) fn png(width: usize, height: usize) -> Vec<u8> {
    let picture = Rgb8::from_fn(width, height, |x, y| {
        [(x * 7 % 256) as u8, (y * 5 % 256) as u8, 90]
    });
    encode_png(&picture.into()).unwrap()
}

/// A different image for each number.
pub(crate) fn numbered_png(width: usize, height: usize, number: u64) -> Vec<u8> {
    let picture = Rgb8::from_fn(width, height, |x, y| [x as u8, y as u8, number as u8]);
    encode_png(&picture.into()).unwrap()
}

/// Range as float NPY, in meters.
pub(crate) fn range_npy(width: usize, height: usize, meters: impl Fn(usize, usize) -> f32) -> Vec<u8> {
    encode_npy_plane(&Plane::from_fn(width, height, meters))
}

/// Range as 16-bit PNG, 1000 everywhere.
pub(crate) fn range_png(width: usize, height: usize) -> Vec<u8> {
    encode_png(&Plane::filled(width, height, 1000_u16).into()).unwrap()
}

/// The header of a PNG of this size, and the beginning of its pixels.
pub(crate) fn png_head(width: u32, height: u32) -> Vec<u8> {
    let mut chunk = b"IHDR".to_vec();
    chunk.extend_from_slice(&width.to_be_bytes());
    chunk.extend_from_slice(&height.to_be_bytes());
    chunk.extend_from_slice(&[8, 2, 0, 0, 0]);
    let mut file = b"\x89PNG\r\n\x1a\n".to_vec();
    file.extend_from_slice(&13_u32.to_be_bytes());
    file.extend_from_slice(&chunk);
    file.extend_from_slice(&crc(&chunk).to_be_bytes());
    file.extend_from_slice(b"\0\0\xff\xffIDAT");
    file
}

fn crc(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0_u32, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| {
            if crc & 1 == 1 {
                crc >> 1 ^ 0xEDB8_8320
            } else {
                crc >> 1
            }
        })
    })
}

/// An incompressible square image: three bytes per pixel.
pub(crate) fn noise_png(side: usize, seed: u64) -> Vec<u8> {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        (state >> 32) as u8
    };
    let picture = Rgb8::from_fn(side, side, |_, _| [next(), next(), next()]);
    encode_png(&picture.into()).unwrap()
}
