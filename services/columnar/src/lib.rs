//! Images by columns: Parquet files that are written once, and questions that count their rows.
//!
//! A file holds some thousand rows as one row group. Its footer has a checksum of each column, and who names the file knows the
//! digest of the footer, so that no damaged byte is ever counted. Questions go over files and over rows from elsewhere alike, in
//! passes of which each is spread over threads; every sum is exact, so that neither the order of rows nor the number of threads
//! changes a bit of an answer.

mod bins;
mod cache;
mod column;
mod condition;
mod error;
mod file;
mod groups;
mod histogram;
mod histogram_2d;
mod parts;
mod ranked;
mod stats;
mod sum;
mod write;

pub use bins::Bins;
pub use cache::Cache;
pub use column::{Column, ColumnBuilder, Kind};
pub use condition::{Condition, Sign, Test, Value};
pub use error::ColumnarError;
pub use file::{About, Named, ReplicaFile};
pub use groups::{Cell, GroupBy};
pub use histogram::{Counts, histogram};
pub use histogram_2d::{Axes, Histogram2d, histogram_2d};
pub use parts::{Part, Query, Source};
pub use ranked::{Order, Sorted, Start, ranked};
pub use stats::{Group, Summary, stats};
pub use sum::Sum;
pub use write::write;
