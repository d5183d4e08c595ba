//! The available style models: the shipped ones, which are compiled in, and those of a folder.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::card::ModelCard;
use crate::net;
use crate::role::ModelRole;

/// Largest ONNX file: the shipped ones have 43 KB, the largest known style network has 7 MB.
const MAX_MODEL_BYTES: u64 = 256 << 20;
/// Longest name of a model.
const MAX_NAME_CHARS: usize = 64;

/// A model with its card.
#[derive(Debug, Clone)]
pub struct StyleModel {
    /// Name in job descriptions.
    pub name: String,
    /// The ONNX file.
    pub onnx: Cow<'static, [u8]>,
    /// Its card.
    pub card: ModelCard,
}

impl StyleModel {
    /// A model without a card.
    #[must_use]
    pub fn without_card(name: &str, onnx: Vec<u8>) -> Self {
        Self {
            name: name.to_owned(),
            card: ModelCard::absent(name, &onnx),
            onnx: onnx.into(),
        }
    }

    /// Whether it requires ONNX Runtime: enhancers, metrics, and styles of any architecture other than that of the shipped and
    /// locally trained waters.
    #[must_use]
    pub fn needs_runtime(&self) -> bool {
        self.card.role != ModelRole::Style || net::onnx::read(&self.onnx).is_none()
    }
}

/// A folder, model or card that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum LibraryError {
    /// A file or the folder cannot be read.
    #[error("{} cannot be read: {source}", path.display())]
    Read {
        /// The file or folder.
        path: PathBuf,
        /// Cause.
        source: io::Error,
    },
    /// A model that is too large.
    #[error("{} has {bytes} bytes but a style model may have {MAX_MODEL_BYTES}", path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Its size.
        bytes: u64,
    },
    /// An invalid card, or one of another model.
    #[error("{} cannot be used: {reason}", path.display())]
    Card {
        /// Path of the card.
        path: PathBuf,
        /// Cause.
        reason: String,
    },
    /// A file name that is not a valid model name.
    #[error("{}: the name of a style has 1 to {MAX_NAME_CHARS} characters of a-z, 0-9, _ and -", path.display())]
    Name {
        /// The file.
        path: PathBuf,
    },
    /// Two models with the same name.
    #[error("{}: there is already a style `{name}`", path.display())]
    Twice {
        /// The second file.
        path: PathBuf,
        /// The name.
        name: String,
    },
}

macro_rules! shipped {
    ($($name:literal),*) => {
        [$((
            $name,
            include_bytes!(concat!("../../../models/", $name, ".onnx")),
            include_str!(concat!("../../../models/", $name, ".card.json")),
        )),*]
    };
}

/// The shipped models: name, ONNX file, card.
const SHIPPED: [(&str, &[u8], &str); 4] = shipped!("atlantic", "atlantic-range", "mediterranean", "muddy");

/// Models by name; cheap to clone.
#[derive(Debug, Clone)]
pub struct Library {
    models: BTreeMap<String, Arc<StyleModel>>,
}

impl Library {
    /// The shipped models.
    ///
    /// # Errors
    /// [`LibraryError::Card`] if a shipped card does not fit its model.
    pub fn embedded() -> Result<Self, LibraryError> {
        let mut library = Self {
            models: BTreeMap::new(),
        };
        for (name, onnx, card) in SHIPPED {
            let path = Path::new("models").join(name).with_extension("onnx");
            library.add(name, &path, onnx.into(), Some(card))?;
        }
        Ok(library)
    }

    /// Adds every `NAME.onnx` of a folder, with `NAME.card.json` if present.
    ///
    /// # Errors
    /// [`LibraryError`] with the path.
    pub fn with_dir(mut self, folder: &Path) -> Result<Self, LibraryError> {
        for path in model_files(folder)? {
            let stem = path.file_stem().and_then(|stem| stem.to_str());
            let name = stem.unwrap_or_default().to_owned();
            let bytes = fs::metadata(&path).map_err(unreadable(&path))?.len();
            self.check(&name, &path, bytes)?;
            let onnx = fs::read(&path).map_err(unreadable(&path))?;
            let card = match fs::read_to_string(path.with_extension("card.json")) {
                Ok(text) => Some(text),
                Err(error) if error.kind() == io::ErrorKind::NotFound => None,
                Err(error) => return Err(unreadable(&path.with_extension("card.json"))(error)),
            };
            self.add(&name, &path, onnx.into(), card.as_deref())?;
        }
        Ok(self)
    }

    /// Adds a model received over the network: its file, and its card as JSON if it has one.
    ///
    /// # Errors
    /// [`LibraryError`] with the path that it would have in a folder.
    pub fn with_model(mut self, name: &str, onnx: Vec<u8>, card: Option<&str>) -> Result<Self, LibraryError> {
        let path = PathBuf::from(format!("{name}.onnx"));
        self.check(name, &path, onnx.len() as u64)?;
        self.add(name, &path, onnx.into(), card)?;
        Ok(self)
    }

    /// The names, sorted.
    #[must_use]
    pub fn names(&self) -> Vec<&str> {
        self.models.keys().map(String::as_str).collect()
    }

    /// The models, sorted by name.
    pub fn models(&self) -> impl Iterator<Item = &StyleModel> {
        self.models.values().map(Arc::as_ref)
    }

    /// The models of a role, sorted by name.
    pub fn of_role(&self, role: ModelRole) -> impl Iterator<Item = &StyleModel> {
        self.models().filter(move |model| model.card.role == role)
    }

    /// Whether a model of this name requires ONNX Runtime; false for an unknown name.
    #[must_use]
    pub fn needs_runtime(&self, name: &str) -> bool {
        self.get(name).is_some_and(StyleModel::needs_runtime)
    }

    /// The model of a name.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<&StyleModel> {
        self.models.get(name).map(Arc::as_ref)
    }

    /// A shared handle to the model of a name.
    #[must_use]
    pub fn shared(&self, name: &str) -> Option<Arc<StyleModel>> {
        self.models.get(name).map(Arc::clone)
    }

    /// Checks made before a file is read.
    fn check(&self, name: &str, path: &Path, bytes: u64) -> Result<(), LibraryError> {
        let path = path.to_owned();
        if !is_name(name) {
            return Err(LibraryError::Name { path });
        }
        if self.models.contains_key(name) {
            let name = name.to_owned();
            return Err(LibraryError::Twice { path, name });
        }
        if bytes > MAX_MODEL_BYTES {
            return Err(LibraryError::TooLarge { path, bytes });
        }
        Ok(())
    }

    fn add(
        &mut self,
        name: &str,
        path: &Path,
        onnx: Cow<'static, [u8]>,
        card: Option<&str>,
    ) -> Result<(), LibraryError> {
        let card = match card {
            Some(text) => ModelCard::parse(text, name, &onnx).map_err(|reason| LibraryError::Card {
                path: path.with_extension("card.json"),
                reason,
            })?,
            None => ModelCard::absent(name, &onnx),
        };
        let name = name.to_owned();
        let model = StyleModel {
            name: name.clone(),
            onnx,
            card,
        };
        self.models.insert(name, Arc::new(model));
        Ok(())
    }
}

/// The ONNX files of a folder, sorted by name.
fn model_files(folder: &Path) -> Result<Vec<PathBuf>, LibraryError> {
    let mut files = Vec::new();
    for entry in fs::read_dir(folder).map_err(unreadable(folder))? {
        let path = entry.map_err(unreadable(folder))?.path();
        if path.extension().is_some_and(|extension| extension == "onnx") {
            files.push(path);
        }
    }
    files.sort();
    Ok(files)
}

/// Whether a name is valid for a model: 1 to 64 characters of a-z, 0-9, `_` and `-`.
#[must_use]
pub fn is_name(name: &str) -> bool {
    (1..=MAX_NAME_CHARS).contains(&name.len())
        && name
            .bytes()
            .all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == b'_' || c == b'-')
}

fn unreadable(path: &Path) -> impl Fn(io::Error) -> LibraryError {
    move |source| LibraryError::Read {
        path: path.to_owned(),
        source,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The shipped library and a folder with these files.
    fn with_files(files: &[(&str, &[u8])]) -> Result<Library, LibraryError> {
        let folder = tempfile::tempdir().unwrap();
        for (name, bytes) in files {
            fs::write(folder.path().join(name), bytes).unwrap();
        }
        Library::embedded().unwrap().with_dir(folder.path())
    }

    #[test]
    fn each_shipped_card_fits_its_model_and_says_where_it_comes_from() {
        let library = Library::embedded().unwrap();
        assert_eq!(
            library.names(),
            ["atlantic", "atlantic-range", "mediterranean", "muddy"]
        );
        for name in library.names() {
            let card = &library.get(name).unwrap().card;
            assert_eq!(card.licence, "MIT OR Apache-2.0");
            assert!(
                card.source.contains("no third-party data"),
                "{name}: {}",
                card.source
            );
            assert_eq!(card.takes_range, name == "atlantic-range");
            let training = card.training.as_ref().expect("a shipped water was trained here");
            assert!(
                training.kept_step > 0 && training.photos.iter().all(|digest| digest.len() == 64),
                "{name}"
            );
            assert!(!library.needs_runtime(name), "{name}");
            assert!(
                !card.alpha.is_empty() && !card.inputs.is_empty() && card.parameters.is_some(),
                "{name}"
            );
        }
    }

    #[test]
    fn a_folder_adds_its_models_and_nothing_else() {
        let library = with_files(&[("harbour_2-b.onnx", b"model"), ("notes.txt", b"ignored")]).unwrap();
        assert_eq!(
            library.names(),
            [
                "atlantic",
                "atlantic-range",
                "harbour_2-b",
                "mediterranean",
                "muddy"
            ]
        );
        let card = &library.get("harbour_2-b").unwrap().card;
        assert_eq!(
            (card.licence.as_str(), card.caveats[0].as_str()),
            ("unknown", "it came without a card")
        );
    }

    #[test]
    fn what_cannot_be_used_is_refused_by_the_name_of_its_file() {
        let long = format!("{}.onnx", "a".repeat(65));
        let refused: [(&str, &[u8], &str); 5] = [
            (
                "muddy.onnx",
                b"model",
                "muddy.onnx: there is already a style `muddy`",
            ),
            ("Harbour.onnx", b"model", "Harbour.onnx: the name of a style"),
            ("über.onnx", b"model", "über.onnx: the name of a style"),
            (".onnx.onnx", b"model", ".onnx.onnx: the name of a style"),
            (&long, b"model", "the name of a style"),
        ];
        for (file, bytes, expected) in refused {
            let error = with_files(&[(file, bytes)]).unwrap_err().to_string();
            assert!(error.contains(expected), "{error}");
        }
        let card = br#"{"name": "harbour", "sha256": "0"}"#;
        let error = with_files(&[("harbour.onnx", b"model"), ("harbour.card.json", card)])
            .unwrap_err()
            .to_string();
        assert!(
            error.contains("harbour.card.json cannot be used: its SHA-256 is 0"),
            "{error}"
        );
    }

    #[test]
    fn a_folder_or_a_model_that_cannot_be_read_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let missing = Library::embedded()
            .unwrap()
            .with_dir(&folder.path().join("missing"));
        assert!(
            missing
                .unwrap_err()
                .to_string()
                .contains("missing cannot be read")
        );
        fs::create_dir(folder.path().join("folder.onnx")).unwrap();
        let error = Library::embedded().unwrap().with_dir(folder.path()).unwrap_err();
        assert!(
            error.to_string().contains("folder.onnx cannot be read"),
            "{error}"
        );
    }
}
