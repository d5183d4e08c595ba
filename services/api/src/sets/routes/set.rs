use catalogue::{Deleted, Page};
use client::SetView;

use crate::http::{Json, Path, Problem, State, Topic};
use crate::sets::Sets;

/// List the imported sets on one page, newest first.
#[utoipa::path(get, path = "/v1/sets", tag = "sets", operation_id = "list_sets",
    responses((status = 200, description = "All sets.", body = Page<SetView>)))]
pub(crate) async fn list(State(sets): Topic<Sets>) -> Result<Json<Page<SetView>>, Problem> {
    Ok(Json(Page::whole(sets.all().await?)))
}

/// Get a set. To wait for its next change, wait for its job.
#[utoipa::path(get, path = "/v1/sets/{job}", tag = "sets", operation_id = "get_set",
    params(("job" = String, Path, description = "`job_…`")),
    responses((status = 200, description = "The set.", body = SetView)))]
pub(crate) async fn get(State(sets): Topic<Sets>, Path(job): Path<String>) -> Result<Json<SetView>, Problem> {
    Ok(Json(sets.get(&job).await?))
}

/// Remove a set: its job and the rows of its images are deleted from this service.
///
/// The set itself is unchanged and can be imported again.
#[utoipa::path(delete, path = "/v1/sets/{job}", tag = "sets", operation_id = "forget_set",
    params(("job" = String, Path, description = "`job_…`")),
    responses((status = 200, description = "Removed.", body = Deleted)))]
pub(crate) async fn delete(
    State(sets): Topic<Sets>,
    Path(job): Path<String>,
) -> Result<Json<Deleted>, Problem> {
    Ok(Json(sets.delete(&job).await?))
}
