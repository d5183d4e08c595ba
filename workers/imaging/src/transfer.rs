//! The sRGB transfer curve (IEC 61966-2-1) between codes and linear light.
//!
//! `l = v/12.92` for `v <= 0.04045`, else `((v + 0.055)/1.055)^2.4`; the inverse for encoding. The f64 functions are
//! the reference. The picture functions use tables: those of codes equal the reference, those of floats
//! ([`encode_unit`], [`decode_unit`]) are within 6.1e-8 of it. All powers come from a Rust library instead of the
//! platform's, so pictures agree on every machine.

mod curve;
mod encoder;
mod unit;

use std::sync::LazyLock;

use crate::raster::{Channels, Raster, Rgb8, Samples};
use crate::{Plane, Rgb};
pub use curve::{decode, encode};
use encoder::Encoder;

/// Relation of a file's codes to linear light.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Transfer {
    /// The sRGB curve.
    Srgb,
    /// Codes are proportional to light.
    Linear,
}

static DECODED_U8: LazyLock<[f32; 256]> =
    LazyLock::new(|| std::array::from_fn(|code| decode(code as f64 / 255.0) as f32));
static DECODED_U16: LazyLock<Vec<f32>> = LazyLock::new(|| {
    (0..=u16::MAX)
        .map(|code| decode(f64::from(code) / 65535.0) as f32)
        .collect()
});
static ENCODER: LazyLock<Encoder> = LazyLock::new(Encoder::new);

/// Linear light of an 8-bit sRGB code.
#[must_use]
pub fn decode_u8(code: u8) -> f32 {
    DECODED_U8[usize::from(code)]
}

/// Linear light of an 8-bit sRGB picture.
#[must_use]
pub fn decode_rgb8(picture: &Rgb8) -> Rgb<f32> {
    let table = &*DECODED_U8;
    planar::<_, 3>(picture.width(), picture.height(), picture.data(), |code| {
        table[usize::from(code)]
    })
}

/// Linear light of a file's samples; gray becomes three equal planes, alpha is ignored.
#[must_use]
pub fn decode_raster(raster: &Raster, transfer: Transfer) -> Rgb<f32> {
    match (raster.samples(), transfer) {
        (Samples::U8(codes), Transfer::Srgb) => {
            let table = &*DECODED_U8;
            channels(raster, codes, |code| table[usize::from(code)])
        }
        (Samples::U8(codes), Transfer::Linear) => {
            channels(raster, codes, |code| (f64::from(code) / 255.0) as f32)
        }
        (Samples::U16(codes), Transfer::Srgb) => {
            let table = DECODED_U16.as_slice();
            channels(raster, codes, |code| table[usize::from(code)])
        }
        (Samples::U16(codes), Transfer::Linear) => {
            channels(raster, codes, |code| (f64::from(code) / 65535.0) as f32)
        }
    }
}

fn channels<T: Copy>(raster: &Raster, codes: &[T], light: impl Fn(T) -> f32) -> Rgb<f32> {
    match raster.channels() {
        Channels::Gray => planar::<_, 1>(raster.width(), raster.height(), codes, light),
        Channels::Rgb => planar::<_, 3>(raster.width(), raster.height(), codes, light),
    }
}

/// Three planes from interleaved samples, `STRIDE` per pixel; with fewer than three the last one is repeated.
fn planar<T: Copy, const STRIDE: usize>(
    width: usize,
    height: usize,
    samples: &[T],
    light: impl Fn(T) -> f32,
) -> Rgb<f32> {
    let (pixels, _) = samples.as_chunks::<STRIDE>();
    let mut bands = [const { Vec::new() }; 3];
    for (channel, band) in bands.iter_mut().enumerate() {
        let channel = channel.min(STRIDE - 1);
        band.extend(pixels.iter().map(|pixel| light(pixel[channel])));
    }
    let planes =
        bands.map(|band| Plane::new(width, height, band).expect("a raster holds width × height pixels"));
    Rgb::new(planes).expect("three planes of one raster")
}

/// 8-bit sRGB codes of linear light: clamp to 0..=1, inverse curve, `floor(255 v + 1/2)`; and the number of clamped
/// samples. NaN becomes 0 and counts as clamped. Equal to the f64 reference for every f32.
#[must_use]
pub fn encode_rgb8(linear: &Rgb<f32>) -> (Rgb8, u64) {
    let encoder = &*ENCODER;
    let (width, height) = linear.size();
    let [r, g, b] = linear.planes().each_ref().map(Plane::data);
    let mut data = vec![0; 3 * r.len()];
    let (pixels, _) = data.as_chunks_mut::<3>();
    for (pixel, ((&r, &g), &b)) in pixels.iter_mut().zip(r.iter().zip(g).zip(b)) {
        *pixel = [r, g, b].map(|l| encoder.code(l));
    }
    let clamped = [r, g, b].map(|plane| plane.iter().filter(|l| !(0.0..=1.0).contains(*l)).count() as u64);
    (
        Rgb8::new(width, height, data).expect("three codes for each pixel"),
        clamped.iter().sum(),
    )
}

/// sRGB-encoded values of linear light, both in 0..=1, clamped: the encoding of style networks and blending. Within
/// 6.1e-8 of [`encode`]. NaN stays NaN.
#[must_use]
pub fn encode_unit(linear: &Rgb<f32>) -> Rgb<f32> {
    each_plane(linear, &unit::ENCODE)
}

/// Linear light of sRGB-encoded values, both in 0..=1, clamped. Within 6.1e-8 of [`decode`]. NaN stays NaN.
#[must_use]
pub fn decode_unit(encoded: &Rgb<f32>) -> Rgb<f32> {
    each_plane(encoded, &unit::DECODE)
}

fn each_plane(picture: &Rgb<f32>, curve: &unit::Curve) -> Rgb<f32> {
    let (width, height) = picture.size();
    let planes = picture.planes().each_ref();
    let planes = planes
        .map(|plane| Plane::new(width, height, curve.apply(plane.data())).expect("a value for each value"));
    Rgb::new(planes).expect("three planes of one picture")
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
        assert_eq!(linear.pixel(0, 0), [0.0; 3]);
        assert_eq!(linear.pixel(1, 0), [1.0; 3]);
        let half = Raster::from(Plane::new(1, 1, vec![51u8]).unwrap());
        assert_eq!(decode_raster(&half, Transfer::Linear).pixel(0, 0), [0.2; 3]);
    }
}
