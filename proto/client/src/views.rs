//! The JSON of the API, one type for each schema of its document that a client reads.

mod dataset;
mod job;
mod job_state;
mod operations;
mod page;
mod price;
mod scene;
mod set;
mod statistics;
mod time;
mod version;
mod water;

pub use dataset::{ColumnInfo, DatasetDetail, DatasetRow};
pub use job::{Deleted, FailureRow, FrameWarning, JobPreview, JobRow, ResolvedFrame};
pub use job_state::JobState;
pub use operations::BackupView;
pub use page::Page;
pub use price::{Estimate, Price};
pub use scene::{ClassPixels, CollectionRow, CollectionScene, SceneSummary, SceneView};
pub use set::SetView;
pub use statistics::{CountedSource, GroupColumn, GroupStats, Statistics};
pub use time::UnixMs;
pub use version::{DamagedImage, VerifiedVersion, VersionRow};
pub use water::WaterView;
