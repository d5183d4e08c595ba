//! Reference cases in water, for the tests of SUIR and IBLA.

use imaging::codec::{FilePlane, decode_picture, decode_plane};
use imaging::{Plane, Rgb8};
use serde_json::Value;

use crate::variant::Variant;

/// Share of the samples that may differ by one code: values next to a rounding tie.
const ODD_SHARE: f64 = 0.01;
pub(super) const VARIANTS: [Variant; 2] = [Variant::Fast, Variant::Reference];

/// A case with its files by kind.
type Case = (&'static str, [(&'static str, &'static [u8]); 7]);

macro_rules! case {
    ($name:literal) => {
        (
            $name,
            [
                ("input.png", file!($name, ".input.png")),
                ("ibla.png", file!($name, ".ibla.png")),
                ("ibla_guided.png", file!($name, ".ibla_guided.png")),
                ("ibla_blur.npy", file!($name, ".ibla_blur.npy")),
                ("ibla_closeness.npy", file!($name, ".ibla_closeness.npy")),
                ("suir.png", file!($name, ".suir.png")),
                ("suir_exposure.npy", file!($name, ".suir_exposure.npy")),
            ],
        )
    };
}

macro_rules! file {
    ($name:literal, $kind:literal) => {
        include_bytes!(concat!("../../tests/vectors/water/", $name, $kind)).as_slice()
    };
}

const CASES: [Case; 4] = [
    case!("peers_hazy_160x120"),
    case!("peers_green_160x120"),
    case!("peers_blue_151x113"),
    case!("peers_lamp_160x120"),
];

pub(super) fn cases() -> impl Iterator<Item = &'static str> {
    CASES.iter().map(|(name, _)| *name)
}

pub(super) fn file(case: &str, kind: &str) -> &'static [u8] {
    let (_, files) = CASES.iter().find(|(name, _)| *name == case).unwrap();
    files.iter().find(|(name, _)| *name == kind).unwrap().1
}

/// Lights and candidates by case and method.
pub(super) fn expected() -> Value {
    serde_json::from_slice(file!("peers", ".json")).unwrap()
}

pub(super) fn numbers<const N: usize>(value: &Value) -> [f64; N] {
    std::array::from_fn(|i| value[i].as_f64().unwrap())
}

/// Compares a plane with a stored one, relative to the stored range.
pub(super) fn assert_plane(case: &str, kind: &str, actual: &Plane<f64>, tolerance: f64) {
    let FilePlane::Floats(expected) = decode_plane(file(case, kind)).unwrap() else {
        panic!("{case}.{kind} holds no floats");
    };
    let expected = expected.map(|&value| f64::from(value));
    let (low, high) = crate::blocks::range(expected.data());
    let off = actual
        .data()
        .iter()
        .zip(expected.data())
        .map(|(a, e)| (a - e).abs());
    let worst = off.fold(0.0, f64::max);
    assert!(worst <= tolerance * (high - low), "{case}.{kind}: {worst}");
}

/// Compares a picture with the stored output of a method.
pub(super) fn assert_picture(case: &str, method: &str, actual: &Rgb8) {
    let expected = decode_picture(file(case, &format!("{method}.png")))
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
        "{case} {method}: {} samples differ, by up to {worst}",
        off.len()
    );
}
