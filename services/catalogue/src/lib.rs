//! The SQLite catalogue of jobs, scenes, images, measurements and artifacts.
//!
//! One process opens it. One task writes: it gathers changes that arrive within a few milliseconds into one transaction
//! and replies when that is on the disk. Readers have connections of their own that cannot write. Statements stand in
//! full beside the operation they belong to; values are always bound.

mod about;
mod catalogue;
mod collections;
mod columns;
mod counting;
mod cursor;
mod deletion;
mod density;
mod digests;
mod error;
mod fill;
mod filter;
mod folder;
mod found;
mod gathering;
mod groups;
mod histogram;
mod images;
mod import;
mod insert;
mod jobs;
mod leaf_tree;
mod metadata;
mod migrations;
mod mirror;
mod mirroring;
mod named;
mod open;
mod page;
mod progress;
mod reading;
mod recovery;
mod remembered;
mod restore;
mod row_digests;
mod scenes;
mod scrub;
mod select;
mod stats;
mod tables;
mod types;
mod upkeep;
mod values;
mod versions;
mod waters;
mod writer;

pub use catalogue::Catalogue;
pub use client::{
    CollectionRow, CollectionScene, ColumnInfo, CountedSource, DatasetRow, Deleted, FailureRow, GroupColumn,
    GroupStats, JobRow, JobState, Page, Statistics, UnixMs, VersionRow,
};
pub use density::{Density, DensityAxis, DensityColumns};
pub use error::CatalogueError;
pub use filter::FilterError;
pub use groups::compare_groups;
pub use insert::NewImage;
pub use metadata::columns_of_every_image;
pub use mirroring::MIRROR_ROWS;
pub use scrub::DamagedRow;
pub use types::{
    Histogram, Idempotency, ImageQuery, ImportedArtifact, ImportedShard, InsertImage, InsertJob, NamedDigest,
    NewJob, NewShard, OpenJob, Place, Retried, SceneRow, ShardEnd, StoredArtifact,
};
pub use versions::{SealedImage, VersionJob};
pub use waters::WaterRow;
