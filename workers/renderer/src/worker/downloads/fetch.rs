//! Fetches data from the service for as long as the lease lasts.

use crate::error::RenderError;
use crate::worker::client::{ClientError, Outcome};
use crate::worker::held::Hold;
use crate::worker::patience::persist;
use crate::worker::shared::Shared;

/// Repeats a call while the lease lasts. `what` names the fetched object in messages.
pub(crate) fn fetch<T>(
    shared: &Shared,
    hold: &Hold,
    what: &str,
    call: impl Fn() -> Outcome<T>,
) -> Result<T, RenderError> {
    let fetched = persist(&shared.stop, || !hold.is_lost(), call).result;
    fetched.map_err(|error| RenderError::Fetch {
        what: what.to_owned(),
        retryable: !matches!(error, ClientError::Refused { .. }),
        reason: error.to_string(),
    })
}

/// Fetches bytes and verifies their digest.
pub(crate) fn fetch_bytes(
    shared: &Shared,
    hold: &Hold,
    what: &str,
    digest: &str,
    call: impl Fn() -> Outcome<Vec<u8>>,
) -> Result<Vec<u8>, RenderError> {
    let bytes = fetch(shared, hold, what, call)?;
    if spec::sha256(&bytes) == digest {
        return Ok(bytes);
    }
    Err(RenderError::Fetch {
        what: what.to_owned(),
        reason: format!("bytes arrived that do not have the digest {digest}"),
        retryable: true,
    })
}
