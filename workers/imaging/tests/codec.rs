//! Files in and out, and what becomes of bytes that are no files.

use fathom_imaging::codec::{self, DecodeError, FilePlane, Radiance};
use fathom_imaging::{Channels, Plane, Raster, Rgb, Rgb8, Samples};
use proptest::prelude::*;

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
fn a_colour_picture_is_no_range_map() {
    let png = codec::encode_png(&Raster::from(ramp(3, 3))).unwrap();
    let error = codec::decode_plane(&png).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the file holds a colour picture but one gray channel is needed"
    );
}

#[test]
fn a_truncated_file_is_damaged() {
    let png = codec::encode_png(&Raster::from(ramp(40, 40))).unwrap();
    assert!(matches!(
        codec::decode_picture(&png[..png.len() / 2]),
        Err(DecodeError::Damaged { .. })
    ));
    let npy = codec::encode_npy_plane(&Plane::filled(40, 40, 1.0));
    assert!(matches!(
        codec::decode_plane(&npy[..npy.len() - 1]),
        Err(DecodeError::Damaged { .. })
    ));
}

/// A PNG header that announces a size, with a right checksum and nothing behind it.
fn png_header(width: u32, height: u32) -> Vec<u8> {
    let mut chunk = b"IHDR".to_vec();
    chunk.extend(width.to_be_bytes());
    chunk.extend(height.to_be_bytes());
    chunk.extend([8, 2, 0, 0, 0]);
    let mut crc = u32::MAX;
    for &byte in &chunk {
        crc ^= u32::from(byte);
        for _ in 0..8 {
            crc = if crc & 1 == 1 {
                crc >> 1 ^ 0xEDB8_8320
            } else {
                crc >> 1
            };
        }
    }
    let mut file = b"\x89PNG\r\n\x1a\n\0\0\0\x0d".to_vec();
    file.extend(&chunk);
    file.extend((!crc).to_be_bytes());
    file.extend(b"\0\0\0\0IDAT\x35\xaf\x06\x1e");
    file
}

#[test]
fn a_bomb_is_refused_from_its_header() {
    let error = codec::decode_picture(&png_header(60_000, 60_000)).unwrap_err();
    assert_eq!(
        error,
        DecodeError::TooLarge {
            width: 60_000,
            height: 60_000
        }
    );
    let error = codec::decode_picture(&png_header(16_000, 16_000)).unwrap_err();
    assert_eq!(
        error,
        DecodeError::TooLarge {
            width: 16_000,
            height: 16_000
        }
    );
    let mut npy = codec::encode_npy_plane(&Plane::filled(1, 1, 1.0));
    let shape = npy.windows(6).position(|w| w == b"(1, 1)").unwrap();
    npy.splice(shape..shape + 6, *b"(99999999, 9)");
    assert!(codec::decode_plane(&npy).is_err());
}

#[test]
fn what_is_no_picture_says_what_would_be() {
    let error = codec::decode_picture(b"GIF89a").unwrap_err();
    assert_eq!(error.to_string(), "the file is neither PNG nor JPEG nor WebP");
}

proptest! {
    #[test]
    fn no_bytes_panic(mut bytes in proptest::collection::vec(any::<u8>(), 0..300), head in 0usize..5) {
        let heads: [&[u8]; 5] = [b"", b"\x89PNG\r\n\x1a\n", b"\xff\xd8\xff\xe0", b"\x93NUMPY\x01\x00", b"RIFF\x40\0\0\0WEBPVP8L"];
        bytes.splice(0..0, heads[head].iter().copied());
        let _ = codec::decode_picture(&bytes);
        let _ = codec::decode_plane(&bytes);
        let _ = codec::decode_radiance(&bytes);
    }

    #[test]
    fn flipped_bytes_of_real_files_do_not_panic(at in 0usize..400, value in any::<u8>(), cut in 0usize..400) {
        let npy = codec::encode_npy_rgb(&Rgb::from_fn(5, 4, |x, y| [x as f32, y as f32, 1.0]));
        let png = codec::encode_png(&Raster::from(ramp(9, 9))).unwrap();
        for file in [npy, png] {
            let mut bytes = file[..file.len().saturating_sub(cut % 7)].to_vec();
            let at = at % bytes.len();
            bytes[at] = value;
            let _ = codec::decode_radiance(&bytes);
            let _ = codec::decode_plane(&bytes);
        }
    }
}
