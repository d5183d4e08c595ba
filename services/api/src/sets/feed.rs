//! What a reader of a set tells, a line of JSON each. The reader is a process of its own: a service has no code for Parquet
//! and S3, and the reader none for the catalogue.
//!
//! The reader writes [`Line::Set`] and waits for a line of [`Known`]. Then it writes [`Line::Part`] for each shard that is
//! not known or has changed, those of one shard in order, and ends. Its exit status says why it ended earlier: 2 for a set that
//! cannot be shown, 5 for a store that does not respond, 1 for a set that contradicts itself.

use std::collections::BTreeMap;

use catalogue::NewShard;
use serde::{Deserialize, Serialize};
use spec::RecordText;

/// A line.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Line {
    /// What the set is of.
    Set(SetHead),
    /// Images of a shard.
    Part(SetPart),
}

/// What a set is of.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct SetHead {
    /// Where it lies, in the one form by which it is found again.
    pub location: String,
    /// Canonical text of its job.
    pub job: String,
    /// Name of its dataset.
    pub dataset: String,
    /// Frames of its job.
    pub frames: u64,
}

/// Images of a shard that are stored together.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct SetPart {
    /// The images.
    pub images: Vec<SetImage>,
    /// Their shard.
    pub shard: NewShard,
}

/// An image of a set.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub struct SetImage {
    /// Everything known about it.
    pub record: RecordText,
    /// When it was rendered, by the clock of its machine.
    pub created_ms: u64,
    /// Where its artifacts begin in the tar of its shard, by kind.
    pub offsets: BTreeMap<String, u64>,
}

/// Shards that are imported, by their first frame, with the time of their markers.
pub type Known = BTreeMap<u64, i64>;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_what_the_reader_of_another_build_would_write() {
        let part = r#"{"part":{"images":[],"shard":{"frame":500,"tar":"shards/000001-ab.tar","end":{"digest":"d","changed_ms":7,
            "failed":[{"frame":501,"strikes":3,"given_up":true,"error":"e"}]}}}}"#;
        let Line::Part(part) = serde_json::from_str(part).unwrap() else {
            panic!("a part");
        };
        assert_eq!(part.shard.frame, 500);
        assert_eq!(part.shard.end.unwrap().failed[0].frame, 501);
        let known: Known = serde_json::from_str(r#"{"0":3,"500":7}"#).unwrap();
        assert_eq!(known, Known::from([(0, 3), (500, 7)]));
    }
}
