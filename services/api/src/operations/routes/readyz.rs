//! `GET /readyz`.

use std::sync::Arc;

use axum::extract::State;

use crate::http::problem::{Problem, Slug};
use crate::operations::Operations;

/// Whether requests can be answered: the catalogue is readable, there is space, and the service is not stopping.
///
/// A full disk is looked at again each time: as soon as there is space the answer is 200.
#[utoipa::path(get, path = "/readyz", tag = "operations", security(()),
    responses((status = 200, description = "Ready.", body = String),
              (status = 507, response = crate::openapi::Problem)))]
pub(crate) async fn readyz(State(operations): State<Arc<Operations>>) -> Result<&'static str, Problem> {
    if operations.stop.is_cancelled() {
        return Err(Problem::overloaded("the service is stopping"));
    }
    if operations.bytes.space.is_full().await {
        let detail = "there is no space left for the data directory; reading goes on";
        return Err(Problem::new(Slug::StorageFull, detail));
    }
    operations
        .catalogue
        .job("")
        .await
        .map_err(|error| Problem::overloaded(error.to_string()))?;
    Ok("ready\n")
}
