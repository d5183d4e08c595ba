//! `POST /v1/jobs/{id}/pause`.

use axum::Json;
use axum::extract::State;

use crate::app::Shared;
use crate::http::extract::Path;
use crate::http::problem::Problem;
use crate::jobs::control;
use crate::jobs::view::JobView;

/// Pause a job.
///
/// Workers get none of its frames until it is resumed; what they hold they finish. Pausing a paused job changes
/// nothing.
#[utoipa::path(post, path = "/v1/jobs/{id}/pause", tag = "jobs",
    params(("id" = String, Path, description = "`job_…`")),
    responses((status = 200, description = "The job as it is now.", body = JobView),
              (status = 404, response = crate::openapi::Problem),
              (status = 409, response = crate::openapi::Problem)))]
pub(crate) async fn pause(
    State(app): State<Shared>,
    Path(id): Path<String>,
) -> Result<Json<JobView>, Problem> {
    Ok(Json(control::pause(&app, id).await?.into()))
}
