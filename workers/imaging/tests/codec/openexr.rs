//! OpenEXR files of other programs: half and float, layers, tiles, and rejected files.

use std::io::Cursor;

use exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, Encoding, FlatSamples, Image, Layer, LayerAttributes,
    LineOrder, SmallVec, Vec2, WritableImage, f16,
};
use imaging::codec::{self, DecodeError, FilePlane, Radiance};
use imaging::{Plane, Rgb};

const SIZE: (usize, usize) = (37, 21);

/// A file with these channels, each with its values.
pub(crate) fn file(encoding: Encoding, channels: &[(&str, FlatSamples)]) -> Vec<u8> {
    let channels: SmallVec<[AnyChannel<FlatSamples>; 4]> = channels
        .iter()
        .map(|(name, samples)| AnyChannel::new(*name, samples.clone()))
        .collect();
    let layer = Layer::new(
        SIZE,
        LayerAttributes::default(),
        encoding,
        AnyChannels::sort(channels),
    );
    let mut bytes = Vec::new();
    Image::from_layer(layer)
        .write()
        .non_parallel()
        .to_buffered(Cursor::new(&mut bytes))
        .unwrap();
    bytes
}

fn floats(scale: f32) -> FlatSamples {
    FlatSamples::F32((0..SIZE.0 * SIZE.1).map(|i| scale * i as f32).collect())
}

fn halves(scale: f32) -> FlatSamples {
    FlatSamples::F16(
        (0..SIZE.0 * SIZE.1)
            .map(|i| f16::from_f32(scale * i as f32))
            .collect(),
    )
}

fn expected(samples: &FlatSamples) -> Plane<f32> {
    Plane::new(SIZE.0, SIZE.1, samples.values_as_f32().collect()).unwrap()
}

fn encoding(compression: Compression, blocks: Blocks) -> Encoding {
    Encoding {
        compression,
        blocks,
        line_order: LineOrder::Increasing,
    }
}

pub(crate) fn picture() -> Vec<u8> {
    let channels = [
        ("R", halves(0.5)),
        ("G", floats(0.25)),
        ("B", halves(2.0)),
        ("Z", floats(0.01)),
    ];
    file(encoding(Compression::ZIP16, Blocks::ScanLines), &channels)
}

#[test]
fn every_lossless_compression_gives_back_color_and_depth() {
    let blocks = [Blocks::ScanLines, Blocks::Tiles(Vec2(16, 16))];
    let compressions = [
        Compression::Uncompressed,
        Compression::RLE,
        Compression::ZIP1,
        Compression::ZIP16,
        Compression::PIZ,
    ];
    let (r, g, b, z) = (halves(0.5), floats(0.25), halves(2.0), floats(0.01));
    let rgb = Rgb::new([&r, &g, &b].map(expected)).unwrap();
    let channels = [("R", r), ("G", g), ("B", b), ("A", halves(1.0)), ("Z", z.clone())];
    for compression in compressions {
        for blocks in blocks {
            let file = file(encoding(compression, blocks), &channels);
            assert_eq!(
                codec::decode_radiance(&file).unwrap(),
                Radiance::Linear(rgb.clone()),
                "{compression:?}"
            );
            assert_eq!(
                codec::decode_plane(&file).unwrap(),
                FilePlane::Floats(expected(&z))
            );
        }
    }
}

#[test]
fn the_picture_among_the_passes_of_a_renderer_is_found() {
    let plain = encoding(Compression::ZIP16, Blocks::ScanLines);
    let passes = [
        ("ViewLayer.Combined.R", halves(1.0)),
        ("ViewLayer.Combined.G", halves(2.0)),
        ("ViewLayer.Combined.B", halves(3.0)),
        ("ViewLayer.DiffCol.R", halves(4.0)),
        ("ViewLayer.DiffCol.G", halves(4.0)),
        ("ViewLayer.DiffCol.B", halves(4.0)),
        ("ViewLayer.Depth.Z", floats(0.5)),
        ("ViewLayer.Normal.X", floats(9.0)),
        ("ViewLayer.Normal.Y", floats(9.0)),
        ("ViewLayer.Normal.Z", floats(9.0)),
    ];
    let whole = file(plain, &passes);
    let rgb = Rgb::new([1.0, 2.0, 3.0].map(|scale| expected(&halves(scale)))).unwrap();
    assert_eq!(codec::decode_radiance(&whole).unwrap(), Radiance::Linear(rgb));
    assert_eq!(
        codec::decode_plane(&whole).unwrap(),
        FilePlane::Floats(expected(&floats(0.5)))
    );
    // Without the combined picture the choice is ambiguous.
    let many = [
        &passes[3..6],
        &[
            ("Other.R", halves(1.0)),
            ("Other.G", halves(1.0)),
            ("Other.B", halves(1.0)),
        ][..],
    ]
    .concat();
    let error = codec::decode_radiance(&file(plain, &many)).unwrap_err();
    assert!(
        matches!(&error, DecodeError::Unsuitable { found, .. } if found.contains("Other.R")),
        "{error}"
    );
    // A vector component is not a depth.
    assert!(codec::decode_plane(&file(plain, &passes[7..])).is_err());
    let integers = FlatSamples::U32(vec![70_000; SIZE.0 * SIZE.1]);
    let error = codec::decode_mask(&file(plain, &[("id", integers)])).unwrap_err();
    assert!(error.to_string().contains("70000 at pixel (0, 0)"), "{error}");
}

#[test]
fn a_single_channel_of_any_name_is_the_distance() {
    let plain = encoding(Compression::ZIP16, Blocks::ScanLines);
    let distances = FilePlane::Floats(expected(&floats(0.5)));
    for channels in [
        &[("V", floats(0.5))][..],
        &[("Y", floats(0.5))],
        &[("A", floats(1.0)), ("distance", floats(0.5))],
        &[
            ("Combined.A", floats(1.0)),
            ("Combined.G", floats(1.0)),
            ("Depth.V", floats(0.5)),
        ],
        &[("B", floats(0.5)), ("G", floats(0.5)), ("R", floats(0.5))],
    ] {
        let names: Vec<&str> = channels.iter().map(|(name, _)| *name).collect();
        assert_eq!(
            codec::decode_plane(&file(plain, channels)).unwrap(),
            distances,
            "{names:?}"
        );
    }
    let two = file(plain, &[("near", floats(0.5)), ("far", floats(1.0))]);
    let error = codec::decode_plane(&two).unwrap_err().to_string();
    assert!(error.contains("near") && error.contains("far"), "{error}");
    let numbers = file(
        plain,
        &[("IndexOB.X", FlatSamples::F32(vec![3.0; SIZE.0 * SIZE.1]))],
    );
    assert_eq!(
        codec::decode_mask(&numbers).unwrap(),
        Plane::filled(SIZE.0, SIZE.1, 3)
    );
    assert!(codec::has_distances(&picture()));
    assert!(!codec::has_distances(&numbers));
}

#[test]
fn a_size_beyond_the_limits_is_refused_from_the_header() {
    let mut bytes = picture();
    let index = bytes
        .windows(10)
        .position(|window| window == b"dataWindow")
        .unwrap();
    // The name, the type `box2i`, the length and the upper left corner come before the last column.
    let last_column = index + "dataWindow\0box2i\0".len() + 4 + 8;
    bytes[last_column..last_column + 4].copy_from_slice(&[0xff, 0xff, 0, 0]);
    let error = codec::decode_radiance(&bytes).unwrap_err();
    assert!(matches!(error, DecodeError::TooLarge { .. }), "{error}");
}

/// No byte change makes the decoder panic, and no header change makes it allocate beyond the limits.
#[test]
fn damaged_files_are_errors_or_pictures_and_never_a_panic() {
    let whole = picture();
    for cut in 0..whole.len() {
        assert!(codec::decode_radiance(&whole[..cut]).is_err(), "cut at {cut}");
    }
    let mut state = 7u32;
    let mut next = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        state >> 8
    };
    for round in 0..6000 {
        let mut bytes = whole.clone();
        // The header more often than the pixels.
        let reach = if round % 4 == 0 { bytes.len() } else { 400 };
        for _ in 0..1 + round % 3 {
            let position = next() as usize % reach;
            bytes[position] = match next() % 3 {
                0 => 0,
                1 => 255,
                _ => next() as u8,
            };
        }
        let _ = codec::decode_radiance(&bytes);
        let _ = codec::decode_plane(&bytes);
    }
}
