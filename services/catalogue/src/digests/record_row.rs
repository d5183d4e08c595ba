//! Records with the digest that covers the record and the identity of its image.

use sqlx::Row;
use sqlx::sqlite::SqliteRow;

use crate::digests::row_digests::RowDigest;
use crate::error::CatalogueError;
use crate::image_id::ImageId;
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
        let (about, record, stored) =
            Self::read(row).map_err(|_| CatalogueError::damaged_image("the record", read_image_id(row)))?;
        let record =
            record.filter(|record: &&str| stored == Some(about.row_digest(&spec::sha256(record.as_bytes()))));
        match record {
            Some(record) => Ok((about, record)),
            None => Err(CatalogueError::damaged_image("the record", about.image())),
        }
    }

    /// The fields, the record and its digest; fails if one of them has another type.
    fn read(row: &'a SqliteRow) -> Result<(Self, Option<&'a str>, Option<i64>), sqlx::Error> {
        let mut cells = Cells::new(row);
        let about = Self {
            job: cells.take()?,
            frame: cells.take()?,
            dataset: cells.take()?,
            created_ms: cells.take()?,
            digest: cells.take()?,
        };
        Ok((about, cells.take()?, cells.take()?))
    }

    pub(crate) fn image(&self) -> ImageId {
        ImageId {
            job: self.job.to_owned(),
            frame: self.frame as u64,
        }
    }
}

/// The image of a row, as far as its fields are readable.
fn read_image_id(row: &SqliteRow) -> ImageId {
    let job = row.try_get_unchecked::<&[u8], _>(0).unwrap_or_default();
    ImageId {
        job: String::from_utf8_lossy(job).into_owned(),
        frame: row.try_get_unchecked::<i64, _>(1).unwrap_or_default() as u64,
    }
}
