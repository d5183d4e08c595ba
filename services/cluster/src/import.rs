//! From the shards of a set into a catalogue: threads read and check shards while one stores what they have read.

use std::collections::BTreeMap;
use std::sync::mpsc::{SyncSender, sync_channel};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::{SystemTime, UNIX_EPOCH};

use catalogue::{
    Catalogue, CatalogueError, FailureRow, InsertJob, JobRow, NewImage, NewJob, NewShard, ShardEnd, UnixMs,
};
use sets::{DoneShard, Marker, Set, SetError, ShardImage};
use tokio::runtime::Runtime;

/// Attempts after which a set lists a frame as failed.
const ATTEMPTS: u32 = 3;
/// Longest reason of a failed frame, as that of a worker.
const MOST_ERROR_BYTES: usize = 4096;

/// Why an import ends early. What was stored stays, and the next import goes on from there.
#[derive(Debug, thiserror::Error)]
pub(crate) enum ImportError {
    #[error(transparent)]
    Set(#[from] SetError),
    #[error(transparent)]
    Catalogue(#[from] CatalogueError),
}

/// A set and the catalogue that it goes into.
pub(crate) struct Import<'a> {
    pub(crate) set: &'a Set,
    pub(crate) catalogue: &'a Catalogue,
    pub(crate) runtime: &'a Runtime,
    /// How many shards are read side by side.
    pub(crate) threads: usize,
}

/// What an import did.
#[derive(Debug, Default)]
pub(crate) struct Tally {
    pub(crate) shards: u64,
    /// Images that were not there before.
    pub(crate) images: u64,
}

/// What is stored in one transaction: images of a shard.
struct Part {
    images: Vec<NewImage>,
    shard: NewShard,
}

impl Import<'_> {
    /// Stores what the catalogue lacks of the set; `progress` hears how many shards are stored, of how many.
    pub(crate) fn run(&self, mut progress: impl FnMut(u64, u64)) -> Result<(JobRow, Tally), ImportError> {
        let location = self.set.location().to_string();
        let known = self.runtime.block_on(self.catalogue.job_of_set(&location))?;
        let job = known
            .as_ref()
            .map_or_else(api::new_job_id, |known| known.id.clone());
        if let Some(other) = known
            .as_ref()
            .filter(|known| known.spec_digest != self.set.card().digest)
        {
            return Err(SetError::Refused(format!(
                "{location} was imported as {}, and holds another job now; delete {} first",
                other.id, other.id
            ))
            .into());
        }
        let missing = self.missing(&job)?;
        let mut tally = Tally::default();
        // With the first shard that is good, so that a set without one leaves nothing behind.
        let mut is_there = known.is_some();
        let result = self.read_all(&job, &missing, |part| {
            if !is_there {
                self.begin(&job, &location)?;
                is_there = true;
            }
            let ends = part.shard.end.is_some();
            let stored = self.catalogue.import(&job, part.images, part.shard);
            tally.images += self.runtime.block_on(stored)?;
            tally.shards += u64::from(ends);
            progress(tally.shards, missing.len() as u64);
            Ok(())
        });
        result?;
        let row = match self.runtime.block_on(self.catalogue.job(&job))? {
            Some(row) => row,
            None => self.begin(&job, &location)?,
        };
        Ok((row, tally))
    }

    fn begin(&self, id: &str, location: &str) -> Result<JobRow, ImportError> {
        let card = self.set.card();
        let new = NewJob {
            id: id.to_owned(),
            dataset: self.set.job().dataset().to_owned(),
            spec: card.job.clone(),
            spec_digest: card.digest.clone(),
            frames: card.frames,
            priority: 0,
            created_at: now(),
            idempotency: None,
            set: Some(location.to_owned()),
        };
        match self.runtime.block_on(self.catalogue.insert_job(new))? {
            InsertJob::Created(row) | InsertJob::Replayed(row) => Ok(row),
            InsertJob::KeyConflict => Err(CatalogueError::Failed {
                message: "a job without a key has a conflict of keys".to_owned(),
            }
            .into()),
        }
    }

    /// Shards that are done and not imported, or written anew since.
    fn missing(&self, job: &str) -> Result<Vec<DoneShard>, ImportError> {
        let imported = self.runtime.block_on(self.catalogue.imported_shards(job))?;
        let imported: BTreeMap<u64, i64> = imported
            .into_iter()
            .map(|shard| (shard.frame, shard.changed_ms))
            .collect();
        let card = self.set.card();
        let mut done = self.set.done_shards()?;
        done.retain(|done| imported.get(&card.frames_of(done.shard).start) != Some(&done.changed_ms));
        Ok(done)
    }

    /// Reads shards side by side and hands over their parts, those of one shard in order.
    fn read_all(
        &self,
        job: &str,
        shards: &[DoneShard],
        mut store: impl FnMut(Part) -> Result<(), ImportError>,
    ) -> Result<(), ImportError> {
        let next = Mutex::new(shards.iter());
        thread::scope(|scope| {
            let (send, parts) = sync_channel(self.threads);
            for _ in 0..self.threads {
                let (send, next) = (send.clone(), &next);
                scope.spawn(move || {
                    let take = || next.lock().unwrap_or_else(PoisonError::into_inner).next();
                    while let Some(shard) = take() {
                        if let Err(error) = self.read(job, *shard, &send) {
                            let _ = send.send(Err(error));
                            return;
                        }
                    }
                });
            }
            drop(send);
            // When it ends early, nobody takes what the threads read, and they end, too.
            parts.into_iter().try_for_each(|part| store(part?))
        })
    }

    fn read(
        &self,
        job: &str,
        done: DoneShard,
        send: &SyncSender<Result<Part, ImportError>>,
    ) -> Result<(), ImportError> {
        let rows = self.set.shard_rows(done.shard)?;
        let (marker, frame) = (rows.marker.clone(), rows.first_frame);
        let mut groups = rows.groups().peekable();
        loop {
            let images = groups.next().transpose()?.unwrap_or_default();
            let is_last = groups.peek().is_none();
            let shard = NewShard {
                frame,
                tar: marker.tar_name(),
                end: is_last.then(|| end(&marker, done)),
            };
            let images = self.prepare(job, images)?;
            if send.send(Ok(Part { images, shard })).is_err() || is_last {
                return Ok(());
            }
        }
    }

    fn prepare(&self, job: &str, images: Vec<ShardImage>) -> Result<Vec<NewImage>, ImportError> {
        let prepare = |image: ShardImage| {
            self.catalogue
                .imported_image(job, &image.record, image.created_ms, &image.offsets)
        };
        Ok(images.into_iter().map(prepare).collect::<Result<_, _>>()?)
    }
}

fn end(marker: &Marker, done: DoneShard) -> ShardEnd {
    let failure = |failed: &sets::FailedFrame| FailureRow {
        frame: failed.frame,
        strikes: ATTEMPTS,
        quarantined: true,
        error: failed.error[..failed.error.floor_char_boundary(MOST_ERROR_BYTES)].to_owned(),
    };
    ShardEnd {
        digest: marker.digest.clone(),
        changed_ms: done.changed_ms,
        failed: marker.failed.iter().map(failure).collect(),
    }
}

fn now() -> UnixMs {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    UnixMs(since.map_or(0, |since| since.as_millis() as u64))
}
