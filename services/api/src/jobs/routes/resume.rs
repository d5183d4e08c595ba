//! `POST /v1/jobs/{id}/resume`.

use axum::Json;
use axum::extract::State;

use crate::app::Shared;
use crate::http::extract::Path;
use crate::http::problem::Problem;
use crate::jobs::control;
use crate::jobs::view::JobView;

/// Resume a paused job.
///
/// Resuming a job that is not paused but goes on changes nothing.
#[utoipa::path(post, path = "/v1/jobs/{id}/resume", tag = "jobs",
    params(("id" = String, Path, description = "`job_…`")),
    responses((status = 200, description = "The job as it is now.", body = JobView),
              (status = 404, response = crate::openapi::Problem),
              (status = 409, response = crate::openapi::Problem)))]
pub(crate) async fn resume(
    State(app): State<Shared>,
    Path(id): Path<String>,
) -> Result<Json<JobView>, Problem> {
    Ok(Json(control::resume(&app, id).await?.into()))
}
