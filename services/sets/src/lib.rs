//! Datasets in a store: a folder that machines share, or a bucket.
//!
//! A job is divided into shards. [`run_shard`] renders one and writes it straight into the store; any engine may call it
//! repeatedly. A shard is done when its marker exists, and a marker is created only if absent, so completion state is only in the
//! store: there is no lease, queue or service. `layout` names the objects.

mod error;
mod operations;
mod processes;
mod rows;
mod set;
mod shards;
mod storage;
#[cfg(test)]
mod tests;

pub use error::SetError;
pub use operations::jobs::{JobStore, Submission};
pub use operations::listing::Status;
pub use operations::plan::{Part, Selection, parse_frames};
pub use operations::seal::{Manifest, Source};
pub use operations::verify::Report;
pub use operations::watch::Watch;
pub use processes::child::Recipe;
pub use processes::crew::Crew;
pub use processes::message::{Message, ParcelFile};
pub use rows::cells::{Cell, Kind};
pub use rows::reading::{DoneShard, ShardImage, ShardRows};
pub use rows::table::Table;
pub use set::job::{Card, MOST_EXACT, NewSet};
pub use set::marker::{Commit, FailedFrame, Marker};
pub use set::opened::Set;
pub use set::state::allow_work;
pub use shards::shard::{Outcome, run_shard};
pub use storage::location::Location;
pub use storage::store::{Entry, Store};
pub use storage::upload::FileSum;
