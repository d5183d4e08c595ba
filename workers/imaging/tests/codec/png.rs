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
fn a_range_file_has_one_gray_channel_of_whole_bytes_and_no_alpha() {
    let refused = |bytes: &[u8]| codec::decode_plane(bytes).unwrap_err().to_string();
    let wanted = "one gray channel of 8 or 16 bits is needed";
    let color = codec::encode_png(&Raster::from(super::ramp(3, 3))).unwrap();
    assert_eq!(
        refused(&color),
        format!("the file holds a color picture but {wanted}")
    );
    let palette = file(1, 1, 8, PALETTE, &[(b"PLTE", &[1, 2, 3])], &[0, 0]);
    assert_eq!(
        refused(&palette),
        format!("the file holds a color picture but {wanted}")
    );
    let alpha = file(1, 1, 8, GRAY_ALPHA, &[], &[0, 7, 255]);
    assert_eq!(
        refused(&alpha),
        format!("the file holds a picture with alpha but {wanted}")
    );
    let narrow = file(2, 1, 4, GRAY, &[], &[0, 0x7f]);
    assert_eq!(
        refused(&narrow),
        format!("the file holds a picture of less than 8 bits but {wanted}")
    );
    assert!(codec::decode_picture(&narrow).is_ok());
}
