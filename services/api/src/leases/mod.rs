//! Who renders which frames: the lease table, the workers, and what they report.

pub(crate) mod changes;
pub(crate) mod costs;
pub(crate) mod dispatch;
mod granted;
pub(crate) mod routes;
mod strikes;
pub mod table;

use std::sync::Arc;

use catalogue::Catalogue;
use tokio_util::sync::CancellationToken;

use crate::bytes::Bytes;
use crate::clock::Clock;
use changes::Changes;
use costs::Costs;
use dispatch::Dispatch;

/// The frames on offer, and what is learned from those that come back.
pub(crate) struct Leases {
    pub(crate) dispatch: Dispatch,
    pub(crate) changes: Changes,
    pub(crate) costs: Costs,
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
            catalogue,
            bytes,
            clock,
            stop,
        }
    }
}
