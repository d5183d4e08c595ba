//! Datasets in a store: a folder that machines share, or a bucket.
//!
//! A job is divided into shards. [`run_shard`] renders one and writes it straight into the store; any engine may call it
//! repeatedly. A shard is done when its marker exists, and a marker is created only if absent, so completion state is only in the
//! store: there is no lease, queue or service. `layout` names the objects.

mod archive;
mod cells;
mod change;
mod child;
mod columns;
mod crew;
mod digests;
mod draft;
mod error;
mod failure;
#[cfg(test)]
mod faulty;
mod group;
mod job;
mod jobs;
mod layout;
mod listing;
mod location;
mod marker;
mod message;
mod plan;
mod reading;
mod rows;
mod seal;
mod set;
mod shard;
mod state;
mod store;
mod table;
#[cfg(test)]
mod tests;
mod transport;
mod upload;
mod verify;
mod watch;

pub use cells::{Cell, Kind};
pub use child::Recipe;
pub use crew::Crew;
pub use error::SetError;
pub use job::{Card, NewSet};
pub use jobs::{JobStore, Submission};
pub use listing::Status;
pub use location::Location;
pub use marker::{Commit, FailedFrame, Marker};
pub use message::{Message, ParcelFile};
pub use plan::{Part, Selection};
pub use reading::{DoneShard, ShardImage, ShardRows};
pub use seal::{Manifest, Source};
pub use set::Set;
pub use shard::{Outcome, run_shard};
pub use state::allow_work;
pub use store::{Entry, Store};
pub use table::Table;
pub use upload::FileSum;
pub use verify::Report;
pub use watch::Watch;
