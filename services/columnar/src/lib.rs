//! Images by columns: immutable Parquet files, and aggregation over their rows.
//!
//! A file holds some thousand rows as one row group. Its footer has a checksum of each column, and the catalogue has the digest of the
//! footer, so that no damaged byte is used. A query covers files and rows in memory, in passes over several threads. Sums are exact, so
//! results do not depend on the order of rows or the number of threads.

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
mod stats;
mod sum;
mod top_k;
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
pub use stats::{Group, Summary, stats};
pub use sum::Sum;
pub use top_k::{Order, Sorted, Start, top_k};
pub use write::write;
