//! Added styles on disk: `added-styles/DIGEST.onnx`, and `added-styles/NAME.card.json`, which references the digest
//! and is written last. Files are written under another name, synced, then renamed.

use std::fs::{self, DirEntry, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use style::{Library, LibraryError, ModelRole, is_name};

use crate::http::problem::{Problem, Slug};
use crate::limits;

/// Name of the folder in the data folder.
const FOLDER: &str = "added-styles";
/// Suffix of a card's file name.
const CARD: &str = ".card.json";
/// Prefix of an unfinished file's name.
const UNFINISHED: &str = ".new-";

/// Why the added styles of a service cannot be loaded.
#[derive(Debug, thiserror::Error)]
pub enum AddedStyleError {
    /// The folder or one of its files is unreadable.
    #[error("{}: {source}", path.display())]
    File {
        /// The file or folder.
        path: PathBuf,
        /// Error of the file system.
        source: io::Error,
    },
    /// A configured style has the name of an added one, and is another network or has another role.
    #[error(
        "{}: the configured style `{name}` is another network or has another role; rename it, or delete this card, after which its images cannot be rendered again",
        path.display()
    )]
    Taken {
        /// The card of the added one.
        path: PathBuf,
        /// The name.
        name: String,
    },
}

/// The folder of a running service.
pub(super) struct Folder {
    path: PathBuf,
    /// Total bytes of all models, which the service keeps in memory.
    bytes: u64,
    styles: usize,
}

/// The library with the added styles of a service. A damaged or missing file is logged and skipped, because other
/// jobs do not need it.
///
/// # Errors
/// [`AddedStyleError`].
pub fn added_styles(data: &Path, mut library: Library) -> Result<Library, AddedStyleError> {
    let folder = data.join(FOLDER);
    for name in cards(&folder).map_err(file_error(&folder))? {
        let path = folder.join(format!("{name}{CARD}"));
        let card = fs::read_to_string(&path).map_err(file_error(&path))?;
        let digest = digest_of(&card);
        if let Some(other) = library.get(&name) {
            if other.card.sha256 == digest && other.card.role.name() == role_of(&card) {
                continue;
            }
            return Err(AddedStyleError::Taken { path, name });
        }
        let added = read_model(&folder, &digest)
            .map_err(|error| error.to_string())
            .and_then(|onnx| {
                let added = library.clone().with_model(&name, onnx, Some(&card));
                added.map_err(|error: LibraryError| error.to_string())
            });
        match added {
            Ok(larger) => library = larger,
            Err(error) => tracing::error!(style = name, error, "an added style cannot be used"),
        }
    }
    Ok(library)
}

impl Folder {
    /// Opens the folder of a service, if it exists, and removes unfinished files.
    pub(super) fn open(data: &Path) -> Result<Self, AddedStyleError> {
        let path = data.join(FOLDER);
        let (mut bytes, mut styles) = (0, 0);
        for entry in entries(&path).map_err(file_error(&path))? {
            let name = entry.file_name().to_string_lossy().into_owned();
            if name.starts_with(UNFINISHED) {
                fs::remove_file(entry.path()).map_err(file_error(&entry.path()))?;
            } else if name.ends_with(CARD) {
                styles += 1;
            } else {
                bytes += entry.metadata().map_err(file_error(&entry.path()))?.len();
            }
        }
        Ok(Self { path, bytes, styles })
    }

    /// Whether one more style may be kept.
    pub(super) fn has_room_for(&self, bytes: u64) -> Result<(), Problem> {
        let (count, limit) = (self.styles, limits::ADDED_STYLES);
        if count >= limit {
            let detail = format!("the service has {count} added styles; must be at most {limit}");
            return Err(Problem::new(Slug::TooLarge, detail));
        }
        let (total, limit) = (self.bytes + bytes, limits::ADDED_STYLES_BYTES);
        if total > limit {
            let detail = format!("the added styles would have {total} bytes; must be at most {limit}");
            return Err(Problem::new(Slug::TooLarge, detail));
        }
        Ok(())
    }

    /// Writes a style; the card makes it effective.
    pub(super) fn put(&mut self, name: &str, digest: &str, onnx: &[u8], card: &str) -> io::Result<()> {
        fs::create_dir_all(&self.path)?;
        self.write(&format!("{digest}.onnx"), onnx)?;
        faults::point("style.model");
        self.write(&format!("{name}{CARD}"), card.as_bytes())?;
        self.bytes += onnx.len() as u64;
        self.styles += 1;
        Ok(())
    }

    /// Copies everything into another data folder.
    pub(super) fn copy_to(&self, data: &Path) -> io::Result<()> {
        if !self.path.is_dir() {
            return Ok(());
        }
        let copy = data.join(FOLDER);
        fs::create_dir_all(&copy)?;
        for entry in entries(&self.path)? {
            let target = copy.join(entry.file_name());
            fs::copy(entry.path(), &target)?;
            File::open(&target)?.sync_all()?;
        }
        File::open(&copy)?.sync_all()
    }

    fn write(&self, name: &str, bytes: &[u8]) -> io::Result<()> {
        let mut file = tempfile::Builder::new()
            .prefix(UNFINISHED)
            .tempfile_in(&self.path)?;
        file.write_all(bytes)?;
        file.as_file().sync_all()?;
        file.persist(self.path.join(name))
            .map_err(|error: tempfile::PersistError<_>| error.error)?;
        File::open(&self.path)?.sync_all()
    }
}

/// The entries of a folder; empty if it does not exist.
fn entries(folder: &Path) -> io::Result<Vec<DirEntry>> {
    match fs::read_dir(folder) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(Vec::new()),
        entries => entries?.collect(),
    }
}

/// The names of the styles with a card, in order.
fn cards(folder: &Path) -> io::Result<Vec<String>> {
    let mut names = Vec::new();
    for entry in entries(folder)? {
        let file = entry.file_name();
        let name = file.to_str().and_then(|file| file.strip_suffix(CARD));
        names.extend(name.filter(|name| is_name(name)).map(str::to_owned));
    }
    names.sort();
    Ok(names)
}

/// The digest in a card; empty if the card is unreadable. Loading the model reports the error.
fn digest_of(card: &str) -> String {
    let card: serde_json::Value = serde_json::from_str(card).unwrap_or_default();
    let digest = card["sha256"].as_str().unwrap_or_default();
    digest.chars().filter(char::is_ascii_hexdigit).collect()
}

/// The role in a card, `style` unless given.
fn role_of(card: &str) -> String {
    let card: serde_json::Value = serde_json::from_str(card).unwrap_or_default();
    card["role"]
        .as_str()
        .unwrap_or(ModelRole::Style.name())
        .to_owned()
}

fn read_model(folder: &Path, digest: &str) -> io::Result<Vec<u8>> {
    fs::read(folder.join(format!("{digest}.onnx")))
}

fn file_error(path: &Path) -> impl Fn(io::Error) -> AddedStyleError {
    move |source| AddedStyleError::File {
        path: path.to_owned(),
        source,
    }
}
