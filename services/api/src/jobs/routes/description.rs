//! `GET /v1/worker/jobs/{id}`.

use std::sync::Arc;

use axum::extract::State;
use axum::response::IntoResponse;

use crate::http::extract::Path;
use crate::http::problem::{Problem, found};
use crate::http::stored::octets;
use crate::jobs::Jobs;

/// The canonical description of a job, which a lease names by its digest.
pub(crate) async fn description(
    State(jobs): State<Arc<Jobs>>,
    Path(id): Path<String>,
) -> Result<impl IntoResponse, Problem> {
    let description = jobs.catalogue.description(&id).await?;
    if description.is_none() {
        // Deleted between its submission and its offer.
        jobs.leases.dispatch.table(|table, _| table.cancel(&id));
    }
    Ok(octets(found(description, "job", &id)?.into_bytes()))
}
