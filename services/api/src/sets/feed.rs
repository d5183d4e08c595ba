//! Messages of a set reader, one line of JSON each. The reader is a separate process: the service has no code for
//! Parquet and S3, and the reader none for the catalogue.
//!
//! The reader writes [`Line::Set`] and waits for a line of [`Known`]. Then it writes [`Line::Part`] for each new or
//! changed shard, those of one shard in order, and exits. Exit status on failure: 2 for a set that cannot be shown, 5
//! for a store that does not respond, 1 for an inconsistent set.

use std::collections::BTreeMap;

use catalogue::NewShard;
use serde::{Deserialize, Serialize};
use spec::RecordText;

/// A line.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Line {
    /// The head of the set.
    Set(SetHead),
    /// Images of a shard.
    Part(SetPart),
}

/// The head of a set.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct SetHead {
    /// Location in canonical form.
    pub location: String,
    /// Canonical text of its job.
    pub job: String,
    /// Name of its dataset.
    pub dataset: String,
    /// Frames of its job.
    pub frames: u64,
}

/// Images of a shard to be stored together.
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
    /// The record.
    pub record: RecordText,
    /// Rendering time by the clock of its machine.
    pub created_ms: u64,
    /// Offsets of its artifacts in the tar of its shard, by kind.
    pub offsets: BTreeMap<String, u64>,
}

/// Imported shards by first frame, with the time of their markers.
pub type Known = BTreeMap<u64, i64>;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_of_other_builds_can_be_read() {
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
