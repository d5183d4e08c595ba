//! The sRGB transfer curve (IEC 61966-2-1) between codes and linear light.
//!
//! `l = v/12.92` for `v <= 0.04045`, else `((v + 0.055)/1.055)^2.4`; the inverse for encoding. The f64 functions are the
//! reference; the picture functions use tables that give the reference's result exactly.

mod encoder;

use std::sync::LazyLock;

use crate::raster::{Channels, Raster, Rgb8, Samples};
use crate::{Plane, Rgb};
use encoder::Encoder;

/// How a file's codes relate to linear light.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Transfer {
    /// The sRGB curve.
    Srgb,
    /// Codes are proportional to light.
    Linear,
}

/// Linear light of an sRGB-encoded value; the straight part continues below 0, the curve above 1.
#[must_use]
pub fn decode(v: f64) -> f64 {
    if v <= 0.04045 {
        v / 12.92
    } else {
        ((v + 0.055) / 1.055).powf(2.4)
    }
}

/// sRGB-encoded value of linear light; the inverse of [`decode`].
#[must_use]
pub fn encode(l: f64) -> f64 {
    if l <= 0.040_45 / 12.92 {
        l * 12.92
    } else {
        1.055 * l.powf(1.0 / 2.4) - 0.055
    }
}

static DECODED: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|code| decode(code as f64 / 255.0) as f32));
static ENCODER: LazyLock<Encoder> = LazyLock::new(Encoder::new);

/// Linear light of an 8-bit sRGB code.
#[must_use]
pub fn decode_u8(code: u8) -> f32 {
    DECODED[usize::from(code)]
}

/// Linear light of an 8-bit sRGB picture.
#[must_use]
pub fn decode_rgb8(picture: &Rgb8) -> Rgb<f32> {
    let table = &*DECODED;
    planar(picture.width(), picture.height(), picture.data(), 3, |code| {
        table[usize::from(code)]
    })
}

/// Linear light of a file's samples; gray becomes three equal planes, alpha is not looked at.
#[must_use]
pub fn decode_raster(raster: &Raster, transfer: Transfer) -> Rgb<f32> {
    let (width, height, stride) = (raster.width(), raster.height(), raster.channels().count());
    match raster.samples() {
        Samples::U8(codes) => {
            let table: [f32; 256] = match transfer {
                Transfer::Srgb => *DECODED,
                Transfer::Linear => std::array::from_fn(|code| (code as f64 / 255.0) as f32),
            };
            planar(width, height, codes, stride, |code| table[usize::from(code)])
        }
        Samples::U16(codes) => {
            let curve = |code: u16| {
                let v = f64::from(code) / 65535.0;
                (if transfer == Transfer::Srgb { decode(v) } else { v }) as f32
            };
            let table: Vec<f32> = (0..=u16::MAX).map(curve).collect();
            planar(width, height, codes, stride, |code| table[usize::from(code)])
        }
    }
}

fn planar<T: Copy>(
    width: usize,
    height: usize,
    samples: &[T],
    stride: usize,
    light: impl Fn(T) -> f32,
) -> Rgb<f32> {
    let band = |channel: usize| {
        let channel = if stride == Channels::Gray.count() {
            0
        } else {
            channel
        };
        let data = samples
            .chunks_exact(stride)
            .map(|pixel| light(pixel[channel]))
            .collect();
        Plane::new(width, height, data).expect("a raster holds width × height pixels")
    };
    Rgb::new([band(0), band(1), band(2)]).expect("three planes of one raster")
}

/// 8-bit sRGB codes of linear light: clamp to 0..=1, inverse curve, `floor(255 v + 1/2)`; and how many samples the
/// clamp changed. NaN becomes 0 and counts as clamped. Equal to the f64 reference for every f32.
#[must_use]
pub fn encode_rgb8(linear: &Rgb<f32>) -> (Rgb8, u64) {
    let encoder = &*ENCODER;
    let (width, height) = linear.size();
    let [r, g, b] = linear.planes().each_ref().map(Plane::data);
    let mut data = Vec::with_capacity(3 * r.len());
    let mut clamped = 0u64;
    for ((&r, &g), &b) in r.iter().zip(g).zip(b) {
        for l in [r, g, b] {
            clamped += u64::from(!(0.0..=1.0).contains(&l));
            data.push(encoder.code(l));
        }
    }
    (
        Rgb8::new(width, height, data).expect("three codes for each pixel"),
        clamped,
    )
}

/// sRGB-encoded values in 0..=1 of linear light, clamped: what the style network and the blend work in.
#[must_use]
pub fn encode_unit(linear: &Rgb<f32>) -> Rgb<f32> {
    linear.map(|&l| encode(f64::from(l.clamp(0.0, 1.0))) as f32)
}

/// Linear light of sRGB-encoded values.
#[must_use]
pub fn decode_unit(encoded: &Rgb<f32>) -> Rgb<f32> {
    encoded.map(|&v| decode(f64::from(v)) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn encode_inverts_decode_on_both_parts_of_the_curve() {
        for v in [0.0, 0.01, 0.04045, 0.0405, 0.2, 0.5, 1.0] {
            assert!((encode(decode(v)) - v).abs() < 1e-7, "{v}");
        }
    }

    #[test]
    fn every_code_survives_decoding_and_encoding() {
        let picture = Rgb8::from_fn(256, 1, |x, _| [x as u8; 3]);
        assert_eq!(encode_rgb8(&decode_rgb8(&picture)), (picture, 0));
    }

    #[test]
    fn samples_outside_the_unit_interval_are_clamped_and_counted() {
        let linear = Rgb::from_fn(1, 1, |_, _| [-0.1f32, 1.5, f32::NAN]);
        let (codes, clamped) = encode_rgb8(&linear);
        assert_eq!((codes.data(), clamped), (&[0u8, 255, 0][..], 3));
    }

    #[test]
    fn gray_sixteen_bit_files_become_three_equal_planes() {
        let raster = Raster::from(Plane::new(2, 1, vec![0u16, 65535]).unwrap());
        let linear = decode_raster(&raster, Transfer::Srgb);
        assert_eq!(linear.at(0, 0), [0.0; 3]);
        assert_eq!(linear.at(1, 0), [1.0; 3]);
        let half = Raster::from(Plane::new(1, 1, vec![51u8]).unwrap());
        assert_eq!(decode_raster(&half, Transfer::Linear).at(0, 0), [0.2; 3]);
    }
}
