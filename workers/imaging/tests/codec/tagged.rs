//! BMP and TIFF files as other programs write them.

use std::io::Cursor;

use image::ExtendedColorType;
use image::codecs::bmp::BmpEncoder;
use imaging::codec::{self, FilePlane, Radiance};
use imaging::{Plane, Rgb};
use tiff::encoder::colortype::{self, ColorType};
use tiff::encoder::{Compression, TiffEncoder};
use tiff::tags::Tag;

fn tiff<C: ColorType>(size: (u32, u32), compression: Compression, data: &[C::Inner]) -> Vec<u8>
where
    [C::Inner]: tiff::encoder::TiffValue,
{
    let mut file = Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut file).unwrap().with_compression(compression);
    encoder.write_image::<C>(size.0, size.1, data).unwrap();
    file.into_inner()
}

#[test]
fn float_tiff_is_distances_and_linear_light() {
    let values = [1.5f32, 2.0, f32::NAN, 4.25, 5.0, 6.0];
    for compression in [Compression::Uncompressed, Compression::Lzw, Compression::Packbits] {
        let bytes = tiff::<colortype::Gray32Float>((3, 2), compression, &values);
        let FilePlane::Floats(plane) = codec::decode_plane(&bytes).unwrap() else {
            panic!("floats");
        };
        assert_eq!((plane.size(), plane.data()[3]), ((3, 2), 4.25));
    }
    let bytes = tiff::<colortype::RGB32Float>((2, 1), Compression::Lzw, &[0.5, 2.0, 3.0, 4.0, 5.0, 6.0]);
    let light = Rgb::from_fn(2, 1, |x, _| [[0.5, 2.0, 3.0], [4.0, 5.0, 6.0]][x]);
    assert_eq!(codec::decode_radiance(&bytes).unwrap(), Radiance::Linear(light));
    assert_eq!(codec::read_sides(&bytes), Some((2, 1)));
}

#[test]
fn integer_tiff_is_a_mask_and_distances() {
    let bytes = tiff::<colortype::Gray16>((2, 1), Compression::Lzw, &[7, 1000]);
    assert_eq!(codec::decode_mask(&bytes).unwrap().data(), [7, 1000]);
    let bytes = tiff::<colortype::Gray32>((2, 1), Compression::Uncompressed, &[7, 100_000]);
    let wide = FilePlane::Wide(Plane::new(2, 1, vec![7, 100_000]).unwrap());
    assert_eq!(codec::decode_plane(&bytes).unwrap(), wide);
    assert!(
        codec::decode_mask(&bytes)
            .unwrap_err()
            .to_string()
            .contains("100000")
    );
}

#[test]
fn the_palette_of_a_tiff_gives_numbers_and_colors() {
    let mut file = Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut file).unwrap();
    let mut image = encoder.new_image::<colortype::Gray8>(3, 1).unwrap();
    let mut map = vec![0u16; 768];
    (map[2], map[256 + 2], map[512 + 2]) = (0xaaff, 0xbbff, 0xccff);
    image.encoder().write_tag(Tag::ColorMap, &map[..]).unwrap();
    image.write_data(&[2, 0, 2]).unwrap();
    let mut bytes = file.into_inner();
    // The encoder writes no palettes: declare the gray codes as indices.
    let gray = [6u8, 1, 3, 0, 1, 0, 0, 0, 1, 0];
    let position = bytes.windows(10).position(|window| window == gray).unwrap();
    bytes[position + 8] = 3;
    assert_eq!(codec::decode_mask(&bytes).unwrap().data(), [2, 0, 2]);
    let picture = codec::decode_picture(&bytes).unwrap().to_rgb8();
    assert_eq!(
        (picture.pixel(0, 0), picture.pixel(1, 0)),
        ([0xaa, 0xbb, 0xcc], [0; 3])
    );
}

#[test]
fn bmp_is_a_picture_and_its_indices_a_mask() {
    let mut color = Vec::new();
    let codes: Vec<u8> = (1..=12).collect();
    BmpEncoder::new(&mut color)
        .encode(&codes, 2, 2, ExtendedColorType::Rgb8)
        .unwrap();
    assert_eq!(codec::decode_picture(&color).unwrap().to_rgb8().data(), codes);
    assert_eq!(codec::read_sides(&color), Some((2, 2)));
    let mut indexed = Vec::new();
    let palette = [[9, 8, 7], [1, 2, 3], [4, 5, 6]];
    BmpEncoder::new(&mut indexed)
        .encode_with_palette(&[2, 0, 1, 1], 2, 2, ExtendedColorType::L8, Some(&palette))
        .unwrap();
    assert_eq!(codec::decode_mask(&indexed).unwrap().data(), [2, 0, 1, 1]);
    assert_eq!(
        codec::decode_picture(&indexed).unwrap().to_rgb8().pixel(0, 0),
        [4, 5, 6]
    );
    assert!(
        codec::decode_plane(&indexed)
            .unwrap_err()
            .to_string()
            .contains("palette")
    );
}

/// A BMP file of 5×2 pixels with `bits` per index, uncompressed, bottom row first.
fn packed_bmp(bits: u16, palette: &[[u8; 3]], rows: &[[u8; 4]; 2]) -> Vec<u8> {
    let begin = 54 + 4 * palette.len() as u32;
    let mut file = b"BM".to_vec();
    for field in [begin + 8, 0, begin, 40, 5, 2] {
        file.extend(field.to_le_bytes());
    }
    file.extend([1u16, bits].into_iter().flat_map(u16::to_le_bytes));
    for field in [0, 8, 2835, 2835, palette.len() as u32, 0] {
        file.extend(field.to_le_bytes());
    }
    for [r, g, b] in palette {
        file.extend([*b, *g, *r, 0]);
    }
    file.extend(rows.iter().flatten());
    file
}

#[test]
fn indices_of_less_than_a_byte_are_a_mask() {
    let palette = [[0, 0, 0], [255, 255, 255]];
    let bit = packed_bmp(1, &palette, &[[0b1010_1000, 0, 0, 0], [0b0100_0000, 0, 0, 0]]);
    assert_eq!(
        codec::decode_mask(&bit).unwrap().data(),
        [0, 1, 0, 0, 0, 1, 0, 1, 0, 1]
    );
    let shown = codec::decode_picture(&bit).unwrap().to_rgb8();
    assert_eq!((shown.pixel(0, 0), shown.pixel(1, 0)), ([0; 3], [255; 3]));
    // Two indices of one color stay apart.
    let palette = [[0, 0, 0], [9, 8, 7], [9, 8, 7], [4, 5, 6]];
    let nibble = packed_bmp(4, &palette, &[[0x12, 0x30, 0x10, 0], [0x33, 0x21, 0x00, 0]]);
    assert_eq!(
        codec::decode_mask(&nibble).unwrap().data(),
        [3, 3, 2, 1, 0, 1, 2, 3, 0, 1]
    );
    assert!(codec::decode_mask(&nibble[..nibble.len() - 1]).is_err());
}

#[test]
fn damaged_bmp_and_tiff_are_errors_or_pictures_and_never_a_panic() {
    let mut bmp = Vec::new();
    let codes = [7u8; 12];
    BmpEncoder::new(&mut bmp)
        .encode(&codes, 2, 2, ExtendedColorType::Rgb8)
        .unwrap();
    for file in [
        bmp,
        packed_bmp(4, &[[0; 3], [9; 3]], &[[0x10; 4]; 2]),
        tiff::<colortype::Gray16>((2, 1), Compression::Lzw, &[7, 1000]),
    ] {
        for place in 0..file.len() {
            let _ = codec::decode_radiance(&file[..place]);
            for value in [0, 1, 0x7f, 0xff] {
                let mut changed = file.clone();
                changed[place] = value;
                let _ = codec::decode_radiance(&changed);
                let _ = codec::decode_mask(&changed);
                let _ = codec::read_sides(&changed);
            }
        }
    }
}
