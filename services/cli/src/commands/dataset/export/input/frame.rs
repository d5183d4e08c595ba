//! A frame of an export: its files and its place in its job.

use cli::exit::Failure;
use cli::known::is_job_id;
use client::ImageRow;
use serde_json::Value;
use spec::{FrameRecord, sha256};

use crate::commands::dataset::export::format::RECORD;

/// A frame whose files are in the folder.
pub(crate) struct Frame {
    pub(crate) metadata: Value,
    pub(crate) files: Vec<ListedFile>,
    /// Number of files that were fetched.
    pub(crate) fetched: usize,
}

/// A file by its path below the folder that holds the lists.
pub(crate) struct ListedFile {
    pub(crate) kind: String,
    pub(crate) digest: String,
    pub(crate) name: String,
}

impl Frame {
    /// The path of the file of a kind.
    pub(crate) fn file(&self, kind: &str) -> &str {
        let file = self.files.iter().find(|file| file.kind == kind);
        file.map_or("", |file| file.name.as_str())
    }
}

/// Job and frame of a row, checked so that they can be names of folders.
#[derive(Debug, Clone)]
pub(crate) struct Place {
    pub(crate) job: String,
    pub(crate) frame: u64,
}

impl Place {
    pub(crate) fn read(row: &ImageRow) -> Result<Self, Failure> {
        let job = row.text("job").filter(|id| is_job_id(id));
        match (job, row.count("frame")) {
            (Some(job), Some(frame)) => Ok(Self {
                job: job.to_owned(),
                frame,
            }),
            _ => Err(untrusted(format!(
                "an image of job {} and frame {}",
                row.value("job"),
                row.value("frame")
            ))),
        }
    }
}

/// The place of a frame's files: folders below the one with the lists, and a prefix of the file names.
pub(crate) struct Home {
    pub(crate) folders: Vec<String>,
    pub(crate) prefix: String,
}

impl Home {
    /// The layout of `fathom render`, below these folders.
    pub(crate) fn nested(above: &[&str], place: &Place) -> Self {
        let above = above.iter().map(|name| (*name).to_owned());
        let below = [place.job.clone(), place.frame.to_string()];
        Self {
            folders: above.chain(below).collect(),
            prefix: String::new(),
        }
    }
}

/// A requested file.
pub(crate) struct Wanted<'a> {
    pub(crate) kind: &'a str,
    /// SHA-256 of its bytes; of a record, the digest of its frame.
    pub(crate) digest: &'a str,
}

impl<'a> Wanted<'a> {
    /// The file of a kind, by the digest in the row.
    pub(crate) fn read(row: &'a ImageRow, place: &Place, kind: &'a str) -> Result<Self, Failure> {
        let Place { job, frame } = place;
        let is_digest =
            |digest: &&str| digest.len() == 64 && digest.bytes().all(|byte| byte.is_ascii_hexdigit());
        let column = match kind {
            RECORD => "digest".to_owned(),
            kind => format!("artifacts.{kind}"),
        };
        match row.value(&column) {
            Value::Null => Err(Failure::BadInput(format!(
                "image {job}/{frame} has no artifact `{kind}`; leave it out of --kinds, or such images out with --filter"
            ))),
            digest => match digest.as_str().filter(is_digest) {
                Some(digest) => Ok(Self { kind, digest }),
                None => Err(untrusted(format!(
                    "{digest} as the digest of {kind} of {job}/{frame}"
                ))),
            },
        }
    }

    /// Whether these bytes have its digest.
    pub(crate) fn is(&self, bytes: &[u8]) -> bool {
        if self.kind != RECORD {
            return sha256(bytes) == self.digest;
        }
        let record: Result<FrameRecord, _> = serde_json::from_slice(bytes);
        record.is_ok_and(|record| record.digest() == self.digest)
    }
}

/// The error for a response that contradicts itself or another one.
pub(crate) fn untrusted(what: String) -> Failure {
    anyhow::anyhow!("the service sent {what}; it was not written").into()
}
