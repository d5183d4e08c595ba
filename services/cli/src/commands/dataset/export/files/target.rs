//! The folder of an export. Nothing is written outside of it, and no link in it is followed.
//!
//! Names come from the command line or have been checked by [`crate::commands::dataset::export::input::frame::Place`]. A file is written under a new temporary name,
//! then renamed, which replaces a link instead of following it.

use std::collections::BTreeSet;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};

use anyhow::Context;
use cli::exit::Failure;
use serde_json::{Map, Value};

/// The file with the card of an export, which identifies it.
const CARD: &str = "export.json";

/// The folder of an export.
pub(crate) struct Target {
    root: PathBuf,
    /// The open card, whose lock excludes other exports and ends with the process.
    _card: File,
}

impl Target {
    /// Opens a new or empty folder, or one that holds an export with the same card.
    pub(crate) fn open(root: &Path, card: &Value) -> Result<Self, Failure> {
        fs::create_dir_all(root).with_context(|| format!("cannot create {}", root.display()))?;
        let path = root.join(CARD);
        if !fs::symlink_metadata(&path).is_ok_and(|found| found.is_file()) {
            let mut entries =
                fs::read_dir(root).with_context(|| format!("cannot read {}", root.display()))?;
            if entries.next().is_some() {
                let message = format!(
                    "{} is not empty and holds no export; name an empty or a new folder",
                    root.display()
                );
                return Err(Failure::BadInput(message));
            }
            match create_new(&path) {
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                created => {
                    created.with_context(|| format!("cannot write {}", path.display()))?;
                }
            }
        }
        let mut file = lock(root, &path)?;
        let mut found = String::new();
        file.read_to_string(&mut found)
            .with_context(|| format!("cannot read {}", path.display()))?;
        if found.is_empty() {
            file.write_all(format!("{card}\n").as_bytes())
                .with_context(|| format!("cannot write {}", path.display()))?;
        } else if let Some(difference) = find_difference(&found, card) {
            return Err(Failure::BadInput(format!(
                "{} holds another export: {difference}; name an empty or a new folder",
                root.display()
            )));
        }
        Ok(Self {
            root: root.to_owned(),
            _card: file,
        })
    }

    pub(crate) fn root(&self) -> &Path {
        &self.root
    }

    /// A folder below the root, created if it is missing. A link or a file in its place is an error.
    pub(crate) fn folder(&self, names: &[&str]) -> Result<PathBuf, Failure> {
        let mut path = self.root.clone();
        for name in names {
            path.push(name);
            match fs::create_dir(&path) {
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {
                    let is_folder = fs::symlink_metadata(&path).is_ok_and(|found| found.is_dir());
                    if !is_folder {
                        let message = format!(
                            "{} is a link or a file where the export needs a folder",
                            path.display()
                        );
                        return Err(Failure::BadInput(message));
                    }
                }
                made => made.with_context(|| format!("cannot create {}", path.display()))?,
            }
        }
        Ok(path)
    }
}

/// Opens the card of a folder with an exclusive lock.
fn lock(root: &Path, card: &Path) -> Result<File, Failure> {
    let opened = OpenOptions::new().read(true).write(true).open(card);
    let file = opened.with_context(|| format!("cannot open {}", card.display()))?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => Err(Failure::Later(format!(
            "another process exports into {}; wait for it, or name another folder",
            root.display()
        ))),
        Err(TryLockError::Error(error)) => {
            let context = format!("cannot lock {}", card.display());
            Err(anyhow::Error::from(error).context(context).into())
        }
    }
}

/// The bytes of a file; `None` without one, and for a link.
pub(crate) fn read(path: &Path) -> Result<Option<Vec<u8>>, Failure> {
    let unreadable = || format!("cannot read {}", path.display());
    match fs::symlink_metadata(path) {
        Ok(found) if found.is_file() => Ok(Some(fs::read(path).with_context(unreadable)?)),
        Ok(_) => Ok(None),
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
        Err(error) => Err(anyhow::Error::from(error).context(unreadable()).into()),
    }
}

/// The bytes of a file that this export wrote.
pub(crate) fn read_written(path: &Path) -> Result<Vec<u8>, Failure> {
    read(path)?.ok_or_else(|| anyhow::anyhow!("{} was removed during the export", path.display()).into())
}

/// Writes a file in a folder that [`Target::folder`] returned.
pub(crate) fn write(path: &Path, bytes: &[u8]) -> Result<(), Failure> {
    let draft = draft_of(path);
    let written = create(&draft).and_then(|mut file| file.write_all(bytes));
    let written = written.and_then(|()| fs::rename(&draft, path));
    if written.is_err() {
        // It may not exist.
        let _ = fs::remove_file(&draft);
    }
    Ok(written.with_context(|| format!("cannot write {}", path.display()))?)
}

/// A new file; a file or link that has its name is removed.
pub(crate) fn create(path: &Path) -> io::Result<File> {
    match create_new(path) {
        Err(error) if error.kind() == ErrorKind::AlreadyExists => {
            fs::remove_file(path)?;
            create_new(path)
        }
        created => created,
    }
}

fn create_new(path: &Path) -> io::Result<File> {
    OpenOptions::new().write(true).create_new(true).open(path)
}

/// The temporary name of a file.
pub(crate) fn draft_of(path: &Path) -> PathBuf {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    path.with_file_name(format!(".{name}.part"))
}

/// How the card of a folder differs from that of an export; `None` for the same.
fn find_difference(found: &str, card: &Value) -> Option<String> {
    let Ok(Value::Object(found)) = serde_json::from_str(found) else {
        return Some("its card cannot be read".to_owned());
    };
    let names = found
        .keys()
        .chain(card.as_object().into_iter().flat_map(Map::keys));
    let differing: BTreeSet<&String> = names
        .filter(|name| found.get(*name).unwrap_or(&Value::Null) != &card[name.as_str()])
        .collect();
    let describe = |value: &Value| match value {
        Value::Null => "not set".to_owned(),
        value => value.to_string(),
    };
    let listed: Vec<String> = differing
        .iter()
        .map(|name| {
            let stored = describe(found.get(*name).unwrap_or(&Value::Null));
            format!(
                "`{name}` is {stored} there and {} here",
                describe(&card[name.as_str()])
            )
        })
        .collect();
    (!listed.is_empty()).then(|| listed.join(", "))
}

#[cfg(test)]
mod tests {
    use std::os::unix::fs::symlink;

    use serde_json::json;

    use super::*;

    #[test]
    fn links_are_replaced_or_refused_and_never_followed() {
        let outside = tempfile::tempdir().unwrap();
        let folder = tempfile::tempdir().unwrap();
        let target = Target::open(folder.path(), &json!({})).unwrap();
        let secret = outside.path().join("secret");
        fs::write(&secret, b"mine").unwrap();

        symlink(outside.path(), folder.path().join("job_1")).unwrap();
        assert!(matches!(
            target.folder(&["job_1", "0"]),
            Err(Failure::BadInput(_))
        ));

        let frame = target.folder(&["job_2", "0"]).unwrap();
        for name in ["rgb.png", ".rgb.png.part"] {
            symlink(&secret, frame.join(name)).unwrap();
        }
        assert_eq!(read(&frame.join("rgb.png")).unwrap(), None);
        write(&frame.join("rgb.png"), b"picture").unwrap();
        assert_eq!(fs::read(&secret).unwrap(), b"mine");
        assert_eq!(
            read(&frame.join("rgb.png")).unwrap().as_deref(),
            Some(&b"picture"[..])
        );
        assert_eq!(fs::read_dir(&frame).unwrap().count(), 1, "a draft was left");
        assert_eq!(fs::read_dir(outside.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_file_that_cannot_be_read_is_an_error_of_this_machine() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("rgb.png");
        fs::write(&file, b"").unwrap();
        // A file in place of a folder cannot be looked into.
        let failure = read(&file.join("0")).unwrap_err().to_string();
        assert!(failure.contains("cannot read"), "{failure}");
        let failure = read_written(&folder.path().join("gone")).unwrap_err().to_string();
        assert!(failure.contains("removed during the export"), "{failure}");
    }

    #[test]
    fn a_folder_belongs_to_one_export_at_a_time() {
        let folder = tempfile::tempdir().unwrap();
        let first = Target::open(folder.path(), &json!({})).unwrap();
        assert!(matches!(
            Target::open(folder.path(), &json!({})),
            Err(Failure::Later(_))
        ));
        drop(first);
        assert!(Target::open(folder.path(), &json!({})).is_ok());
    }

    #[test]
    fn only_an_export_of_the_same_kind_is_continued() {
        let folder = tempfile::tempdir().unwrap();
        let open = |dataset: &str, split: Option<&str>| {
            Target::open(folder.path(), &json!({"dataset": dataset, "split": split})).map(drop)
        };
        open("tour", None).unwrap();
        open("tour", None).unwrap();
        for (dataset, split) in [("bay", None), ("tour", Some("train=1"))] {
            let refused = open(dataset, split).unwrap_err().to_string();
            assert!(refused.contains("another export"), "{refused}");
        }
        fs::remove_file(folder.path().join(CARD)).unwrap();
        fs::write(folder.path().join("thesis.tex"), b"").unwrap();
        let refused = open("tour", None).unwrap_err().to_string();
        assert!(refused.contains("holds no export"), "{refused}");
    }
}
