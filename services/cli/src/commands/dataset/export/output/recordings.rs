//! Rows of sequences until their job has no more of them; then a file for each sequence.

use std::collections::BTreeMap;
use std::path::PathBuf;

use cli::exit::Failure;
use client::ImageRow;

use crate::commands::dataset::export::files::lists::Lists;
use crate::commands::dataset::export::input::frame::Place;
use crate::commands::dataset::export::input::times::Timed;
use crate::commands::dataset::export::output::shards::{Writer, write_shard};

/// The recordings of a part.
pub(crate) struct Recordings {
    folder: PathBuf,
    job: String,
    /// Rows of the sequences of the job.
    rows: BTreeMap<String, Vec<ImageRow>>,
}

impl Recordings {
    pub(crate) fn new(folder: PathBuf) -> Self {
        Self {
            folder,
            job: String::new(),
            rows: BTreeMap::new(),
        }
    }

    /// Adds the row of a frame; returns how many files were fetched for the sequences of the job before it.
    pub(crate) fn add(
        &mut self,
        writer: &Writer<'_>,
        lists: &mut Lists,
        row: ImageRow,
    ) -> Result<usize, Failure> {
        let (Timed { sequence, .. }, Place { job, .. }) = (Timed::read(&row)?, Place::read(&row)?);
        let fetched = match job == self.job {
            true => 0,
            false => self.write(writer, lists)?,
        };
        self.job = job;
        self.rows.entry(sequence).or_default().push(row);
        Ok(fetched)
    }

    /// Writes the sequences that are complete; returns how many files were fetched.
    pub(crate) fn write(&mut self, writer: &Writer<'_>, lists: &mut Lists) -> Result<usize, Failure> {
        let mut fetched = 0;
        for (sequence, rows) in std::mem::take(&mut self.rows) {
            fetched += write_shard(writer, lists, &self.folder, &format!("{sequence}.mcap"), &rows)?;
        }
        Ok(fetched)
    }
}
