//! The folder of a job: its description and its frames.

use std::fs::{self, TryLockError};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

use spec::Job;

use super::differences::describe_differences;
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
    #[error("{path} holds another job: {differences}; name an empty or a new folder")]
    OtherJob {
        /// The folder.
        path: String,
        /// The fields that differ.
        differences: String,
    },
    /// The folder holds other frames of the job.
    #[error("the folder holds frames {first} to {}, but frame {wanted} was to be its first; go on with --frames {first}..B, or name another folder", next - 1)]
    OtherFrames {
        /// The first frame.
        first: u64,
        /// The frame after the last.
        next: u64,
        /// The first frame of the request.
        wanted: u64,
    },
    /// Another process renders into the folder.
    #[error("another process renders into {path}; wait for it, or name another folder")]
    Taken {
        /// The folder.
        path: String,
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

/// The folder of one job, locked against other processes until it is dropped.
pub(crate) struct Folder {
    path: PathBuf,
    /// The open description, whose lock ends with the process.
    _description: fs::File,
}

impl Folder {
    /// Opens a new or empty folder, or one that already holds this job.
    pub(crate) fn open(path: &Path, job: &Job) -> Result<Self, LocalError> {
        fs::create_dir_all(path).map_err(|source| io_error(path, source))?;
        let card = path.join("job.json");
        if !card.exists() && holds_other_files(path, &card)? {
            return Err(LocalError::NotEmpty {
                path: path.display().to_string(),
            });
        }
        let mut description = lock(path, &card)?;
        let mut found = String::new();
        description
            .read_to_string(&mut found)
            .map_err(|source| io_error(&card, source))?;
        let text = job.canonical();
        if found != text {
            // The description of a new folder is empty; a crash may have cut it off before the first frame.
            if !text.starts_with(&found) || holds_other_files(path, &card)? {
                return Err(LocalError::OtherJob {
                    path: path.display().to_string(),
                    differences: describe_differences(&found, text),
                });
            }
            description
                .write_all(&text.as_bytes()[found.len()..])
                .map_err(|source| io_error(&card, source))?;
        }
        Ok(Self {
            path: path.to_owned(),
            _description: description,
        })
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

/// Whether a folder holds anything but the description, which another process may create meanwhile.
fn holds_other_files(folder: &Path, card: &Path) -> Result<bool, LocalError> {
    let entries = fs::read_dir(folder).map_err(|source| io_error(folder, source))?;
    let mut paths = entries.filter_map(|entry| Some(entry.ok()?.path()));
    Ok(paths.any(|path| path != card))
}

/// Opens the description of a folder with an exclusive lock.
fn lock(folder: &Path, card: &Path) -> Result<fs::File, LocalError> {
    let opened = fs::File::options()
        .create(true)
        .truncate(false)
        .read(true)
        .write(true)
        .open(card);
    let file = opened.map_err(|source| io_error(card, source))?;
    match file.try_lock() {
        Ok(()) => Ok(file),
        Err(TryLockError::WouldBlock) => Err(LocalError::Taken {
            path: folder.display().to_string(),
        }),
        Err(TryLockError::Error(source)) => Err(io_error(card, source)),
    }
}

pub(crate) fn io_error(path: &Path, source: io::Error) -> LocalError {
    LocalError::Io {
        path: path.display().to_string(),
        source,
    }
}
