//! Records with the digest that covers the record and the identity of its image.

use sqlx::sqlite::SqliteRow;

use crate::digests::row_digests::RowDigest;
use crate::error::CatalogueError;
use crate::query::cells::Cells;

/// The fields of a record's digest besides the record.
pub(crate) struct About<'a> {
    pub(crate) job: &'a str,
    pub(crate) frame: i64,
    pub(crate) dataset: &'a str,
    pub(crate) created_ms: i64,
    /// Of the frame.
    pub(crate) digest: &'a str,
}

impl<'a> About<'a> {
    /// `record_digest`: SHA-256 of the record.
    pub(crate) fn row_digest(&self, record_digest: &str) -> i64 {
        let mut digest = RowDigest::default();
        digest.add_text("job_id", self.job);
        digest.add_whole("frame", self.frame);
        digest.add_text("dataset", self.dataset);
        digest.add_whole("created_ms", self.created_ms);
        digest.add_text("digest", self.digest);
        digest.add_text("record", record_digest);
        digest.end()
    }

    /// Reads a row that begins with these fields, record and digest; returns them with the record (JSON) if the digest matches.
    pub(crate) fn verified(row: &'a SqliteRow) -> Result<(Self, &'a str), CatalogueError> {
        let mut cells = Cells::new(row);
        let about = Self {
            job: cells.take()?,
            frame: cells.take()?,
            dataset: cells.take()?,
            created_ms: cells.take()?,
            digest: cells.take()?,
        };
        let (record, stored): (Option<&str>, Option<i64>) = (cells.take()?, cells.take()?);
        let Some(record) =
            record.filter(|record: &&str| stored == Some(about.row_digest(&spec::sha256(record.as_bytes()))))
        else {
            return Err(CatalogueError::damaged(format!(
                "the record of {}/{}",
                about.job, about.frame
            )));
        };
        Ok((about, record))
    }
}
