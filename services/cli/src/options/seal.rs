//! The options of `fathom seal` and `fathom verify`, for a dataset of a service and for a sharded dataset.

use crate::remote::ServerArguments;
use crate::render::LimitArguments;
use crate::styles::StyleArguments;

/// Options of `fathom seal`.
#[derive(clap::Args)]
pub struct SealArguments {
    /// A dataset of the service, or a sharded dataset (SET), which has a slash in its name: s3://BUCKET/PREFIX, /FOLDER, ./FOLDER
    #[arg(value_name = "DATASET|SET")]
    pub what: String,
    /// Of a dataset: print the version as JSON
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub style: StyleArguments,
    #[command(flatten)]
    pub server: ServerArguments,
}

/// Options of `fathom verify`.
#[derive(clap::Args)]
pub struct VerifyArguments {
    /// A sealed version of a dataset, such as tour@1, or a sharded dataset (SET), which has a slash in its name: s3://BUCKET/PREFIX, /FOLDER, ./FOLDER
    #[arg(value_name = "DATASET@VERSION|SET")]
    pub what: String,
    /// Of a version: also read the bytes of every artifact
    #[arg(long)]
    pub bytes: bool,
    /// Of a version: print the findings as JSON
    #[arg(long)]
    pub json: bool,
    /// Of a sharded dataset: read only this number of shards, spread over all
    #[arg(long, value_name = "SHARDS")]
    pub sample: Option<u64>,
    /// Of a sharded dataset: render this number of frames again, spread over all, and compare them
    #[arg(long, value_name = "FRAMES", default_value_t = 0)]
    pub render: u64,
    #[command(flatten)]
    pub style: StyleArguments,
    #[command(flatten)]
    pub limits: LimitArguments,
    #[command(flatten)]
    pub server: ServerArguments,
}

/// Whether a name means a set: sets are written with a slash, which no dataset has in its name.
#[must_use]
pub fn is_set(what: &str) -> bool {
    what.contains('/')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slash_tells_a_set_from_a_dataset() {
        for set in [
            "s3://bucket/set",
            "file:///data/set",
            "/data/set",
            "./set",
            "sets/one",
            "set/",
        ] {
            assert!(is_set(set), "{set}");
        }
        for dataset in ["tour", "tour@1", "tour.2", "."] {
            assert!(!is_set(dataset), "{dataset}");
        }
    }
}
