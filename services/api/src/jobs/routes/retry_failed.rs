//! `POST /v1/jobs/{id}/retry-failed`.

use axum::Json;
use axum::extract::State;

use crate::app::Shared;
use crate::http::extract::Path;
use crate::http::problem::Problem;
use crate::jobs::control;
use crate::jobs::view::JobView;

/// Try the failed frames of a job again.
///
/// Their failures are forgotten. A job that had ended with failures goes on.
#[utoipa::path(post, path = "/v1/jobs/{id}/retry-failed", tag = "jobs",
    params(("id" = String, Path, description = "`job_…`")),
    responses((status = 200, description = "The job as it is now.", body = JobView),
              (status = 404, response = crate::openapi::Problem),
              (status = 409, response = crate::openapi::Problem)))]
pub(crate) async fn retry_failed(
    State(app): State<Shared>,
    Path(id): Path<String>,
) -> Result<Json<JobView>, Problem> {
    Ok(Json(control::retry_failed(&app, id).await?.into()))
}
