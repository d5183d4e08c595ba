//! `GET /v1/worker/jobs/{id}`.

use axum::response::IntoResponse;

use crate::http::stored::octets;
use crate::http::{Path, Problem, State, Topic, found};
use crate::jobs::Jobs;

/// The canonical description of a job, which a lease names by its digest.
pub(crate) async fn description(
    State(jobs): Topic<Jobs>,
    Path(id): Path<String>,
) -> Result<impl IntoResponse, Problem> {
    let description = jobs.catalogue.description(&id).await?;
    if description.is_none() {
        // Deleted between its submission and its offer.
        jobs.leases.dispatch.table(|table, _| table.cancel(&id));
    }
    Ok(octets(found(description, "job", &id)?.into_bytes()))
}
