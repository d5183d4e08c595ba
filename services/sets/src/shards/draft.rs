//! A shard that is being written: its tar, its rows and the data of its marker.

use std::collections::BTreeMap;
use std::time::{SystemTime, UNIX_EPOCH};

use serde::Deserialize;
use serde_json::Value;
use spec::FrameRecord;

use crate::error::SetError;
use crate::processes::message::ParcelFile;
use crate::processes::open::Finished;
use crate::rows::columns::{Common, Row};
use crate::rows::rows_file::Rows;
use crate::set::marker::{FailedFrame, Marker};
use crate::set::opened::Set;
use crate::shards::archive::Archive;
use crate::storage::layout::{self, Attempt};
use crate::storage::upload::Upload;

/// A shard that is being written.
pub(crate) struct Draft {
    shard: u64,
    attempt: Attempt,
    archive: Archive,
    rows: Rows,
    digests: Vec<String>,
    failed: Vec<FailedFrame>,
    cpu_features: String,
}

impl Draft {
    pub(crate) fn begin(set: &Set, shard: u64) -> Result<Self, SetError> {
        let attempt = Attempt::random()?;
        let name = attempt.to_string();
        let tar = layout::tar(shard, &name);
        let common = Common {
            job: set.card().digest.clone(),
            dataset: set.card().dataset(),
            tar: tar.clone(),
        };
        let rows = Upload::new(&set.store, layout::rows(shard, &name));
        Ok(Self {
            shard,
            attempt,
            archive: Archive::new(Upload::new(&set.store, tar)),
            rows: Rows::new(rows, set, common)?,
            digests: Vec::new(),
            failed: Vec::new(),
            cpu_features: String::new(),
        })
    }

    /// Adds the next frame.
    pub(crate) fn add(&mut self, frame: u64, finished: Finished) -> Result<(), SetError> {
        match finished {
            Finished::Failed(error) => self.failed.push(FailedFrame { frame, error }),
            Finished::Image { record, files } => self.add_image(frame, &record, &files)?,
        }
        let _ = faults::frame_point("shard.frame_written", frame);
        Ok(())
    }

    fn add_image(&mut self, frame: u64, text: &[u8], files: &[ParcelFile]) -> Result<(), SetError> {
        let odd = |error| SetError::Machine(format!("the record of frame {frame} cannot be read: {error}"));
        let json: Value = serde_json::from_slice(text).map_err(odd)?;
        let record = FrameRecord::deserialize(&json).map_err(odd)?;
        let mut offsets = BTreeMap::new();
        for file in files {
            let offset =
                self.archive
                    .add(frame, &format!("{}.{}", file.kind, file.extension), &file.bytes)?;
            offsets.insert(file.kind.clone(), offset);
        }
        self.archive.add(frame, "json", text)?;
        let digest = record.digest();
        self.rows.add(&Row {
            record: &record,
            json: &json,
            digest: &digest,
            created_ms: now_ms(),
            offsets: &offsets,
        })?;
        self.digests.push(digest);
        self.cpu_features = record.provenance.cpu_features;
        Ok(())
    }

    /// Completes both files; returns the marker that makes them count.
    pub(crate) fn finish(self) -> Result<Marker, SetError> {
        let tar = match self.archive.finish() {
            Ok(tar) => tar,
            Err(error) => {
                self.rows.abandon();
                return Err(error);
            }
        };
        Ok(Marker {
            shard: self.shard,
            attempt: self.attempt.to_string(),
            digest: spec::job_digest(self.digests.iter().map(String::as_str)),
            images: self.digests.len() as u64,
            failed: self.failed,
            tar,
            rows: self.rows.finish()?,
            cpu_features: self.cpu_features,
        })
    }

    /// Gives the shard up.
    pub(crate) fn abandon(self) {
        self.archive.abandon();
        self.rows.abandon();
    }
}

/// The clock of this machine; only the column `created_ms` depends on it.
fn now_ms() -> u64 {
    SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .map_or(0, |since| since.as_millis() as u64)
}
