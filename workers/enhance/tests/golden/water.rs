//! IBLA and SUIR against reference pictures of water: those of `vectors/water` and, in each folder of
//! `FATHOM_GOLDEN_EXTRA`, those of `enhancement/peers.json`. The unit tests compare the intermediate planes.

use std::fs;
use std::path::{Path, PathBuf};

use enhance::{Variant, run_variant};
use imaging::Raster;
use imaging::codec::decode_picture;
use serde_json::{Map, Value};

use crate::cases;

/// Share of the samples that may differ by one code: values next to a rounding tie.
const ODD_SHARE: f64 = 0.01;
const METHODS: [&str; 3] = ["ibla", "ibla_guided", "suir"];

fn picture(path: &Path) -> Raster {
    let file = fs::read(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    decode_picture(&file).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Path of each case without file endings.
fn stems() -> Vec<PathBuf> {
    let committed = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/vectors/water");
    let extra = cases::extra().map(|folder| folder.join("enhancement"));
    let listed = |folder: PathBuf| {
        let text = fs::read(folder.join("peers.json")).ok()?;
        let cases: Map<String, Value> = serde_json::from_slice(&text).expect("an object by case");
        Some(cases.into_iter().map(move |(name, _)| folder.join(name)))
    };
    let stems: Vec<PathBuf> = [committed]
        .into_iter()
        .chain(extra)
        .filter_map(listed)
        .flatten()
        .collect();
    assert!(stems.len() >= 5, "{} of the committed cases", stems.len());
    stems
}

#[test]
fn golden_pictures_behind_water() {
    for stem in stems() {
        let file = |ending: &str| stem.with_extension(format!("{ending}.png"));
        let input = picture(&file("input"));
        for name in METHODS {
            let method = crate::method::method(name);
            let expected = picture(&file(name)).to_rgb8();
            for variant in [Variant::Fast, Variant::Reference] {
                let actual = run_variant(&method, &input, variant).expect("a result");
                let actual = actual.picture.to_rgb8();
                let case = format!("{}.{name}, {variant:?}", stem.display());
                assert_eq!(actual.data().len(), expected.data().len(), "{case}");
                let codes = actual.data().iter().zip(expected.data());
                let off: Vec<u8> = codes
                    .map(|(a, e)| a.abs_diff(*e))
                    .filter(|&off| off > 0)
                    .collect();
                let worst = off.iter().max().copied().unwrap_or(0);
                assert!(
                    worst <= 1 && off.len() as f64 <= ODD_SHARE * expected.data().len() as f64,
                    "{case}: {} samples differ, by up to {worst}",
                    off.len()
                );
            }
        }
    }
}
