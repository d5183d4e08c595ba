//! Arrays of every type, order and shape with one meaning.

use imaging::codec::{self, FilePlane, Radiance};
use imaging::{Channels, Plane, Raster, Samples};

use super::npy::file;

fn array(kind: &str, is_fortran: bool, shape: &str, data: &[u8]) -> Vec<u8> {
    let order = if is_fortran { "True" } else { "False" };
    let header = format!("{{'descr': '{kind}', 'fortran_order': {order}, 'shape': {shape}, }}\n");
    file(&header, data)
}

/// The numbers in each type of NumPy that holds them.
fn in_every_type(numbers: &[u8]) -> Vec<(&'static str, Vec<u8>)> {
    fn bytes<const N: usize>(numbers: &[u8], number: impl Fn(u8) -> [u8; N]) -> Vec<u8> {
        numbers.iter().flat_map(|&value| number(value)).collect()
    }
    vec![
        ("|b1", bytes(numbers, |value| [value])),
        ("|u1", bytes(numbers, |value| [value])),
        ("|i1", bytes(numbers, |value| [value])),
        ("<u2", bytes(numbers, |value| u16::from(value).to_le_bytes())),
        (">i2", bytes(numbers, |value| i16::from(value).to_be_bytes())),
        ("<i4", bytes(numbers, |value| i32::from(value).to_le_bytes())),
        (">u4", bytes(numbers, |value| u32::from(value).to_be_bytes())),
        ("<i8", bytes(numbers, |value| i64::from(value).to_le_bytes())),
        ("<u8", bytes(numbers, |value| u64::from(value).to_le_bytes())),
        ("<f4", bytes(numbers, |value| f32::from(value).to_le_bytes())),
        ("<f8", bytes(numbers, |value| f64::from(value).to_le_bytes())),
    ]
}

#[test]
fn a_mask_of_every_type_order_and_shape_holds_the_same_numbers() {
    let mask = Plane::new(3, 2, vec![0u16, 1, 1, 0, 0, 1]).unwrap();
    for (kind, data) in in_every_type(&[0, 1, 1, 0, 0, 1]) {
        for shape in ["(2, 3)", "(2, 3, 1)"] {
            let bytes = array(kind, false, shape, &data);
            assert_eq!(codec::decode_mask(&bytes).unwrap(), mask, "{kind} {shape}");
        }
    }
    for (kind, data) in in_every_type(&[0, 0, 1, 0, 1, 1]) {
        let bytes = array(kind, true, "(2, 3)", &data);
        assert_eq!(
            codec::decode_mask(&bytes).unwrap(),
            mask,
            "{kind} in Fortran order"
        );
    }
}

#[test]
fn a_number_that_no_mask_can_hold_is_named() {
    for (kind, data, value) in [
        ("<i8", 65_536i64.to_le_bytes().to_vec(), "65536"),
        ("<i4", (-1i32).to_le_bytes().to_vec(), "-1"),
        ("<f4", 0.5f32.to_le_bytes().to_vec(), "0.5"),
        ("<f8", f64::NAN.to_le_bytes().to_vec(), "NaN"),
    ] {
        let error = codec::decode_mask(&array(kind, false, "(1, 1)", &data))
            .unwrap_err()
            .to_string();
        assert!(error.contains(&format!("{value} at pixel (0, 0)")), "{error}");
    }
}

#[test]
fn wide_integers_are_distances_of_their_value() {
    let data: Vec<u8> = [70_000i32, -1]
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect();
    let wide = FilePlane::Wide(Plane::new(2, 1, vec![70_000, -1]).unwrap());
    assert_eq!(
        codec::decode_plane(&array("<i4", false, "(1, 2)", &data)).unwrap(),
        wide
    );
    let narrow: Vec<u8> = [7i64, 65_535]
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .collect();
    let codes = FilePlane::Codes(Plane::new(2, 1, vec![7, 65_535]).unwrap());
    assert_eq!(
        codec::decode_plane(&array("<i8", false, "(1, 2)", &narrow)).unwrap(),
        codes
    );
}

#[test]
fn arrays_of_codes_are_pictures_like_their_png() {
    let codes: Vec<u8> = (0..18).map(|code| code * 14).collect();
    let raster = Raster::new(3, 2, Channels::Rgb, Samples::U8(codes.clone()), None).unwrap();
    let picture = Radiance::Encoded(raster.clone());
    assert_eq!(
        codec::decode_radiance(&array("|u1", false, "(2, 3, 3)", &codes)).unwrap(),
        picture
    );
    assert_eq!(
        codec::decode_radiance(&codec::encode_png(&raster).unwrap()).unwrap(),
        picture
    );
    let gray = Raster::new(3, 2, Channels::Gray, Samples::U8(codes[..6].to_vec()), None).unwrap();
    for shape in ["(2, 3)", "(2, 3, 1)"] {
        let bytes = array("|u1", false, shape, &codes[..6]);
        assert_eq!(
            codec::decode_radiance(&bytes).unwrap(),
            Radiance::Encoded(gray.clone())
        );
    }
}
