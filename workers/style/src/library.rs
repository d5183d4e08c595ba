//! The known style models: the shipped ones, which are part of the program, and those of a folder.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

/// What is known of a model.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Card {
    /// Name by which jobs ask for it.
    pub name: String,
    /// SHA-256 of the ONNX file, lower-case hex.
    pub sha256: String,
    /// What kind of network it is.
    #[serde(default)]
    pub architecture: String,
    /// What it was trained on.
    #[serde(default = "unknown")]
    pub source: String,
    /// Under what terms it may be used.
    #[serde(default = "unknown")]
    pub licence: String,
    /// Its inputs.
    #[serde(default)]
    pub inputs: Vec<String>,
    /// Its outputs.
    #[serde(default)]
    pub outputs: Vec<String>,
    /// What a user should know.
    #[serde(default)]
    pub caveats: Vec<String>,
}

fn unknown() -> String {
    "unknown".to_owned()
}

/// A model with its card.
#[derive(Debug, Clone)]
pub struct StyleModel {
    /// Name by which jobs ask for it.
    pub name: String,
    /// The ONNX file.
    pub onnx: Cow<'static, [u8]>,
    /// What is known of it.
    pub card: Card,
}

/// A folder or card that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum LibraryError {
    /// A file cannot be read.
    #[error("{}: {source}", path.display())]
    Read {
        /// The file or folder.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A card is not in its form.
    #[error("card `{name}`: {reason}")]
    Card {
        /// The model.
        name: String,
        /// What is wrong.
        reason: String,
    },
    /// A file name that cannot be a model's name.
    #[error("{}: the name of a style has 1 to 64 of a-z, 0-9, _ and -", path.display())]
    Name {
        /// The file.
        path: PathBuf,
    },
    /// Two models of one name.
    #[error("{}: there is already a style `{name}`", path.display())]
    Twice {
        /// The second file.
        path: PathBuf,
        /// The name.
        name: String,
    },
}

/// The shipped models: (name, ONNX, card).
const SHIPPED: [(&str, &[u8], &str); 3] = [
    (
        "atlantic",
        include_bytes!("../../../models/atlantic.onnx"),
        include_str!("../../../models/atlantic.card.json"),
    ),
    (
        "mediterranean",
        include_bytes!("../../../models/mediterranean.onnx"),
        include_str!("../../../models/mediterranean.card.json"),
    ),
    (
        "muddy",
        include_bytes!("../../../models/muddy.onnx"),
        include_str!("../../../models/muddy.card.json"),
    ),
];

/// Models by name; cheap to clone.
#[derive(Debug, Clone)]
pub struct Library {
    models: BTreeMap<String, Arc<StyleModel>>,
}

impl Library {
    /// The shipped models.
    ///
    /// # Errors
    /// [`LibraryError::Card`] when a shipped card does not fit its model.
    pub fn embedded() -> Result<Self, LibraryError> {
        let mut models = BTreeMap::new();
        for (name, onnx, card) in SHIPPED {
            let card = card_of(name, onnx, Some(card))?;
            models.insert(
                name.to_owned(),
                Arc::new(StyleModel {
                    name: name.to_owned(),
                    onnx: onnx.into(),
                    card,
                }),
            );
        }
        Ok(Self { models })
    }

    /// Adds every `NAME.onnx` of a folder, with `NAME.card.json` where there is one.
    ///
    /// # Errors
    /// [`LibraryError`] naming the file.
    pub fn with_dir(mut self, folder: &Path) -> Result<Self, LibraryError> {
        let read = |path: &Path, source| LibraryError::Read {
            path: path.to_owned(),
            source,
        };
        let mut files = Vec::new();
        for entry in std::fs::read_dir(folder).map_err(|error| read(folder, error))? {
            let path = entry.map_err(|error| read(folder, error))?.path();
            if path.extension().is_some_and(|extension| extension == "onnx") {
                files.push(path);
            }
        }
        files.sort();
        for path in files {
            let name = path
                .file_stem()
                .and_then(|stem| stem.to_str())
                .unwrap_or_default()
                .to_owned();
            let allowed = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_' || c == '-';
            if name.is_empty() || name.len() > 64 || !name.chars().all(allowed) {
                return Err(LibraryError::Name { path });
            }
            if self.models.contains_key(&name) {
                return Err(LibraryError::Twice { path, name });
            }
            let onnx = std::fs::read(&path).map_err(|error| read(&path, error))?;
            let card_path = path.with_extension("card.json");
            let card = match std::fs::read_to_string(&card_path) {
                Ok(text) => Some(text),
                Err(error) if error.kind() == std::io::ErrorKind::NotFound => None,
                Err(error) => return Err(read(&card_path, error)),
            };
            let card = card_of(&name, &onnx, card.as_deref())?;
            self.models.insert(
                name.clone(),
                Arc::new(StyleModel {
                    name,
                    onnx: onnx.into(),
                    card,
                }),
            );
        }
        Ok(self)
    }

    /// The names, in order.
    #[must_use]
    pub fn names(&self) -> Vec<&str> {
        self.models.keys().map(String::as_str).collect()
    }

    /// The model of a name.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<&StyleModel> {
        self.models.get(name).map(Arc::as_ref)
    }
}

/// The card of a model, checked against its bytes; a model without one gets one that says so.
fn card_of(name: &str, onnx: &[u8], card: Option<&str>) -> Result<Card, LibraryError> {
    let sha256: String = Sha256::digest(onnx)
        .iter()
        .map(|byte| format!("{byte:02x}"))
        .collect();
    let wrong = |reason: String| LibraryError::Card {
        name: name.to_owned(),
        reason,
    };
    let Some(text) = card else {
        let caveats = vec!["it came without a card".to_owned()];
        let (inputs, outputs) = (Vec::new(), Vec::new());
        let name = name.to_owned();
        return Ok(Card {
            name,
            sha256,
            architecture: unknown(),
            source: unknown(),
            licence: unknown(),
            inputs,
            outputs,
            caveats,
        });
    };
    let card: Card = serde_json::from_str(text).map_err(|error| wrong(error.to_string()))?;
    if card.name != name {
        return Err(wrong(format!("it names `{}`", card.name)));
    }
    if card.sha256 != sha256 {
        return Err(wrong(format!(
            "it gives the digest {} but the file has {sha256}",
            card.sha256
        )));
    }
    Ok(card)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shipped_cards_fit_their_models() {
        let library = Library::embedded().unwrap();
        assert_eq!(library.names(), ["atlantic", "mediterranean", "muddy"]);
        assert!(
            library
                .names()
                .iter()
                .all(|name| library.get(name).unwrap().card.licence == "MIT OR Apache-2.0")
        );
    }

    #[test]
    fn a_folder_adds_models_and_says_what_is_wrong_with_its_files() {
        let folder = tempfile::tempdir().unwrap();
        let with = |name: &str, bytes: &[u8]| std::fs::write(folder.path().join(name), bytes).unwrap();
        with("harbour.onnx", b"model");
        with("notes.txt", b"ignored");
        let library = Library::embedded().unwrap().with_dir(folder.path()).unwrap();
        assert_eq!(library.get("harbour").unwrap().card.licence, "unknown");
        with("harbour.card.json", b"{\"name\": \"harbour\", \"sha256\": \"0\"}");
        let error = Library::embedded().unwrap().with_dir(folder.path()).unwrap_err();
        assert!(error.to_string().contains("gives the digest 0"), "{error}");
        std::fs::remove_file(folder.path().join("harbour.card.json")).unwrap();
        with("muddy.onnx", b"model");
        assert!(matches!(
            Library::embedded().unwrap().with_dir(folder.path()),
            Err(LibraryError::Twice { .. })
        ));
        std::fs::rename(
            folder.path().join("muddy.onnx"),
            folder.path().join("Bad Name.onnx"),
        )
        .unwrap();
        assert!(matches!(
            Library::embedded().unwrap().with_dir(folder.path()),
            Err(LibraryError::Name { .. })
        ));
        let missing = folder.path().join("missing");
        assert!(matches!(
            Library::embedded().unwrap().with_dir(&missing),
            Err(LibraryError::Read { .. })
        ));
    }
}
