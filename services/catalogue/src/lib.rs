//! The SQLite catalogue of jobs, scenes, images, measurements and artifacts.
//!
//! One process opens it. One task writes: it gathers what callers bring within a few milliseconds into one transaction and
//! answers them when that is on the disk. Readers have connections of their own that cannot write. Statements stand in
//! full beside the operation they belong to; values are always bound.

mod catalogue;
mod columns;
mod cursor;
mod error;
mod filter;
mod images;
mod jobs;
mod page;
mod recovery;
mod scenes;
mod stats;
mod types;
mod writer;

pub use catalogue::Catalogue;
pub use error::CatalogueError;
pub use filter::FilterError;
pub use types::{
    Counts, DatasetRow, FailureRow, GroupStats, Idempotency, ImageQuery, ImageRow, InsertImage, InsertJob,
    JobRow, JobState, NewJob, OpenJob, Page, SceneRow,
};
