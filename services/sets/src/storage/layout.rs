//! Names of the objects of a set.
//!
//! ```text
//! job.json                       the job, its shards and the program's version
//! shards/000123-ATTEMPT.tar      artifacts and records of a shard, as one attempt wrote them
//! rows/000123-ATTEMPT.parquet    one row for each image
//! done/000123.json               the marker: which attempt is the shard
//! failed/000123                  empty: the marker lists failed frames
//! alarm/000123-ATTEMPT.json      a marker that contradicts the one that is there
//! state.json                     running, paused or cancelled
//! state.json.lock                empty, only in folders: the lock for changes of state.json
//! manifest.json                  the sealed set
//! deleted.json                   the former job.json of a job that a service has deleted
//! probe/RANDOM                   the remains of a killed process that tested the store
//! ```

use std::fmt;

use crate::error::SetError;

pub(crate) const JOB: &str = "job.json";
pub(crate) const STATE: &str = "state.json";
pub(crate) const MANIFEST: &str = "manifest.json";
pub(crate) const SHARDS: &str = "shards";
pub(crate) const ROWS: &str = "rows";
pub(crate) const DONE: &str = "done";
pub(crate) const FAILED: &str = "failed";
pub(crate) const ALARM: &str = "alarm";
pub(crate) const DELETED: &str = "deleted.json";
pub(crate) const KEYS: &str = "keys";
pub(crate) const PROBE: &str = "probe";

/// One try at a shard: a random name, so that no two tries ever write the same object.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Attempt(String);

impl Attempt {
    /// A new attempt.
    pub(crate) fn random() -> Result<Self, SetError> {
        let mut bytes = [0; 8];
        getrandom::fill(&mut bytes)
            .map_err(|error| SetError::Machine(format!("the system provides no random numbers: {error}")))?;
        Ok(Self(hex::encode(bytes)))
    }
}

impl fmt::Display for Attempt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

pub(crate) fn tar(shard: u64, attempt: &str) -> String {
    format!("{SHARDS}/{shard:06}-{attempt}.tar")
}

pub(crate) fn rows(shard: u64, attempt: &str) -> String {
    format!("{ROWS}/{shard:06}-{attempt}.parquet")
}

pub(crate) fn done(shard: u64) -> String {
    format!("{DONE}/{shard:06}.json")
}

pub(crate) fn failed(shard: u64) -> String {
    format!("{FAILED}/{shard:06}")
}

pub(crate) fn alarm(shard: u64, attempt: &str) -> String {
    format!("{ALARM}/{shard:06}-{attempt}.json")
}

pub(crate) fn probe(attempt: &Attempt) -> String {
    format!("{PROBE}/{attempt}")
}

/// The shard of a marker, a file or an entry of `failed/`.
pub(crate) fn shard_of(name: &str) -> Option<u64> {
    let name = name.rsplit('/').next()?;
    name.split(['-', '.']).next()?.parse().ok()
}

/// The attempt that wrote a file of `shards/` or `rows/`.
pub(crate) fn attempt_of(name: &str) -> Option<&str> {
    name.rsplit_once('-')?
        .1
        .split_once('.')
        .map(|(attempt, _)| attempt)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_sort_by_shard_and_tell_what_they_belong_to() {
        assert!(done(99) < done(100));
        let attempt = Attempt::random().unwrap();
        assert_ne!(attempt, Attempt::random().unwrap());
        let attempt = attempt.to_string();
        for name in [tar(86, &attempt), rows(86, &attempt)] {
            assert_eq!(
                (shard_of(&name), attempt_of(&name)),
                (Some(86), Some(attempt.as_str())),
                "{name}"
            );
        }
        assert_eq!(shard_of(&done(1_234_567)), Some(1_234_567));
        assert_eq!(
            (shard_of("done/note.txt"), attempt_of("done/000001.json")),
            (None, None)
        );
    }
}
