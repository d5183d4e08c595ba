//! Files in and out, and what becomes of bytes that are no files.

#![allow(clippy::unwrap_used)]

mod hostile;
mod npy;
mod png;

use imaging::codec::{self, FilePlane, Radiance};
use imaging::{Channels, Plane, Raster, Rgb, Rgb8, Samples};

fn ramp(width: usize, height: usize) -> Rgb8 {
    Rgb8::from_fn(width, height, |x, y| {
        [(3 * x) as u8, (5 * y) as u8, (x * y) as u8]
    })
}

#[test]
fn lossless_formats_give_back_every_sample_of_every_kind() {
    let codes: Vec<u16> = (0..12).map(|i| i * 5000).collect();
    let rasters = [
        Raster::from(ramp(7, 5)),
        Raster::from(Plane::new(4, 3, (0..12u8).collect()).unwrap()),
        Raster::from(Plane::new(4, 3, codes.clone()).unwrap()),
        Raster::new(
            2,
            2,
            Channels::Rgb,
            Samples::U16(codes.clone()),
            Some(Samples::U16(codes[..4].to_vec())),
        )
        .unwrap(),
        Raster::new(
            2,
            2,
            Channels::Gray,
            Samples::U8(vec![1, 2, 3, 4]),
            Some(Samples::U8(vec![9, 8, 7, 6])),
        )
        .unwrap(),
    ];
    for raster in rasters {
        let png = codec::encode_png(&raster).unwrap();
        assert_eq!(codec::decode_picture(&png).unwrap(), raster);
    }
    let webp = codec::encode_webp_lossless(&ramp(7, 5)).unwrap();
    assert_eq!(codec::decode_picture(&webp).unwrap().to_rgb8(), ramp(7, 5));
}

#[test]
fn jpeg_comes_close() {
    let picture = Rgb8::from_fn(16, 16, |_, _| [90, 120, 150]);
    let decoded = codec::decode_picture(&codec::encode_jpeg(&picture, 95).unwrap())
        .unwrap()
        .to_rgb8();
    assert!(
        decoded
            .data()
            .iter()
            .zip(picture.data())
            .all(|(a, b)| a.abs_diff(*b) <= 3)
    );
}

#[test]
fn arrays_come_back_as_linear_light_and_as_range() {
    let light = Rgb::from_fn(3, 2, |x, y| [x as f32, y as f32, 0.5]);
    assert_eq!(
        codec::decode_radiance(&codec::encode_npy_rgb(&light)).unwrap(),
        Radiance::Linear(light)
    );
    let range = Plane::new(3, 1, vec![1.5f32, 2.5, f32::INFINITY]).unwrap();
    assert_eq!(
        codec::decode_plane(&codec::encode_npy_plane(&range)).unwrap(),
        FilePlane::Floats(range)
    );
    let codes = Plane::new(2, 1, vec![7u16, 65535]).unwrap();
    let png = codec::encode_png(&Raster::from(codes.clone())).unwrap();
    assert_eq!(codec::decode_plane(&png).unwrap(), FilePlane::Codes(codes));
}

#[test]
fn encoding_twice_gives_the_same_bytes() {
    let raster = Raster::from(ramp(70, 50));
    assert_eq!(
        codec::encode_png(&raster).unwrap(),
        codec::encode_png(&raster).unwrap()
    );
    let webp = || codec::encode_webp_lossless(&ramp(70, 50)).unwrap();
    assert_eq!(webp(), webp());
}

#[test]
fn an_empty_picture_has_no_file() {
    let empty = Rgb8::new(0, 3, Vec::new()).unwrap();
    assert!(codec::encode_png(&Raster::from(empty.clone())).is_err());
    assert!(codec::encode_webp_lossless(&empty).is_err());
    assert!(codec::encode_jpeg(&empty, 90).is_err());
}
