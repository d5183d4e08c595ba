//! The assignment of frames to workers: the lease table, the workers, and their reports.

pub(crate) mod changes;
pub(crate) mod checks;
pub(crate) mod costs;
mod descriptions;
pub(crate) mod dispatch;
mod misbehavior;
pub(crate) mod pending;
pub(crate) mod probes;
pub(crate) mod proofs;
pub(crate) mod routes;
mod strikes;
pub mod table;
mod worker;

use std::sync::{Arc, Mutex, PoisonError};

use catalogue::Catalogue;
use tokio_util::sync::CancellationToken;

use crate::bytes::Bytes;
use crate::clock::Clock;
use changes::Changes;
use costs::Costs;
use descriptions::Descriptions;
use dispatch::Dispatch;
use pending::PendingArtifacts;
use probes::Probes;
use proofs::Proofs;
use table::Rules;
pub use worker::Worker;

/// The checks of the service's workers and of others.
pub(crate) struct Checks {
    pub(crate) own: Probes,
    pub(crate) outside: Proofs,
}

/// Leased and queued frames, and the costs learned from finished ones.
pub(crate) struct Leases {
    pub(crate) dispatch: Dispatch,
    pub(crate) changes: Changes,
    pub(crate) costs: Costs,
    descriptions: Descriptions,
    pub(crate) pending: PendingArtifacts,
    pub(crate) probes: Probes,
    pub(crate) proofs: Proofs,
    pub(crate) catalogue: Arc<Catalogue>,
    pub(crate) bytes: Arc<Bytes>,
    /// Workers of a broker.
    elsewhere: Mutex<Vec<Worker>>,
    clock: Clock,
    stop: CancellationToken,
}

impl Leases {
    pub(crate) fn new(
        catalogue: Arc<Catalogue>,
        bytes: Arc<Bytes>,
        clock: Clock,
        rules: Rules,
        checks: Checks,
        stop: CancellationToken,
    ) -> Self {
        Self {
            dispatch: Dispatch::new(clock.clone(), rules),
            changes: Changes::default(),
            costs: Costs::default(),
            descriptions: Descriptions::default(),
            pending: PendingArtifacts::default(),
            probes: checks.own,
            proofs: checks.outside,
            catalogue,
            bytes,
            elsewhere: Mutex::default(),
            clock,
            stop,
        }
    }
}

impl Leases {
    /// All workers: registered ones and those of the broker.
    fn workers(&self) -> Vec<Worker> {
        let mut workers = self.dispatch.workers();
        let elsewhere = self.elsewhere.lock().unwrap_or_else(PoisonError::into_inner);
        workers.extend(elsewhere.iter().cloned());
        workers
    }

    /// Replaces the workers of the broker.
    pub(crate) fn set_workers_elsewhere(&self, workers: Vec<Worker>) {
        *self.elsewhere.lock().unwrap_or_else(PoisonError::into_inner) = workers;
    }
}
