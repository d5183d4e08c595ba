//! The compared methods against an independent program, written in NumPy from their formulas
//! (`vectors/peers/reference.py`).

#![allow(clippy::unwrap_used)]

#[path = "cases/method.rs"]
mod method;

use std::fs;
use std::path::Path;

use enhance::{Variant, run_variant};
use imaging::Raster;
use imaging::codec::decode_picture;

/// Share of the codes that may differ by one: values next to a rounding tie.
const SHARE: f64 = 0.005;

fn picture(path: &Path) -> Raster {
    decode_picture(&fs::read(path).unwrap()).unwrap()
}

#[test]
fn golden_results_of_the_compared_methods() {
    let vectors = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/vectors");
    let mut compared = 0;
    for entry in fs::read_dir(vectors.join("peers")).unwrap() {
        let path = entry.unwrap().path();
        let file = path.file_name().unwrap().to_str().unwrap().to_owned();
        let Some((name, method)) = file.strip_suffix(".png").and_then(|stem| stem.split_once('.')) else {
            continue;
        };
        let method = method::method(method);
        let input = picture(&vectors.join(format!("enhancement/{name}.input.png")));
        let expected = picture(&path).to_rgb8();
        for variant in [Variant::Fast, Variant::Reference] {
            let actual = run_variant(&method, &input, variant).unwrap().picture.to_rgb8();
            let codes = actual.data().iter().zip(expected.data());
            let off: Vec<u8> = codes
                .map(|(a, b)| a.abs_diff(*b))
                .filter(|&off| off > 0)
                .collect();
            let worst = off.iter().max().copied().unwrap_or(0);
            assert!(
                worst <= 1 && off.len() as f64 <= SHARE * expected.data().len() as f64,
                "{file}, {variant:?}: {} of {} codes differ, by up to {worst}",
                off.len(),
                expected.data().len()
            );
        }
        compared += 1;
    }
    assert_eq!(compared, 8 * 9, "eight pictures, nine methods");
}
