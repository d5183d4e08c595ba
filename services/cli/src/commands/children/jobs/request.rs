//! Requests to the service.

use cli::exit::Failure;
use serde::Serialize;
use sets::{JobStore, Location};

use crate::commands::children::lines::{line, write};
use crate::commands::sharded::failure::failure;
use crate::commands::sharded::open::resolved;

/// The canonical location of the store, equal for all services of this machine.
pub(super) fn shared(store: &str) -> Result<JobStore, Failure> {
    let location = Location::parse(store)
        .and_then(Location::absolute)
        .map_err(failure)?;
    // Creates a folder first, so that links to it can be resolved.
    JobStore::open(&location).map_err(failure)?;
    JobStore::open(&resolved(&location)?).map_err(failure)
}

/// Writes a message for the service.
pub(super) fn send(message: &impl Serialize) -> Result<(), Failure> {
    write(&line(message)?)
}
