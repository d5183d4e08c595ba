use axum::response::IntoResponse;
use serde_json::Value;

use crate::http::stored::octets;
use crate::http::{Json, Path, Problem, State, Topic, found};
use crate::jobs::Jobs;

/// Get the description of a job, with defaults filled in and distributions kept.
#[utoipa::path(get, path = "/v1/jobs/{id}/description", tag = "jobs", operation_id = "get_job_description",
    params(("id" = String, Path, description = "`job_…`")),
    responses((status = 200, description = "The description.", body = Value)))]
pub(crate) async fn get(State(jobs): Topic<Jobs>, Path(id): Path<String>) -> Result<Json<Value>, Problem> {
    let description = found(jobs.catalogue.description(&id).await?, "job", &id)?;
    let value = serde_json::from_str(&description).map_err(|error| Problem::internal(&error))?;
    Ok(Json(value))
}

/// Returns the canonical description of a job, which a lease identifies by its digest.
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
