//! Reads shards of a set concurrently: threads read and check them, the caller processes the results.

use std::sync::mpsc::{SyncSender, sync_channel};
use std::sync::{Mutex, PoisonError};
use std::thread;

use api::{Known, SetImage, SetPart};
use catalogue::{FailureRow, NewShard, ShardEnd};
use cli::exit::Failure;
use sets::{DoneShard, FailedFrame, Marker, Set, ShardImage};

use super::failure::failure;

/// Attempts at a frame before a set lists it as failed.
const ATTEMPTS: u32 = 3;
/// Longest reason of a failed frame, as that of a worker.
const MOST_ERROR_BYTES: usize = 4096;
/// Images of one batch: a megabyte or two of records.
const PART_IMAGES: usize = 500;

/// Completed shards that are unknown or were written again since.
pub(crate) fn missing(set: &Set, known: &Known) -> Result<Vec<DoneShard>, Failure> {
    let card = set.card();
    let mut done = set.done_shards().map_err(failure)?;
    done.retain(|done| known.get(&card.frames_of(done.shard).start) != Some(&done.changed_ms));
    Ok(done)
}

/// Reads shards, prepares their parts in threads and passes them on, those of one shard in order.
pub(crate) fn read_all<P: Send>(
    set: &Set,
    shards: &[DoneShard],
    prepare: impl Fn(SetPart) -> Result<P, Failure> + Sync,
    mut take: impl FnMut(P) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let threads = cli::render::cores();
    let next = Mutex::new(shards.iter());
    thread::scope(|scope| {
        let (send, parts) = sync_channel(threads);
        for _ in 0..threads {
            let (send, next, prepare) = (send.clone(), &next, &prepare);
            scope.spawn(move || {
                let take = || next.lock().unwrap_or_else(PoisonError::into_inner).next();
                while let Some(shard) = take() {
                    if let Err(error) = read(set, *shard, prepare, &send) {
                        let _ = send.send(Err(error));
                        return;
                    }
                }
            });
        }
        drop(send);
        // An early end closes the channel, which ends the threads.
        parts.into_iter().try_for_each(|part| take(part?))
    })
}

fn read<P>(
    set: &Set,
    done: DoneShard,
    prepare: impl Fn(SetPart) -> Result<P, Failure>,
    send: &SyncSender<Result<P, Failure>>,
) -> Result<(), Failure> {
    let rows = set.shard_rows(done.shard).map_err(failure)?;
    let (marker, frame) = (rows.marker.clone(), rows.first_frame);
    let mut groups = rows.groups().peekable();
    loop {
        let mut images = groups
            .next()
            .transpose()
            .map_err(failure)?
            .unwrap_or_default()
            .into_iter();
        let is_last_group = groups.peek().is_none();
        // At least one part, since the last one carries the end of the shard, which may have no images.
        loop {
            let some: Vec<SetImage> = images.by_ref().take(PART_IMAGES).map(image).collect();
            let is_last = is_last_group && images.len() == 0;
            let shard = NewShard {
                frame,
                tar: marker.tar_name(),
                end: is_last.then(|| end(&marker, done)),
            };
            let part = prepare(SetPart { images: some, shard })?;
            if send.send(Ok(part)).is_err() || is_last {
                return Ok(());
            }
            if images.len() == 0 {
                break;
            }
        }
    }
}

fn image(image: ShardImage) -> SetImage {
    let ShardImage {
        record,
        created_ms,
        offsets,
    } = image;
    SetImage {
        record,
        created_ms,
        offsets,
    }
}

fn end(marker: &Marker, done: DoneShard) -> ShardEnd {
    ShardEnd {
        digest: marker.digest.clone(),
        changed_ms: done.changed_ms,
        failed: marker
            .failed
            .iter()
            .map(|failed: &FailedFrame| FailureRow {
                frame: failed.frame,
                strikes: ATTEMPTS,
                quarantined: true,
                error: failed.error[..failed.error.floor_char_boundary(MOST_ERROR_BYTES)].to_owned(),
            })
            .collect(),
    }
}
