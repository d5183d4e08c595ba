//! State of a set from its listings: completed shards, failed frames, unreferenced files.

use std::collections::{BTreeMap, BTreeSet};

use futures::{StreamExt, TryStreamExt, stream};
use object_store::ObjectStoreExt;
use serde::Serialize;

use crate::error::SetError;
use crate::operations::plan::Selection;
use crate::set::marker::{FailedFrame, Marker};
use crate::set::opened::Set;
use crate::storage::layout::{self, Attempt};
use crate::storage::store::Entry;

/// Markers that are fetched concurrently.
const FETCHED_MARKERS: usize = 32;

/// How much of a set is done, from its listings alone.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Status {
    /// Shards of the job.
    pub shards: u64,
    /// Shards that are done.
    pub done: u64,
    /// Frames of the job.
    pub frames: u64,
    /// Frames in the shards that are done, with an image or not.
    pub frames_done: u64,
    /// Frames without an image.
    pub failed: u64,
    /// Files of done shards that another attempt left.
    pub orphans: u64,
    /// Files of incomplete shards: work in progress, or remains of killed processes.
    pub unfinished: u64,
    /// Contradictions between attempts; each is a defect, of a machine or of the program.
    pub alarms: u64,
    /// Frames per second between the first marker and the last, by the store's clock; `None` below two markers.
    pub rate: Option<f64>,
    /// Seconds until everything is done at this rate.
    pub eta_s: Option<f64>,
}

impl Set {
    /// How much of the set is done.
    ///
    /// # Errors
    /// [`SetError`] of the store.
    pub fn status(&self) -> Result<Status, SetError> {
        let card = self.card();
        let markers = self.store.list(layout::DONE)?;
        let done: BTreeSet<u64> = markers
            .iter()
            .filter_map(|entry| layout::shard_of(&entry.name))
            .collect();
        let frames_done = done
            .iter()
            .map(|shard: &u64| card.frames_of(*shard).count() as u64)
            .sum();
        let mut unfinished = 0;
        let mut files = 0;
        for entry in self.files()? {
            let is_done = layout::shard_of(&entry.name).is_some_and(|shard| done.contains(&shard));
            *(if is_done { &mut files } else { &mut unfinished }) += 1;
        }
        let first_and_last = markers.iter().map(|entry| entry.modified_ms);
        let span_ms = first_and_last
            .clone()
            .max()
            .zip(first_and_last.min())
            .map_or(0, |(last, first)| last - first);
        // The first marker's frames were rendered before the span begins.
        let timed = frames_done as f64 * (1.0 - 1.0 / done.len().max(1) as f64);
        let rate = (span_ms > 0).then(|| timed / (span_ms as f64 / 1e3));
        Ok(Status {
            shards: card.shards(),
            done: done.len() as u64,
            frames: card.frames,
            frames_done,
            failed: self.failed_frames(&Selection::default())?.len() as u64,
            orphans: u64::saturating_sub(files, 2 * done.len() as u64),
            unfinished,
            alarms: self.store.list(layout::ALARM)?.len() as u64,
            rate,
            eta_s: rate.map(|rate| (card.frames - frames_done) as f64 / rate),
        })
    }

    /// Frames without an image in the shards of a selection that are done, in their order.
    ///
    /// # Errors
    /// [`SetError`] of the store, and markers that cannot be read.
    pub fn failed_frames(&self, selection: &Selection) -> Result<Vec<FailedFrame>, SetError> {
        let meant: BTreeSet<u64> = selection.shards(self.card())?.into_iter().collect();
        let listed = self.store.list(layout::FAILED)?;
        let noted: BTreeSet<u64> = listed
            .iter()
            .filter_map(|entry| layout::shard_of(&entry.name))
            .collect();
        let markers = self.markers(noted.intersection(&meant).copied().collect())?;
        Ok(markers.into_iter().flat_map(|marker| marker.failed).collect())
    }

    /// Digest over all images, as `fathom render` and a service compute it.
    ///
    /// # Errors
    /// [`SetError`] of the store, and files that cannot be read.
    pub fn digest(&self) -> Result<String, SetError> {
        let mut digests = Vec::new();
        for marker in self.markers(self.done()?)? {
            digests.extend(marker.frame_digests(&self.store)?);
        }
        Ok(spec::job_digest(digests.iter().map(String::as_str)))
    }

    /// The markers of these shards that are there, in their order.
    pub(crate) fn markers(&self, shards: Vec<u64>) -> Result<Vec<Marker>, SetError> {
        let fetched = stream::iter(shards)
            .map(|shard: u64| async move {
                let name = layout::done(shard);
                match self.store.objects.get(&self.store.path(&name)).await {
                    Ok(found) => Ok(Some((name, found.bytes().await?))),
                    Err(object_store::Error::NotFound { .. }) => Ok(None),
                    Err(error) => Err(error),
                }
            })
            .buffered(FETCHED_MARKERS);
        let texts: Vec<_> = self.store.wait(fetched.try_collect())?;
        texts
            .into_iter()
            .flatten()
            .map(|(name, text)| Marker::read(&name, &text))
            .collect()
    }

    /// Removes files that no marker names and that are older than this, by the store's clock; returns how many.
    ///
    /// # Errors
    /// [`SetError`] of the store.
    pub fn sweep(&self, older_ms: i64) -> Result<u64, SetError> {
        let newest_ms = self.store_time_ms()? - older_ms;
        let mut by_shard: BTreeMap<u64, Vec<Entry>> = BTreeMap::new();
        for entry in self.files()? {
            if let Some(shard) = layout::shard_of(&entry.name) {
                by_shard.entry(shard).or_default().push(entry);
            }
        }
        // Listed after the files, so that shards committed in between keep their files.
        let done: BTreeSet<u64> = self.done()?.into_iter().collect();
        let markers = self.markers(
            by_shard
                .iter()
                .filter_map(|(shard, files): (&u64, &Vec<Entry>)| {
                    (done.contains(shard) && files.len() != 2).then_some(*shard)
                })
                .collect(),
        )?;
        let winners: BTreeMap<u64, Marker> =
            markers.into_iter().map(|marker| (marker.shard, marker)).collect();
        let mut removed = 0;
        for (shard, files) in by_shard {
            let is_orphan = |entry: &Entry| match winners.get(&shard) {
                Some(winner) => layout::attempt_of(&entry.name) != Some(&winner.attempt),
                None => !done.contains(&shard),
            };
            for entry in files
                .iter()
                .filter(|entry| is_orphan(entry) && entry.modified_ms <= newest_ms)
            {
                self.store.delete(&entry.name)?;
                removed += 1;
            }
        }
        for entry in self
            .store
            .list(layout::PROBE)?
            .iter()
            .filter(|entry| entry.modified_ms <= newest_ms)
        {
            self.store.delete(&entry.name)?;
            removed += 1;
        }
        Ok(removed + self.store.sweep_unfinished(newest_ms)?)
    }

    /// The clock of the store: a wrong clock of this machine must not remove files too early.
    fn store_time_ms(&self) -> Result<i64, SetError> {
        let name = layout::probe(&Attempt::random()?);
        self.store.replace(&name, b"time")?;
        let entry = self.store.entry(&name)?;
        self.store.delete(&name)?;
        entry
            .map(|entry| entry.modified_ms)
            .ok_or_else(|| SetError::Damaged(format!("{name} is gone")))
    }

    /// The files in `shards/` and `rows/`.
    pub(crate) fn files(&self) -> Result<Vec<Entry>, SetError> {
        let mut files = self.store.list(layout::SHARDS)?;
        files.extend(self.store.list(layout::ROWS)?);
        Ok(files)
    }
}
