//! The worker's registration with a service, renewed after the service has restarted.

use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use wire::messages::{RegisterRequest, RegisterResponse};

use super::client::{Client, Outcome};
use super::patience::persist;
use super::stop::Stop;

/// The worker's registration.
pub(crate) struct Membership {
    about: RegisterRequest,
    registered: Mutex<RegisterResponse>,
}

impl Membership {
    /// Registers; waits for a service that is unavailable. `None` if the worker is stopped first.
    pub(crate) fn join(client: &Client, about: RegisterRequest, stop: &Stop) -> Outcome<Option<Self>> {
        let joined = persist(stop, || !stop.is_set(), || client.register(&about)).result;
        if stop.is_set() {
            return Ok(None);
        }
        let registered = Mutex::new(joined?);
        Ok(Some(Self { about, registered }))
    }

    /// `wrk_…`.
    pub(crate) fn worker_id(&self) -> String {
        self.registered().worker_id.clone()
    }

    /// The heartbeat interval.
    pub(crate) fn beat_interval(&self) -> Duration {
        Duration::from_millis(self.registered().beat_ms.into())
    }

    /// Registers under a new id, unless another thread has already replaced the id `forgotten`.
    pub(crate) fn rejoin(&self, client: &Client, forgotten: &str) -> Outcome<()> {
        let mut registered = self.registered();
        if registered.worker_id == forgotten {
            *registered = client.register(&self.about)?;
            let worker = &registered.worker_id;
            tracing::info!(worker, was = forgotten, "joined the service again");
        }
        Ok(())
    }

    fn registered(&self) -> MutexGuard<'_, RegisterResponse> {
        self.registered.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
