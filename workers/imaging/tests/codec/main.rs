//! Encoding and decoding of files, and rejection of other bytes.

#![allow(clippy::unwrap_used)]

mod arrays;
mod hostile;
mod npy;
mod openexr;
mod orientation;
mod png;
mod profiles;
mod tagged;

use imaging::codec::{self, FilePlane, Radiance};
use imaging::{Channels, Plane, Raster, Rgb, Rgb8, Samples};
use sha2::{Digest, Sha256};

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
fn texts_stand_in_a_png_beside_the_same_pixels() {
    let codes = Plane::new(2, 1, vec![7u16, 65535]).unwrap();
    let raster = Raster::from(codes.clone());
    let file = codec::encode_png_with_text(&raster, &[("Unit", "mm")]).unwrap();
    let chunk = b"tEXtUnit\0mm";
    assert!(file.windows(chunk.len()).any(|bytes| bytes == chunk));
    assert_eq!(codec::decode_plane(&file).unwrap(), FilePlane::Codes(codes));
    assert_eq!(
        codec::encode_png_with_text(&raster, &[]).unwrap(),
        codec::encode_png(&raster).unwrap()
    );
    assert!(codec::encode_png_with_text(&raster, &[("", "mm")]).is_err());
    assert!(codec::encode_png_with_text(&raster, &[("Unit", "µm→")]).is_err());
}

#[test]
fn an_empty_picture_has_no_file() {
    let empty = Rgb8::new(0, 3, Vec::new()).unwrap();
    assert!(codec::encode_png(&Raster::from(empty.clone())).is_err());
    assert!(codec::encode_webp_lossless(&empty).is_err());
    assert!(codec::encode_jpeg(&empty, 90).is_err());
}

/// Sides, then the JPEG files at 1, 50, 95 and 100, the PNG and the WebP: their lengths and the first bytes of their
/// SHA-256, as written by the `image` crate 0.25.10.
type Written = (usize, usize, [(usize, u32); 6]);
const WRITTEN: [Written; 5] = [
    (
        1,
        1,
        [
            (628, 0xfa3914fe),
            (629, 0x8ecaefde),
            (631, 0xf8b096fe),
            (632, 0xab17e192),
            (72, 0x432ac082),
            (34, 0x4b42ffc5),
        ],
    ),
    (
        7,
        5,
        [
            (629, 0xf4f985d1),
            (643, 0x04c71829),
            (715, 0x09a2a65c),
            (802, 0xcf8e646d),
            (178, 0x7eddf718),
            (200, 0xc3399031),
        ],
    ),
    (
        17,
        9,
        [
            (641, 0x94f9d27a),
            (690, 0x3d08d4aa),
            (836, 0x0c2a8185),
            (957, 0x233bbec0),
            (395, 0x1c6674df),
            (352, 0x54dfb601),
        ],
    ),
    (
        64,
        48,
        [
            (783, 0xbb5c42a9),
            (1725, 0x182023c2),
            (4634, 0x182ce598),
            (7738, 0xc4e081a7),
            (6326, 0x2b2d4a0d),
            (5186, 0x50444a36),
        ],
    ),
    (
        301,
        203,
        [
            (6496, 0xbc20a88f),
            (38357, 0x538af74f),
            (123725, 0x7662e102),
            (216056, 0xef92e881),
            (148952, 0x2af7a434),
            (126780, 0x0847f583),
        ],
    ),
];

#[test]
fn files_keep_their_bytes_from_one_version_to_the_next() {
    for (width, height, expected) in WRITTEN {
        let picture = busy(width, height);
        let jpeg = |quality| codec::encode_jpeg(&picture, quality).unwrap();
        let png = codec::encode_png(&Raster::from(picture.clone())).unwrap();
        let webp = codec::encode_webp_lossless(&picture).unwrap();
        let files = [jpeg(1), jpeg(50), jpeg(95), jpeg(100), png, webp];
        let written = files.map(|file| {
            let digest = Sha256::digest(&file);
            (file.len(), u32::from_be_bytes(digest[..4].try_into().unwrap()))
        });
        assert_eq!(written, expected, "{width}×{height}");
    }
}

/// Ramps, and squares of noise.
fn busy(width: usize, height: usize) -> Rgb8 {
    let mut state = 1u32;
    let mut noise = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 24) as u8
    };
    Rgb8::from_fn(width, height, |x, y| {
        let code = noise();
        let third = if (x / 8 + y / 8) % 2 == 0 { code } else { 200 };
        [(3 * x + y) as u8, (x * y / 3) as u8, third]
    })
}
