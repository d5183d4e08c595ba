//! `POST /v1/jobs/{id}/cancel`.

use axum::Json;
use axum::extract::State;
use catalogue::JobState;

use super::view::JobView;
use crate::extract::Path;
use crate::problem::Problem;
use crate::state::Shared;

/// Cancel a job.
///
/// Its finished images stay. Workers drop what they are rendering of it with their next beat. Cancelling a job that
/// has ended changes nothing.
#[utoipa::path(post, path = "/v1/jobs/{id}/cancel", tag = "jobs",
    params(("id" = String, Path, description = "`job_…`")),
    responses((status = 200, description = "The job as it is now.", body = JobView),
              (status = 404, response = crate::openapi::Problem)))]
pub(crate) async fn cancel(
    State(app): State<Shared>,
    Path(id): Path<String>,
) -> Result<Json<JobView>, Problem> {
    let no_such = || Problem::not_found(format!("no job `{id}`"));
    let row = app.catalogue.job(&id).await?.ok_or_else(no_such)?;
    if row.state.has_ended() {
        return Ok(Json(row.into()));
    }
    // Both or none, even if the client goes away: a job that is cancelled on disk must not be offered.
    let task = tokio::spawn(async move {
        let row = app.catalogue.set_state(&id, JobState::Cancelled).await?;
        app.dispatch.cancel(&id);
        app.watch.wake(&id);
        tracing::info!(job = id, "job cancelled");
        Ok::<_, Problem>(row)
    });
    let row = task.await.map_err(|error| Problem::internal(&error))??;
    Ok(Json(row.into()))
}
