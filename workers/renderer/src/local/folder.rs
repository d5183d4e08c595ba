//! The folder of a job: its description and its frames.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use spec::Job;

use crate::file::{File, extension};

/// Why a folder cannot be rendered into.
#[derive(Debug, thiserror::Error)]
pub enum LocalError {
    /// The file system refused.
    #[error("{path}: {source}")]
    Io {
        /// The file or folder.
        path: String,
        /// Its error.
        source: io::Error,
    },
    /// The folder holds something other than a job.
    #[error("{path} is not empty and holds no job; name an empty or a new folder")]
    NotEmpty {
        /// The folder.
        path: String,
    },
    /// The folder holds another job.
    #[error("{path} holds another job (digest {found}, not {wanted}); name an empty or a new folder")]
    OtherJob {
        /// The folder.
        path: String,
        /// Digest of the job in it.
        found: String,
        /// Digest of the job to render.
        wanted: String,
    },
    /// A line of an earlier run cannot be read.
    #[error("{path}, line {line}: {reason}")]
    Damaged {
        /// The file.
        path: String,
        /// Counted from 1.
        line: usize,
        /// The defect.
        reason: String,
    },
}

/// The folder of one job.
pub(crate) struct Folder {
    path: PathBuf,
}

impl Folder {
    /// Opens a new or empty folder, or one that already holds this job.
    pub(crate) fn open(path: &Path, job: &Job) -> Result<Self, LocalError> {
        let folder = Self {
            path: path.to_owned(),
        };
        fs::create_dir_all(path).map_err(|source| io_error(path, source))?;
        let card = path.join("job.json");
        match fs::read_to_string(&card) {
            Ok(found) if found == job.canonical() => {}
            Ok(found) => {
                return Err(LocalError::OtherJob {
                    path: path.display().to_string(),
                    found: spec::sha256(found.as_bytes()),
                    wanted: job.digest(),
                });
            }
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                let mut entries = fs::read_dir(path).map_err(|source| io_error(path, source))?;
                if entries.next().is_some() {
                    return Err(LocalError::NotEmpty {
                        path: path.display().to_string(),
                    });
                }
                fs::write(&card, job.canonical()).map_err(|source| io_error(&card, source))?;
            }
            Err(source) => return Err(io_error(&card, source)),
        }
        Ok(folder)
    }

    /// A file in the folder of the frames.
    pub(crate) fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// Stores a frame's files in a draft folder, then renames it into place.
    pub(crate) fn store(&self, frame: u64, files: &[File]) -> Result<(), LocalError> {
        let place = self.path.join(frame.to_string());
        let draft = self.path.join(format!(".{frame}.draft"));
        // Left over from a run killed between storing a frame and writing its record.
        for old in [&draft, &place] {
            match fs::remove_dir_all(old) {
                Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(io_error(old, error)),
                _ => {}
            }
        }
        fs::create_dir(&draft).map_err(|source| io_error(&draft, source))?;
        for file in files {
            let path = draft.join(format!("{}.{}", file.kind, extension(file.media_type)));
            fs::write(&path, &file.bytes).map_err(|source| io_error(&path, source))?;
        }
        fs::rename(&draft, &place).map_err(|source| io_error(&place, source))
    }
}

pub(crate) fn io_error(path: &Path, source: io::Error) -> LocalError {
    LocalError::Io {
        path: path.display().to_string(),
        source,
    }
}
