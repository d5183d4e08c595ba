//! The SQLite catalogue of jobs, scenes, images, measurements and artifacts.
//!
//! One process opens it. One task writes: it combines changes that arrive within a few milliseconds into one transaction and replies
//! when that is on the disk. Readers use separate connections that cannot write. Statements are written out next to their operation;
//! values are always bound.

mod aggregation;
mod catalogue;
mod commit;
mod damage;
mod datasets;
mod digests;
mod error;
mod image_id;
mod images;
mod jobs;
mod maintenance;
mod open;
mod pages;
mod query;
mod replica;
mod schema;
mod types;
mod uploads;

pub use aggregation::groups::compare_groups;
pub use aggregation::histogram_2d::{Histogram2d, Histogram2dAxis, Histogram2dColumns};
pub use catalogue::Catalogue;
pub use client::{
    CollectionRow, CollectionScene, ColumnInfo, CountedSource, DatasetRow, Deleted, FailureRow, GroupColumn,
    GroupStats, JobRow, JobState, Page, Price, Statistics, UnixMs, VersionRow,
};
pub use commit::insert::NewImage;
pub use damage::ImageDamage;
pub use datasets::columns::columns_of_every_image;
pub use datasets::versions::{SealedImage, VersionJob};
pub use error::{CatalogueError, FilterError};
pub use image_id::ImageId;
pub use maintenance::replica::REPLICA_ROWS;
pub use maintenance::scrub::DamagedRow;
pub use query::filter::{ComparedText, find_texts};
pub use types::{
    Charge, Delivery, DueCheck, FrameRows, Histogram, Idempotency, ImageQuery, ImportedArtifact,
    ImportedShard, InsertImage, InsertJob, NamedDigest, NewJob, NewShard, OpenJob, Place, Retried, SceneRow,
    Settled, ShardEnd, StoredArtifact,
};
pub use uploads::waters::WaterRow;
