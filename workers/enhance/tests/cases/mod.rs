//! Reference cases: pictures with the output of every stage, and `expected.json` with their numbers.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};

use imaging::Raster;
use imaging::codec::decode_picture;
use serde_json::Value;

/// Extra folders that contain `enhancement/`, separated by ':'.
const EXTRA: &str = "FATHOM_GOLDEN_EXTRA";

/// One entry of `expected.json`.
pub(crate) struct Case {
    /// The entry's key.
    pub(crate) name: String,
    pub(crate) expected: Value,
    folder: PathBuf,
}

impl Case {
    /// The bytes of `<name>.<suffix>`.
    pub(crate) fn bytes(&self, suffix: &str) -> Vec<u8> {
        let path = self.folder.join(format!("{}.{suffix}", self.name));
        fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
    }

    /// The picture `<name>.<stage>.png`, checked against the size of the entry.
    pub(crate) fn picture(&self, stage: &str) -> Raster {
        let picture = decode_picture(&self.bytes(&format!("{stage}.png")))
            .unwrap_or_else(|error| panic!("{}.{stage}: {error}", self.name));
        let size = (picture.width() as u64, picture.height() as u64);
        let expected = (
            self.integer(&self.expected["width"]),
            self.integer(&self.expected["height"]),
        );
        assert_eq!(size, expected, "{}.{stage}", self.name);
        picture
    }

    /// An integer of the entry.
    pub(crate) fn integer(&self, value: &Value) -> u64 {
        value
            .as_u64()
            .unwrap_or_else(|| panic!("{}: {value} is no whole number", self.name))
    }

    /// The members of an object in the entry.
    pub(crate) fn members<'a>(&self, part: &'a Value) -> impl Iterator<Item = (&'a str, &'a Value)> {
        let object = part
            .as_object()
            .unwrap_or_else(|| panic!("{}: {part} is no object", self.name));
        object.iter().map(|(key, value)| (key.as_str(), value))
    }
}

/// All cases of the committed folder and of the extra ones.
///
/// # Panics
/// If a folder has no case.
pub(crate) fn all() -> Vec<Case> {
    let committed = Path::new(env!("CARGO_MANIFEST_DIR")).join("../enhance/tests/vectors/enhancement");
    let extra = extra().map(|folder| folder.join("enhancement"));
    // A folder may contain only the cases of water.
    let extra = extra.filter(|folder| folder.join("expected.json").is_file());
    [committed]
        .into_iter()
        .chain(extra)
        .flat_map(|folder| load(&folder))
        .collect()
}

/// The extra folders.
pub(crate) fn extra() -> impl Iterator<Item = PathBuf> {
    let extra = env::var(EXTRA).unwrap_or_default();
    let folders: Vec<PathBuf> = extra
        .split(':')
        .filter(|folder| !folder.is_empty())
        .map(PathBuf::from)
        .collect();
    folders.into_iter()
}

fn load(folder: &Path) -> Vec<Case> {
    let path = folder.join("expected.json");
    let text = fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    let entries: serde_json::Map<String, Value> =
        serde_json::from_slice(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    assert!(!entries.is_empty(), "{} has no case", path.display());
    entries
        .into_iter()
        .map(|(name, expected)| Case {
            name,
            expected,
            folder: folder.to_owned(),
        })
        .collect()
}
