//! `POST /v1/jobs/{id}/cancel`.

use axum::Json;
use axum::extract::State;

use crate::app::Shared;
use crate::http::extract::Path;
use crate::http::problem::Problem;
use crate::jobs::control;
use crate::jobs::view::JobView;

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
    Ok(Json(control::cancel(&app, id).await?.into()))
}
