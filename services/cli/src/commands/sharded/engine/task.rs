//! The task of a message.

use serde::{Deserialize, Serialize};

/// A shard to render.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Task {
    /// The location of its set, valid for every worker.
    pub(crate) set: String,
    /// Its number.
    pub(crate) shard: u64,
}

/// First words of every subject.
const PREFIX: &str = "fathom.shards";
/// Hexadecimal digits of a set's name in a subject.
const SET_DIGITS: usize = 24;

impl Task {
    /// The subjects of all tasks.
    pub(crate) fn subjects() -> String {
        format!("{PREFIX}.>")
    }

    /// The subject of this task. The stream keeps one message per subject, so no shard waits twice.
    pub(crate) fn subject(&self) -> String {
        format!("{}.{}", subject_of(&self.set), self.shard)
    }

    /// The subjects of all tasks of a set.
    pub(crate) fn subjects_of(set: &str) -> String {
        format!("{}.*", subject_of(set))
    }
}

fn subject_of(set: &str) -> String {
    let digest = spec::sha256(set.as_bytes());
    format!("{PREFIX}.{}", &digest[..SET_DIGITS])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shard_of_every_set_has_a_subject_of_its_own() {
        let task = |set: &str, shard| Task {
            set: set.to_owned(),
            shard,
        };
        let subject = task("s3://reef/a b.*>", 7).subject();
        let words: Vec<&str> = subject.split('.').collect();
        assert_eq!(
            (words.len(), words[0], words[1], words[3]),
            (4, "fathom", "shards", "7")
        );
        assert!(words[2].bytes().all(|byte| byte.is_ascii_hexdigit()), "{subject}");
        assert_ne!(task("s3://reef/a", 1).subject(), task("s3://reef/b", 1).subject());
        assert_ne!(task("s3://reef/a", 1).subject(), task("s3://reef/a", 2).subject());
    }
}
