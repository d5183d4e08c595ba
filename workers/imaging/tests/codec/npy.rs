//! NPY files as written by NumPy and others.

#![allow(clippy::unwrap_used)]

use imaging::codec::{self, FilePlane, Radiance};
use imaging::{Plane, Rgb};

/// A file of version 1.0 with this header text and data.
pub(crate) fn file(header: &str, data: &[u8]) -> Vec<u8> {
    let length = (header.len() as u16).to_le_bytes();
    [b"\x93NUMPY\x01\0", &length[..], header.as_bytes(), data].concat()
}

fn header(kind: &str, fortran: &str, shape: &str) -> String {
    format!("{{'descr': '{kind}', 'fortran_order': {fortran}, 'shape': {shape}, }}\n")
}

fn plane(kind: &str, data: &[u8]) -> FilePlane {
    codec::decode_plane(&file(&header(kind, "False", "(1, 2)"), data)).unwrap()
}

#[test]
fn each_type_of_number_and_either_byte_order_is_read() {
    let floats = FilePlane::Floats(Plane::new(2, 1, vec![1.5f32, -2.0]).unwrap());
    let codes = FilePlane::Codes(Plane::new(2, 1, vec![7u16, 255]).unwrap());
    assert_eq!(
        plane("<f4", &[1.5f32.to_le_bytes(), (-2.0f32).to_le_bytes()].concat()),
        floats
    );
    assert_eq!(
        plane(">f4", &[1.5f32.to_be_bytes(), (-2.0f32).to_be_bytes()].concat()),
        floats
    );
    // 1.5 and −2 in half precision.
    assert_eq!(plane("<f2", &[0x00, 0x3e, 0x00, 0xc0]), floats);
    assert_eq!(plane(">f2", &[0x3e, 0x00, 0xc0, 0x00]), floats);
    assert_eq!(
        plane("<f8", &[1.5f64.to_le_bytes(), (-2.0f64).to_le_bytes()].concat()),
        floats
    );
    assert_eq!(plane("|u1", &[7, 255]), codes);
    assert_eq!(plane("<u2", &[7, 0, 255, 0]), codes);
    assert_eq!(plane(">u2", &[0, 7, 0, 255]), codes);
}

#[test]
fn version_two_has_a_longer_length_field() {
    let text = header("|u1", "False", "(1, 1)");
    let length = (text.len() as u32).to_le_bytes();
    let bytes = [b"\x93NUMPY\x02\0", &length[..], text.as_bytes(), &[9]].concat();
    assert_eq!(
        codec::decode_plane(&bytes).unwrap(),
        FilePlane::Codes(Plane::filled(1, 1, 9))
    );
}

#[test]
fn a_color_array_is_linear_light_of_interleaved_bands() {
    let samples: Vec<u8> = [0.5f32, 2.0, -1.0]
        .into_iter()
        .flat_map(f32::to_le_bytes)
        .collect();
    let bytes = file(&header("<f4", "False", "(1, 1, 3)"), &samples);
    let light = Rgb::from_fn(1, 1, |_, _| [0.5, 2.0, -1.0]);
    assert_eq!(codec::decode_radiance(&bytes).unwrap(), Radiance::Linear(light));
}

#[test]
fn an_array_of_another_kind_is_refused_with_what_it_is_and_what_is_needed() {
    let refused = |kind: &str, fortran: &str, shape: &str| {
        let bytes = file(&header(kind, fortran, shape), &[0; 64]);
        let errors = [
            codec::decode_plane(&bytes).err(),
            codec::decode_radiance(&bytes).err(),
        ];
        errors.map(|error| error.map(|error| error.to_string()).unwrap_or_default())
    };
    let both =
        |errors: [String; 2], text: &str| assert!(errors.iter().all(|e| e.contains(text)), "{errors:?}");
    both(refused("<f4", "False", "(4,)"), "an array of shape [4] but");
    both(
        refused("<f4", "False", "(1, 1, 1, 3)"),
        "an array of shape [1, 1, 1, 3] but",
    );
    both(refused("<f4", "False", "()"), "an array of shape [] but");
    both(refused("<f4", "False", "(0, 2)"), "empty: 2×0");
    both(refused("<f4", "False", "(1, 16385)"), "16385×1 but at most");
    both(refused("|O", "False", "(2, 2)"), "values of type |O");
    let [_, light] = refused("<i4", "False", "(1, 2, 3)");
    assert!(light.contains("integers of another type"), "{light}");
    let structured = "{'descr': [('z', '<f4')], 'fortran_order': False, 'shape': (2, 2), }\n";
    let error = codec::decode_plane(&file(structured, &[0; 16])).unwrap_err();
    assert!(error.to_string().contains("a structured array"), "{error}");
}
