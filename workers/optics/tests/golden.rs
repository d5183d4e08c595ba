//! Reference vectors: every folder under `tests/vectors/chain`, `tests/vectors/lamps` and `tests/vectors/realism`, and under folders
//! of the same names in each path in `FATHOM_GOLDEN_EXTRA`.
//!
//! A case is `params.json` with a `stage` and arrays in NPY. An unknown stage or parameter fails, and so does a folder without
//! cases. The cases of realism have a `kind`; those of other kinds are for other tests.

#[path = "golden/case.rs"]
mod case;
#[path = "golden/cut.rs"]
mod cut;
#[path = "golden/daylight.rs"]
mod daylight;
#[path = "golden/gates.rs"]
mod gates;
#[path = "golden/shadows.rs"]
mod shadows;
#[path = "golden/stages.rs"]
mod stages;

use std::path::{Path, PathBuf};

use case::Case;

fn places(kind: &str) -> Vec<PathBuf> {
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/vectors");
    let extra = std::env::var("FATHOM_GOLDEN_EXTRA").unwrap_or_default();
    let extra = extra
        .split(':')
        .filter(|path| !path.is_empty())
        .map(PathBuf::from)
        .collect::<Vec<_>>();
    std::iter::once(own)
        .chain(extra)
        .map(|place| place.join(kind))
        .collect()
}

fn cases(place: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(place).unwrap_or_else(|error| panic!("{}: {error}", place.display()));
    let mut folders: Vec<PathBuf> = entries
        .map(|entry| entry.expect("a readable folder").path())
        .collect();
    folders.retain(|path| path.is_dir());
    folders.sort();
    assert!(!folders.is_empty(), "{} holds no case", place.display());
    folders
}

fn check(folder: &Path) {
    let case = Case::read(folder);
    match case.text("stage").as_str() {
        "attenuation" => stages::attenuation(&case),
        "jaffe" | "simplified" => stages::scatter(&case),
        "haze" => stages::haze(&case),
        "chain" => stages::chain(&case),
        "kernel" => stages::kernel(&case),
        "airlight" => stages::airlight(&case),
        other => panic!("stage `{other}` is not known"),
    }
}

fn check_realism(folder: &Path) {
    let case = Case::open(folder);
    match case.text("kind").as_str() {
        "lamp with shadows" => shadows::lamp(&case),
        "light from above" if case.number("focal_px").is_some() => daylight::from_above(&case),
        "light from above" => daylight::by_direction(&case),
        "gated forward scatter" => gates::gated(&case),
        "pole" => gates::pole(&case),
        _ => {}
    }
}

fn pass(kind: &str, check: fn(&Path)) {
    let folders: Vec<PathBuf> = places(kind).iter().flat_map(|place| cases(place)).collect();
    let failed: Vec<&PathBuf> = std::thread::scope(|scope| {
        let checks: Vec<_> = folders
            .iter()
            .map(|folder| (folder, scope.spawn(move || check(folder))))
            .collect();
        checks
            .into_iter()
            .filter_map(|(folder, check)| check.join().is_err().then_some(folder))
            .collect()
    });
    assert!(failed.is_empty(), "failed: {failed:#?}");
}

#[test]
fn golden_chain_cases_pass() {
    pass("chain", check);
}

#[test]
fn golden_lamp_cases_pass() {
    pass("lamps", check);
}

#[test]
fn golden_realism_cases_pass() {
    pass("realism", check_realism);
}
