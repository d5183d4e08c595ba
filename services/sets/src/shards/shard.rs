//! The one function that every engine calls: render a shard of a set, and commit it.

use crate::error::SetError;
use crate::processes::crew::Crew;
use crate::set::marker::{Commit, Marker};
use crate::set::opened::Set;
use crate::shards::draft::Draft;

/// What became of a shard.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Outcome {
    /// It was done before.
    Done,
    /// It is done now, by this call.
    Committed(Marker),
    /// It is done now; another call was faster, and this one's files are gone.
    Beaten,
}

/// Renders a shard unless it is done, and commits it. Repeating the call, here or on another machine, is harmless.
///
/// Both files are complete before the marker is created, so a call that ends early leaves no completed shard. `check` is called
/// several times a second and can stop the work.
///
/// # Errors
/// [`SetError::Damaged`] if another machine has made other content of the same frames; what `check` returns; otherwise
/// [`SetError`] of the store or of this machine. Failed frames are listed in the marker.
pub fn run_shard(
    set: &Set,
    shard: u64,
    crew: &mut Crew,
    check: &dyn Fn() -> Result<(), SetError>,
) -> Result<Outcome, SetError> {
    if set.marker(shard)?.is_some() {
        return Ok(Outcome::Done);
    }
    let mut draft = Draft::begin(set, shard)?;
    let frames = set.card().frames_of(shard);
    if let Err(error) = crew.render(frames, check, |frame, finished| draft.add(frame, finished)) {
        draft.abandon();
        return Err(error);
    }
    let marker = draft.finish()?;
    faults::point("shard.files_written");
    let commit = marker.commit(&set.store);
    faults::point("shard.committed");
    let remove = || {
        set.store.delete(&marker.tar_name())?;
        set.store.delete(&marker.rows_name())
    };
    match commit? {
        Commit::Won => Ok(Outcome::Committed(marker)),
        Commit::Lost => remove().map(|()| Outcome::Beaten),
        Commit::Contradicted { existing } => Err(SetError::Damaged(format!(
            "shard {shard} is done with content digest {existing}, here it has {} with CPU features {}; \
             the files of both are kept, see alarm/",
            marker.digest, marker.cpu_features
        ))),
    }
}
