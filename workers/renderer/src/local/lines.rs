//! `records.jsonl` and `errors.jsonl`: each frame has one line in one of them, in frame order.

use std::collections::BTreeMap;
use std::fs::{File, OpenOptions};
use std::io::{BufRead, BufReader, Write};
use std::path::PathBuf;

use serde::{Deserialize, Serialize, de::DeserializeOwned};
use spec::FrameRecord;

use super::folder::{Folder, LocalError, io_error};

/// A line of `errors.jsonl`.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Failure {
    pub(crate) frame: u64,
    pub(crate) error: String,
}

/// Both files, open for the next line.
pub(crate) struct Lines {
    records: Log,
    errors: Log,
    /// Digests of the images so far, in frame order.
    digests: Vec<String>,
    failed: u64,
    /// Frames with each warning.
    warnings: BTreeMap<String, u64>,
    /// The first frame of the folder; `None` of a new one.
    first: Option<u64>,
    next: u64,
}

impl Lines {
    /// Opens the files and keeps the frames in them. An incomplete last line is removed.
    pub(crate) fn open(folder: &Folder) -> Result<Self, LocalError> {
        let (mut digests, mut failed, mut next) = (Vec::new(), 0, 0);
        let mut first = None;
        let mut note = |frame: u64| {
            first = Some(first.map_or(frame, |first: u64| first.min(frame)));
            next = next.max(frame + 1);
        };
        let mut warnings = BTreeMap::new();
        let records = Log::open(folder.file("records.jsonl"), |record: FrameRecord| {
            digests.push(record.digest());
            count_warnings(&mut warnings, &record);
            note(record.frame);
        })?;
        let errors = Log::open(folder.file("errors.jsonl"), |failure: Failure| {
            failed += 1;
            note(failure.frame);
        })?;
        Ok(Self {
            records,
            errors,
            digests,
            failed,
            warnings,
            first,
            next,
        })
    }

    /// Begins a new folder with this frame; an older folder must begin with it.
    pub(crate) fn begin(&mut self, frame: u64) -> Result<(), LocalError> {
        match self.first {
            None => {
                (self.first, self.next) = (Some(frame), frame);
                Ok(())
            }
            Some(first) if first == frame => Ok(()),
            Some(first) => Err(LocalError::OtherFrames {
                first,
                next: self.next,
                wanted: frame,
            }),
        }
    }

    /// The first frame without a line.
    pub(crate) fn next(&self) -> u64 {
        self.next
    }

    /// Frames in `errors.jsonl`.
    pub(crate) fn failed(&self) -> u64 {
        self.failed
    }

    /// Frames with each warning.
    pub(crate) fn warnings(&self) -> &BTreeMap<String, u64> {
        &self.warnings
    }

    /// Digest over all images.
    pub(crate) fn digest(&self) -> String {
        spec::job_digest(self.digests.iter().map(String::as_str))
    }

    /// Writes the line of frame [`Self::next`].
    pub(crate) fn write(&mut self, outcome: Result<FrameRecord, Failure>) -> Result<(), LocalError> {
        match outcome {
            Ok(record) => {
                self.records.write(&record)?;
                self.digests.push(record.digest());
                count_warnings(&mut self.warnings, &record);
            }
            Err(failure) => {
                self.errors.write(&failure)?;
                self.failed += 1;
            }
        }
        self.next += 1;
        Ok(())
    }
}

fn count_warnings(counts: &mut BTreeMap<String, u64>, record: &FrameRecord) {
    for warning in &record.warnings {
        *counts.entry(warning.clone()).or_insert(0) += 1;
    }
}

struct Log {
    path: PathBuf,
    file: File,
}

impl Log {
    /// Opens a file for appending and reads every whole line of it.
    fn open<T: DeserializeOwned>(path: PathBuf, mut read: impl FnMut(T)) -> Result<Self, LocalError> {
        let failed = |source| io_error(&path, source);
        let file = OpenOptions::new()
            .create(true)
            .append(true)
            .read(true)
            .open(&path)
            .map_err(failed)?;
        let mut reader = BufReader::new(&file);
        let (mut line, mut number, mut whole) = (Vec::new(), 0, 0);
        loop {
            line.clear();
            number += 1;
            let length = reader.read_until(b'\n', &mut line).map_err(failed)?;
            if !line.ends_with(b"\n") {
                break;
            }
            whole += length as u64;
            read(
                serde_json::from_slice(&line).map_err(|error| LocalError::Damaged {
                    path: path.display().to_string(),
                    line: number,
                    reason: error.to_string(),
                })?,
            );
        }
        file.set_len(whole).map_err(failed)?;
        Ok(Self { path, file })
    }

    fn write(&mut self, line: &impl Serialize) -> Result<(), LocalError> {
        let text = serde_json::to_string(line).map_err(|error| io_error(&self.path, error.into()))?;
        self.file
            .write_all(format!("{text}\n").as_bytes())
            .map_err(|source| io_error(&self.path, source))
    }
}
