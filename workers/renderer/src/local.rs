//! Rendering a job without a service: the same frames, byte for byte.
//!
//! The folder gets `job.json` (the canonical description), `<frame>/<kind>.<ext>`, and in frame order `records.jsonl` (one record
//! per line) and `errors.jsonl`. A frame's folder appears atomically. Rendering the same job into the folder again resumes after the
//! last line; a different job is refused.

mod differences;
mod folder;
mod lines;

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;
use std::sync::mpsc::{self, Receiver, Sender};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use spec::{FrameRecord, Job};

use crate::engine::Engine;
use crate::slot::Slot;
use crate::source::SceneSource;

use folder::Folder;
pub use folder::LocalError;
use lines::{Failure, Lines};

/// Maximum frames that each slot may run ahead of the oldest unfinished one; their records are kept in memory.
const AHEAD_PER_SLOT: u64 = 16;

/// The result of a job.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Summary {
    /// Frames of the folder.
    pub frames: u64,
    /// Frames kept from an earlier run.
    pub kept: u64,
    /// Frames without an image; `errors.jsonl` lists the reasons.
    pub failed: u64,
    /// Frames with each warning, by its text.
    pub warnings: BTreeMap<String, u64>,
    /// Digest over all images: the same for any number of slots, and as a service computes it.
    pub digest: String,
    /// Time of this run.
    pub elapsed: Duration,
}

/// Renders frames of a job into a folder, on this many threads. A folder holds one range of frames, which may be continued at its end.
/// `progress` receives the number of finished frames.
///
/// # Errors
/// [`LocalError`]: the folder holds something else or cannot be written. Failed frames are not an error here.
pub fn render_job(
    job: &Job,
    engine: &Arc<Engine>,
    out: &Path,
    frames: Range<u64>,
    slots: usize,
    mut progress: impl FnMut(u64),
) -> Result<Summary, LocalError> {
    let begun = Instant::now();
    let folder = Folder::open(out, job)?;
    let mut lines = Lines::open(&folder)?;
    lines.begin(frames.start)?;
    let kept = lines.next() - frames.start;
    progress(kept.min(frames.end - frames.start));
    let slots = slots.max(1);
    let ahead = AHEAD_PER_SLOT * slots as u64;
    thread::scope(|scope| {
        let (give, waiting) = mpsc::channel();
        let (send, finished) = mpsc::channel();
        let waiting = Arc::new(Mutex::new(waiting));
        for _ in 0..slots {
            let (send, waiting, folder) = (send.clone(), Arc::clone(&waiting), &folder);
            scope.spawn(move || work(job, engine, folder, &waiting, &send));
        }
        drop((send, waiting));
        hand_out(
            &mut lines,
            (give, frames.clone(), ahead),
            &finished,
            &mut progress,
        )
    })?;
    Ok(Summary {
        frames: lines.next() - frames.start,
        kept,
        failed: lines.failed(),
        warnings: lines.warnings().clone(),
        digest: lines.digest(),
        elapsed: begun.elapsed(),
    })
}

type Outcome = Result<Result<FrameRecord, Failure>, LocalError>;

/// Renders frames in one slot until the queue is empty or the receiver is closed.
fn work(
    job: &Job,
    engine: &Arc<Engine>,
    folder: &Folder,
    waiting: &Mutex<Receiver<u64>>,
    finished: &Sender<(u64, Outcome)>,
) {
    let mut slot = Slot::new(engine);
    let next = || waiting.lock().ok()?.recv().ok();
    while let Some(index) = next() {
        let outcome = frame(job, folder, &mut slot, index);
        if finished.send((index, outcome)).is_err() {
            return;
        }
    }
}

/// Renders one frame and stores its files.
fn frame(job: &Job, folder: &Folder, slot: &mut Slot, index: u64) -> Outcome {
    let failed = |error: String| Ok(Err(Failure { frame: index, error }));
    let frame = match job.resolve(index) {
        Ok(frame) => frame,
        Err(invalid) => return failed(invalid.to_string()),
    };
    match slot.attempt(&frame, &SceneSource::Local) {
        Err(error) => failed(error.to_string()),
        Ok(rendered) => {
            folder.store(index, &rendered.files)?;
            Ok(Ok(rendered.record))
        }
    }
}

/// Distributes frames in order, at most `ahead` beyond the oldest unwritten one, and writes their lines in order.
fn hand_out(
    lines: &mut Lines,
    (give, frames, ahead): (Sender<u64>, Range<u64>, u64),
    finished: &Receiver<(u64, Outcome)>,
    progress: &mut impl FnMut(u64),
) -> Result<(), LocalError> {
    let mut early = BTreeMap::new();
    let mut next = lines.next();
    while lines.next() < frames.end {
        while next < frames.end.min(lines.next() + ahead) && give.send(next).is_ok() {
            next += 1;
        }
        // Every slot has panicked; the scope propagates the panic.
        let Ok((index, outcome)) = finished.recv() else {
            break;
        };
        early.insert(index, outcome?);
        while let Some(outcome) = early.remove(&lines.next()) {
            lines.write(outcome)?;
        }
        progress(lines.next() - frames.start + early.len() as u64);
    }
    Ok(())
}
