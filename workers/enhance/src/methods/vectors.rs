//! Reference cases behind water, for the tests of SUIR and IBLA.

use std::fs;
use std::path::PathBuf;

use imaging::codec::{FilePlane, decode_picture, decode_plane};
use imaging::{Plane, Rgb8};
use serde_json::Value;

use crate::variant::Variant;

/// Part of the samples that may be off, each by one code: values beside a rounding tie.
const ODD_SHARE: f64 = 0.01;
pub(super) const VARIANTS: [Variant; 2] = [Variant::Fast, Variant::Reference];
pub(super) const CASES: [&str; 4] = [
    "peers_hazy_160x120",
    "peers_green_160x120",
    "peers_blue_151x113",
    "peers_lamp_160x120",
];

pub(super) fn file(name: &str) -> Vec<u8> {
    let place: PathBuf = [env!("CARGO_MANIFEST_DIR"), "tests", "vectors", "water", name]
        .iter()
        .collect();
    fs::read(place).unwrap()
}

/// Lights and candidates by case and method.
pub(super) fn expected() -> Value {
    serde_json::from_slice(&file("peers.json")).unwrap()
}

pub(super) fn numbers<const N: usize>(value: &Value) -> [f64; N] {
    std::array::from_fn(|i| value[i].as_f64().unwrap())
}

/// Compares a plane with a stored one, within a part of the range of that.
pub(super) fn assert_plane(name: &str, actual: &Plane<f64>, tolerance: f64) {
    let FilePlane::Floats(expected) = decode_plane(&file(name)).unwrap() else {
        panic!("{name} holds no floats");
    };
    let expected = expected.map(|&value| f64::from(value));
    let (low, high) = crate::blocks::range(expected.data());
    let off = actual
        .data()
        .iter()
        .zip(expected.data())
        .map(|(a, e)| (a - e).abs());
    let worst = off.fold(0.0, f64::max);
    assert!(worst <= tolerance * (high - low), "{name}: {worst}");
}

/// Compares a picture with what a method makes of a case.
pub(super) fn assert_picture(name: &str, method: &str, actual: &Rgb8) {
    let expected = decode_picture(&file(&format!("{name}.{method}.png")))
        .unwrap()
        .to_rgb8();
    let off = actual
        .data()
        .iter()
        .zip(expected.data())
        .map(|(a, e)| a.abs_diff(*e));
    let off: Vec<u8> = off.filter(|&off| off > 0).collect();
    let worst = off.iter().max().copied().unwrap_or(0);
    let most = ODD_SHARE * expected.data().len() as f64;
    assert!(
        worst <= 1 && off.len() as f64 <= most,
        "{name} {method}: {} samples differ, by up to {worst}",
        off.len()
    );
}
