//! `job.json`: the job of the set, written once.

use std::ops::Range;

use serde::{Deserialize, Serialize};
use serde_json::Value;
use spec::{Job, is_of_earlier_version};

use crate::error::SetError;
use crate::storage::layout;

/// Version of the layout.
const FORMAT: u32 = 1;
/// Default number of frames of a shard: about a minute of usual frames.
const FRAMES_PER_SHARD: u64 = 500;
/// More frames would make a shard that an engine cannot afford to lose.
const MOST_FRAMES_PER_SHARD: u64 = 100_000;

/// Whole numbers up to this are doubles.
pub const MOST_EXACT: u64 = 1 << 53;

/// The content of `job.json`. The same job and version give the same bytes.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Card {
    format: u32,
    /// SHA-256 of the job's canonical text.
    pub digest: String,
    /// The job's canonical text.
    pub job: String,
    /// Frames of the job.
    pub frames: u64,
    /// Frames of each shard but the last.
    pub frames_per_shard: u64,
    /// Version of the program; another one may render other bytes.
    pub code_version: String,
    /// Metrics of the program, each a column.
    pub metrics: Vec<String>,
}

/// Frames of a shard so that each of `parts` processes has one, if there are enough frames.
fn choose_size(frames: u64, parts: u64) -> u64 {
    let even = frames.div_ceil(parts).max(1);
    let size = if frames.div_ceil(even) < parts {
        (frames / parts).max(1)
    } else {
        even
    };
    size.min(FRAMES_PER_SHARD)
}

/// Fails for a label that the columns of rows, which are doubles, would round.
fn check_labels(job: &Job) -> Result<(), SetError> {
    let description: Value = serde_json::from_str(job.canonical()).unwrap_or_default();
    let labels = description["labels"].as_object().into_iter().flatten();
    for (name, label) in labels {
        if let Some(number) = find_rounded(label) {
            return Err(SetError::Refused(format!(
                "`labels.{name}` is {number}, beyond {MOST_EXACT}: the rows of a sharded dataset would round it; write it as text, or render without shards"
            )));
        }
    }
    Ok(())
}

/// The first whole number in a description that no double equals for certain.
fn find_rounded(description: &Value) -> Option<&Value> {
    let size = description
        .as_u64()
        .or_else(|| description.as_i64().map(i64::unsigned_abs));
    match description {
        Value::Number(_) => size.filter(|size| *size > MOST_EXACT).map(|_| description),
        Value::Array(parts) => parts.iter().find_map(find_rounded),
        Value::Object(parts) => parts.values().find_map(find_rounded),
        _ => None,
    }
}

/// How a new set is made.
pub struct NewSet<'a> {
    /// The job.
    pub job: &'a Job,
    /// Frames of a shard; `None`: as the set has them, or the usual number.
    pub frames_per_shard: Option<u64>,
    /// Processes that share the set; a small job has at least a shard for each.
    pub parts: u64,
    /// Version of the program.
    pub code_version: &'a str,
    /// Metrics of the program.
    pub metrics: Vec<String>,
}

impl Card {
    pub(crate) fn new(set: &NewSet<'_>) -> Result<Self, SetError> {
        let frames_per_shard = set
            .frames_per_shard
            .unwrap_or_else(|| choose_size(set.job.frames(), set.parts.max(1)));
        if !(1..=MOST_FRAMES_PER_SHARD).contains(&frames_per_shard) {
            return Err(SetError::Refused(format!(
                "`--frames-per-shard` is {frames_per_shard}; must be 1 to {MOST_FRAMES_PER_SHARD}"
            )));
        }
        check_labels(set.job)?;
        Ok(Self {
            format: FORMAT,
            digest: set.job.digest(),
            job: set.job.canonical().to_owned(),
            frames: set.job.frames(),
            frames_per_shard,
            code_version: set.code_version.to_owned(),
            metrics: set.metrics.clone(),
        })
    }

    /// Reads a card and the job in it: `None` of version 0.1, whose frames can be read but not rendered.
    pub(crate) fn read(text: &[u8]) -> Result<(Self, Option<Job>), SetError> {
        let unreadable = |reason: &dyn std::fmt::Display| SetError::unreadable(layout::JOB, reason);
        let card: Self = serde_json::from_slice(text)
            .map_err(|error| SetError::Refused(format!("{} is that of no set: {error}", layout::JOB)))?;
        if card.format != FORMAT {
            return Err(SetError::Refused(format!(
                "the set has format {}, this program reads {FORMAT}",
                card.format
            )));
        }
        let job = match is_of_earlier_version(&card.job) {
            true => None,
            false => Some(Job::from_canonical(&card.job).map_err(|error| unreadable(&error))?),
        };
        let is_whole = spec::sha256(card.job.as_bytes()) == card.digest
            && job.as_ref().is_none_or(|job| job.frames() == card.frames)
            && (1..=MOST_FRAMES_PER_SHARD).contains(&card.frames_per_shard);
        if !is_whole {
            return Err(unreadable(&"its parts contradict each other"));
        }
        Ok((card, job))
    }

    /// Refuses to render `wanted` into the set of this card.
    pub(crate) fn accept(&self, wanted: &NewSet<'_>, place: &dyn std::fmt::Display) -> Result<(), SetError> {
        let digest = wanted.job.digest();
        if self.digest != digest {
            return Err(SetError::Refused(format!(
                "{place} holds another job (digest {}, not {digest})",
                self.digest
            )));
        }
        if self.code_version != wanted.code_version {
            return Err(SetError::Refused(format!(
                "{place} was begun by version {}, this is {}: frames could differ",
                self.code_version, wanted.code_version
            )));
        }
        match wanted
            .frames_per_shard
            .filter(|&frames| frames != self.frames_per_shard)
        {
            Some(frames) => Err(SetError::Refused(format!(
                "{place} has {} frames per shard, not {frames}",
                self.frames_per_shard
            ))),
            None => Ok(()),
        }
    }

    /// Number of shards.
    #[must_use]
    pub fn shards(&self) -> u64 {
        self.frames.div_ceil(self.frames_per_shard)
    }

    /// The frames of a shard.
    #[must_use]
    pub fn frames_of(&self, shard: u64) -> Range<u64> {
        let first = shard * self.frames_per_shard;
        first..self.frames.min(first + self.frames_per_shard)
    }

    /// Name of the dataset.
    #[must_use]
    pub fn dataset(&self) -> String {
        let job: Value = serde_json::from_str(&self.job).unwrap_or_default();
        job["dataset"].as_str().unwrap_or_default().to_owned()
    }
}
