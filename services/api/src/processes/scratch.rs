//! Temporary folders of the service, inside its data folder: the next start removes the files of a killed service.

use std::io;
use std::path::{Path, PathBuf};

use tempfile::TempDir;

/// Name of the folder in the data folder.
const NAME: &str = "tmp";

/// The folder of temporary folders.
pub(crate) struct Scratch(PathBuf);

impl Scratch {
    /// Empties the folder. The data folder must be locked.
    pub(crate) fn open(data: &Path) -> io::Result<Self> {
        let folder = data.join(NAME);
        match std::fs::remove_dir_all(&folder) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
            _ => {}
        }
        std::fs::create_dir(&folder)?;
        Ok(Self(folder))
    }

    /// The folder itself.
    pub(crate) fn path(&self) -> &Path {
        &self.0
    }

    /// A folder, removed on drop.
    pub(crate) fn folder(&self) -> io::Result<TempDir> {
        TempDir::new_in(&self.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_killed_service_left_is_removed_at_the_next_start() {
        let data = tempfile::tempdir().unwrap();
        let left = Scratch::open(data.path()).unwrap().folder().unwrap().keep();
        std::fs::write(left.join("photo"), b"private").unwrap();
        let scratch = Scratch::open(data.path()).unwrap();
        assert!(!left.exists());
        let folder = scratch.folder().unwrap();
        assert!(folder.path().starts_with(data.path()));
    }
}
