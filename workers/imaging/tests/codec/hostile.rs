//! Truncated, invalid and malicious bytes.

#![allow(clippy::unwrap_used)]

use std::time::{Duration, Instant};

use imaging::codec::{self, DecodeError};
use imaging::{Plane, Raster, Rgb};
use proptest::prelude::*;

use crate::{npy, png, ramp};

#[test]
fn a_file_that_was_cut_off_is_damaged_wherever_the_cut_is() {
    let picture = ramp(40, 30);
    // Optional bytes at the end of a file: the checksum of PNG's empty last chunk, WebP's padding.
    let files = [
        (codec::encode_png(&Raster::from(picture.clone())).unwrap(), 4),
        (codec::encode_jpeg(&picture, 90).unwrap(), 0),
        (codec::encode_webp_lossless(&picture).unwrap(), 1),
        (
            codec::encode_npy_rgb(&Rgb::from_fn(5, 4, |x, y| [x as f32, y as f32, 1.0])),
            0,
        ),
    ];
    for (file, spare) in files {
        assert!(codec::decode_radiance(&file).is_ok());
        for cut in 0..file.len() - spare {
            assert!(
                codec::decode_radiance(&file[..cut]).is_err(),
                "{cut} of {}",
                file.len()
            );
        }
    }
}

#[test]
fn a_bomb_is_refused_from_its_header() {
    const RGB: u8 = 2;
    for side in [60_000, 16_000] {
        let file = [png::header(side, side, 8, RGB), png::chunk(b"IDAT", &[])].concat();
        let error = codec::decode_picture(&file).unwrap_err();
        let side = side as usize;
        assert_eq!(
            error,
            DecodeError::TooLarge {
                width: side,
                height: side
            }
        );
    }
    let mut file = codec::encode_npy_plane(&Plane::filled(1, 1, 1.0));
    let shape = file.windows(6).position(|w| w == b"(1, 1)").unwrap();
    file.splice(shape..shape + 6, *b"(99999, 9999)");
    assert!(matches!(
        codec::decode_plane(&file),
        Err(DecodeError::TooLarge { .. })
    ));
    file.splice(shape..shape + 13, *b"(16000, 4000)");
    assert!(matches!(
        codec::decode_plane(&file),
        Err(DecodeError::Damaged { .. })
    ));
}

#[test]
fn a_header_of_nested_brackets_takes_no_time() {
    let start = Instant::now();
    for bracket in ["(", "[", "{", "{1:", "(1,", "(1,("] {
        for depth in [20, 200, 1000, 15_000] {
            let text = format!("{{'descr': {}", bracket.repeat(depth));
            let text = &text[..text.len().min(60_000)];
            assert!(codec::decode_plane(&npy::file(text, &[])).is_err());
        }
    }
    assert!(start.elapsed() < Duration::from_secs(1), "{:?}", start.elapsed());
}

#[test]
fn what_is_no_picture_says_what_would_be() {
    let error = codec::decode_picture(b"GIF89a").unwrap_err();
    assert_eq!(
        error.to_string(),
        "the file is neither PNG nor JPEG nor WebP nor BMP nor TIFF"
    );
    let error = codec::decode_plane(b"\xff\xd8\xff\xe0").unwrap_err();
    assert!(
        error.to_string().contains("compression changes numbers"),
        "{error}"
    );
    let error = codec::decode_mask(b"GIF89a").unwrap_err();
    assert_eq!(
        error.to_string(),
        "the file is neither PNG nor BMP nor TIFF nor WebP nor NPY nor EXR"
    );
}

fn decode_all(bytes: &[u8]) {
    let _ = codec::decode_picture(bytes);
    let _ = codec::decode_plane(bytes);
    let _ = codec::decode_mask(bytes);
    let _ = codec::decode_radiance(bytes);
    let _ = codec::Orientation::read(bytes);
    let _ = codec::has_distances(bytes);
}

proptest! {
    #[test]
    fn no_bytes_panic(bytes in proptest::collection::vec(any::<u8>(), 0..300), head in 0usize..5) {
        let heads: [&[u8]; 5] =
            [b"", b"\x89PNG\r\n\x1a\n", b"\xff\xd8\xff\xe0", b"\x93NUMPY\x01\x00", b"RIFF\x40\0\0\0WEBPVP8L"];
        decode_all(&[heads[head], &bytes].concat());
    }

    #[test]
    fn no_header_text_panics(text in "[-'<>|(){}:, a-z0-9_]{0,120}") {
        decode_all(&npy::file(&format!("{{'descr': '<f4', 'fortran_order': False, 'shape': {text}}}"), &[0; 64]));
        decode_all(&npy::file(&text, &[0; 64]));
    }

    #[test]
    fn changed_bytes_of_real_files_do_not_panic(
        changes in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..6),
        kept in any::<prop::sample::Index>(),
    ) {
        let picture = ramp(9, 9);
        let files = [
            codec::encode_npy_rgb(&Rgb::from_fn(5, 4, |x, y| [x as f32, y as f32, 1.0])),
            codec::encode_png(&Raster::from(picture.clone())).unwrap(),
            codec::encode_jpeg(&picture, 80).unwrap(),
            codec::encode_webp_lossless(&picture).unwrap(),
        ];
        for mut bytes in files {
            for (at, value) in &changes {
                let position = at.index(bytes.len());
                bytes[position] = *value;
            }
            decode_all(&bytes);
            bytes.truncate(kept.index(bytes.len()));
            decode_all(&bytes);
        }
    }
}
