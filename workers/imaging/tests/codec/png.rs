//! Hand-made PNG files unlike those of the encoder.

#![allow(clippy::unwrap_used)]

use imaging::codec::{self, FilePlane};
use imaging::{Plane, Raster, Samples};

/// Color types of PNG.
const GRAY: u8 = 0;
const PALETTE: u8 = 3;
const GRAY_ALPHA: u8 = 4;

/// An uncompressed file with a valid header, these chunks and these rows, each with its filter byte.
fn file(width: u32, height: u32, depth: u8, color: u8, chunks: &[(&[u8; 4], &[u8])], rows: &[u8]) -> Vec<u8> {
    let length = (rows.len() as u16).to_le_bytes();
    let complement = (!(rows.len() as u16)).to_le_bytes();
    let stored = [
        &[0x78, 1, 1],
        &length[..],
        &complement,
        rows,
        &adler32(rows).to_be_bytes(),
    ]
    .concat();
    let mut file = header(width, height, depth, color);
    for (kind, data) in chunks
        .iter()
        .copied()
        .chain([(b"IDAT", &stored[..]), (b"IEND", &[])])
    {
        file.extend(chunk(kind, data));
    }
    file
}

/// The signature and the header chunk.
pub(crate) fn header(width: u32, height: u32, depth: u8, color: u8) -> Vec<u8> {
    let fields = [
        &width.to_be_bytes()[..],
        &height.to_be_bytes(),
        &[depth, color, 0, 0, 0],
    ]
    .concat();
    [&b"\x89PNG\r\n\x1a\n"[..], &chunk(b"IHDR", &fields)].concat()
}

pub(crate) fn chunk(kind: &[u8; 4], data: &[u8]) -> Vec<u8> {
    let body = [&kind[..], data].concat();
    let mut crc = u32::MAX;
    for &byte in &body {
        crc ^= u32::from(byte);
        for _ in 0..8 {
            crc = if crc & 1 == 1 {
                crc >> 1 ^ 0xEDB8_8320
            } else {
                crc >> 1
            };
        }
    }
    [
        &(data.len() as u32).to_be_bytes()[..],
        &body,
        &(!crc).to_be_bytes(),
    ]
    .concat()
}

fn adler32(data: &[u8]) -> u32 {
    let (low, high) = data.iter().fold((1, 0), |(low, high), &byte| {
        let low = (low + u32::from(byte)) % 65521;
        (low, (high + low) % 65521)
    });
    high << 16 | low
}

#[test]
fn a_palette_is_expanded_to_its_colors() {
    let palette: &[u8] = &[10, 20, 30, 200, 100, 50];
    let bytes = file(3, 1, 8, PALETTE, &[(b"PLTE", palette)], &[0, 1, 0, 1]);
    let picture = codec::decode_picture(&bytes).unwrap();
    assert_eq!(
        picture.to_rgb8().data(),
        &[200, 100, 50, 10, 20, 30, 200, 100, 50]
    );
    assert_eq!(picture.alpha(), None);
    let transparent: &[u8] = &[0, 255];
    let bytes = file(
        2,
        1,
        8,
        PALETTE,
        &[(b"PLTE", palette), (b"tRNS", transparent)],
        &[0, 1, 0],
    );
    let picture = codec::decode_picture(&bytes).unwrap();
    assert_eq!(picture.to_rgb8().data(), &[200, 100, 50, 10, 20, 30]);
    assert_eq!(picture.alpha(), Some(&Samples::U8(vec![255, 0])));
}

#[test]
fn sixteen_bit_codes_are_kept_in_their_order() {
    let bytes = file(2, 1, 16, GRAY, &[], &[0, 0x12, 0x34, 0xff, 0xfe]);
    let codes = Plane::new(2, 1, vec![0x1234u16, 0xfffe]).unwrap();
    assert_eq!(codec::decode_plane(&bytes).unwrap(), FilePlane::Codes(codes));
}

#[test]
fn a_mask_holds_the_index_of_a_palette_and_of_fewer_bits() {
    let palette = [(b"PLTE", &[9u8, 8, 7, 1, 2, 3, 4, 5, 6][..])];
    let bytes = file(3, 1, 8, PALETTE, &palette, &[0, 2, 0, 1]);
    assert_eq!(codec::decode_mask(&bytes).unwrap().data(), [2, 0, 1]);
    for (depth, row, numbers) in [
        (1, &[0u8, 0b0101_0000][..], [0u16, 1, 0]),
        (2, &[0, 0b11_01_10_00], [3, 1, 2]),
        (4, &[0, 0xf0, 0x70], [15, 0, 7]),
    ] {
        for color in [GRAY, PALETTE] {
            let bytes = file(3, 1, depth, color, &palette[..usize::from(color == PALETTE)], row);
            assert_eq!(
                codec::decode_mask(&bytes).unwrap().data(),
                numbers,
                "{depth} bits"
            );
        }
    }
}

#[test]
fn distances_are_gray_whatever_repeats_the_channel() {
    let gray = Plane::new(2, 1, vec![7u16, 255]).unwrap();
    let equal = Raster::new(
        2,
        1,
        imaging::Channels::Rgb,
        Samples::U8(vec![7, 7, 7, 255, 255, 255]),
        Some(Samples::U8(vec![255; 2])),
    );
    let equal = codec::encode_png(&equal.unwrap()).unwrap();
    assert_eq!(
        codec::decode_plane(&equal).unwrap(),
        FilePlane::Codes(gray.clone())
    );
    assert_eq!(codec::decode_mask(&equal).unwrap(), gray);
}

#[test]
fn what_has_more_than_one_meaning_is_refused_with_the_first_pixel() {
    let refused = |bytes: &[u8]| codec::decode_plane(bytes).unwrap_err().to_string();
    let color = codec::encode_png(&Raster::from(super::ramp(3, 3))).unwrap();
    let both = [
        refused(&color),
        codec::decode_mask(&color).unwrap_err().to_string(),
    ];
    for error in both {
        assert!(error.contains("R, G and B differ at pixel (1, 0)"), "{error}");
    }
    let palette = file(1, 1, 8, PALETTE, &[(b"PLTE", &[1, 2, 3])], &[0, 0]);
    assert!(
        refused(&palette).contains("a palette of colors"),
        "{}",
        refused(&palette)
    );
    let alpha = file(1, 1, 8, GRAY_ALPHA, &[], &[0, 7, 254]);
    assert!(
        refused(&alpha).contains("transparent at pixel (0, 0)"),
        "{}",
        refused(&alpha)
    );
}
