//! Uploads of single pictures with their options.

#![allow(clippy::unwrap_used)]

use std::path::Path;

use fathom_tests::run;
use imaging::Plane;
use imaging::codec::{decode_picture, encode_jpeg, encode_npy_plane, encode_png};
use serde_json::json;

use crate::uploader::{SIZE, Uploader, distances, millimeters, picture, png};

#[test]
fn nothing_that_is_given_with_a_picture_is_ignored() {
    let uploader = Uploader::new();
    uploader.write("a.png", &png(1));
    let refused = uploader.upload("a.png", &["--unit-m", "0.001", "--invalid-code", "7"]);
    for option in ["--unit-m is for distances", "--invalid-code is for distances"] {
        assert!(refused.err.contains(option), "{option}: {}", refused.err);
    }
    let wide = uploader.upload("a.png", &["--hfov-deg", "180"]);
    assert!(
        !wide.is_complete && wide.err.contains("--hfov-deg is 180"),
        "{}",
        wide.err
    );
    uploader.write("codes.png", &millimeters(900));
    let codes = uploader.folder.path().join("codes.png");
    let unknown = uploader.upload("a.png", &["--range", codes.to_str().unwrap()]);
    assert!(
        unknown.err.contains("--unit-m") && unknown.err.contains("--invalid-code"),
        "{}",
        unknown.err
    );
    let rgba: Vec<u8> = (0..4 * SIZE.0 * SIZE.1).map(|at| (at % 251) as u8).collect();
    let mut array = b"\x93NUMPY\x01\x00".to_vec();
    let header = format!(
        "{{'descr': '|u1', 'fortran_order': False, 'shape': ({}, {}, 4), }}",
        SIZE.1, SIZE.0
    );
    let header = format!("{header:<117}\n");
    array.extend((header.len() as u16).to_le_bytes());
    array.extend(header.as_bytes());
    array.extend(&rgba);
    uploader.write("glass.npy", &array);
    let glass = uploader.upload("glass.npy", &[]);
    assert!(
        glass.is_complete && glass.err.contains("transparent in places"),
        "{}",
        glass.err
    );
}

/// A JPEG with an orientation tag.
fn tagged(tag: u8) -> Vec<u8> {
    let jpeg = encode_jpeg(&picture(7), 95).unwrap();
    let exif = [
        &b"Exif\0\0II*\0\x08\0\0\0\x01\0\x12\x01\x03\0\x01\0\0\0"[..],
        &[tag, 0, 0, 0, 0, 0, 0, 0],
    ]
    .concat();
    let length = (exif.len() as u16 + 2).to_be_bytes();
    [&jpeg[..2], &[0xff, 0xe1], &length, &exif, &jpeg[2..]].concat()
}

#[test]
fn an_orientation_tag_turns_the_picture_and_maps_of_the_stored_size() {
    let uploader = Uploader::new();
    uploader.write("tag6.jpg", &tagged(6));
    uploader.write("stored.npy", &distances(2.0));
    let shown = Plane::filled(SIZE.1, SIZE.0, 3.0f32);
    uploader.write("shown.npy", &encode_npy_plane(&shown));
    uploader.write("other.npy", &encode_npy_plane(&Plane::filled(5, 5, 3.0f32)));
    let range = |name: &str| uploader.folder.path().join(name).display().to_string();
    for map in ["stored.npy", "shown.npy"] {
        let uploaded = uploader.upload("tag6.jpg", &["--range", &range(map)]);
        let scene = &uploader.scenes(&uploaded)[0];
        assert_eq!(
            (&scene["width"], &scene["height"]),
            (&json!(16), &json!(24)),
            "{map}"
        );
        assert!(uploaded.err.contains("orientation tag 6"), "{}", uploaded.err);
    }
    let refused = uploader.upload("tag6.jpg", &["--range", &range("other.npy")]);
    assert!(
        refused.err.contains("5×5") && refused.err.contains("16×24"),
        "{}",
        refused.err
    );
    let out = uploader.place("out.png");
    let picture = range("tag6.jpg");
    let enhanced = run(&["enhance", "gray_world", &picture, "--out", out.to_str().unwrap()]);
    assert!(enhanced.status.success());
    assert_eq!(sides(&out), (16, 24));
}

#[test]
fn a_drawn_mask_blackens_the_enhanced_picture_of_its_size_alone() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| folder.path().join(name).display().to_string();
    let left_half = |width: usize| {
        let mask = Plane::from_fn(width, SIZE.1, |x, _| if x < width / 2 { 255u8 } else { 0 });
        encode_png(&mask.into()).unwrap()
    };
    std::fs::write(place("a.png"), png(1)).unwrap();
    std::fs::write(place("mask.png"), left_half(SIZE.0)).unwrap();
    std::fs::write(place("wide.png"), left_half(SIZE.0 + 1)).unwrap();
    let enhance = |method: &str, mask: &str| {
        run(&[
            "enhance",
            method,
            &place("a.png"),
            "--out",
            &place("out.png"),
            "--mask",
            &place(mask),
        ])
    };
    for (method, mask, reason) in [
        ("clahe", "wide.png", "its mask is 25×16"),
        ("clahe", "a.png", "--mask: "),
        ("clahe:mask=paper", "mask.png", "has a mask of its own"),
    ] {
        let refused = enhance(method, mask);
        let text = String::from_utf8_lossy(&refused.stderr);
        assert!(!refused.status.success() && text.contains(reason), "{text}");
        assert!(!Path::new(&place("out.png")).exists());
    }
    assert!(enhance("clahe", "mask.png").status.success());
    let masked = decode_picture(&std::fs::read(place("out.png")).unwrap())
        .unwrap()
        .to_rgb8();
    for (position, pixel) in masked.pixels().enumerate() {
        let is_kept = position % SIZE.0 < SIZE.0 / 2;
        assert_eq!(pixel != [0; 3], is_kept, "pixel {position}");
    }
}

fn sides(path: &Path) -> (usize, usize) {
    imaging::codec::read_sides(&std::fs::read(path).unwrap()).unwrap()
}
