//! Which worker renders which frames: the lease table, the workers, and their reports.

pub(crate) mod changes;
mod checks;
pub(crate) mod costs;
mod descriptions;
pub(crate) mod dispatch;
mod granted;
mod liars;
pub(crate) mod puts;
pub(crate) mod routes;
mod strikes;
pub mod table;

use std::sync::Arc;

use catalogue::Catalogue;
use serde::Serialize;
use tokio_util::sync::CancellationToken;
use utoipa::ToSchema;

use crate::bytes::Bytes;
use crate::clock::Clock;
use changes::Changes;
use costs::Costs;
use descriptions::Descriptions;
use dispatch::Dispatch;
use puts::Puts;

/// Leased and queued frames, and the costs learned from finished ones.
pub(crate) struct Leases {
    pub(crate) dispatch: Dispatch,
    pub(crate) changes: Changes,
    pub(crate) costs: Costs,
    descriptions: Descriptions,
    pub(crate) puts: Puts,
    pub(crate) catalogue: Arc<Catalogue>,
    pub(crate) bytes: Arc<Bytes>,
    clock: Clock,
    stop: CancellationToken,
}

impl Leases {
    pub(crate) fn new(
        catalogue: Arc<Catalogue>,
        bytes: Arc<Bytes>,
        clock: Clock,
        stop: CancellationToken,
    ) -> Self {
        Self {
            dispatch: Dispatch::new(clock.clone()),
            changes: Changes::default(),
            costs: Costs::default(),
            descriptions: Descriptions::default(),
            puts: Puts::default(),
            catalogue,
            bytes,
            clock,
            stop,
        }
    }
}

/// A worker process.
#[derive(Debug, Serialize, ToSchema)]
pub(crate) struct Worker {
    /// `wrk_…`, new with every registration.
    pub(crate) id: String,
    /// The name it gave itself; the service's own are `local-1`, `local-2`, …
    pub(crate) name: String,
    /// Frames that it renders side by side.
    pub(crate) slots: u32,
    /// Frames that it holds.
    pub(crate) leased_frames: u64,
    /// Milliseconds since it was last heard of.
    pub(crate) silent_ms: u64,
    /// Version of its code.
    pub(crate) code_version: String,
    /// Version of its ONNX Runtime; null: none.
    pub(crate) onnx_runtime: Option<String>,
    /// CPU features that choose its code paths.
    pub(crate) cpu_features: String,
}
