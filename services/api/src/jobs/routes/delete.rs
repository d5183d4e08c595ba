//! `DELETE /v1/jobs/{id}`.

use axum::Json;
use axum::extract::State;
use catalogue::Deleted;
use serde::Serialize;
use utoipa::ToSchema;

use crate::app::Shared;
use crate::http::extract::Path;
use crate::http::problem::Problem;
use crate::jobs::control;

/// What is gone.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = Deleted)]
pub(crate) struct DeletedView {
    /// Jobs.
    jobs: u64,
    /// Images.
    images: u64,
    /// Bytes of their artifacts, counting shared ones each time. What nothing else uses comes back within minutes.
    bytes: u64,
}

impl From<Deleted> for DeletedView {
    fn from(Deleted { jobs, images, bytes }: Deleted) -> Self {
        Self { jobs, images, bytes }
    }
}

/// Delete a job with its images, whatever it is doing.
///
/// It is gone at once and for good; the space comes back in the background. Scenes stay.
#[utoipa::path(delete, path = "/v1/jobs/{id}", tag = "jobs",
    params(("id" = String, Path, description = "`job_…`")),
    responses((status = 200, description = "It is gone.", body = DeletedView),
              (status = 404, response = crate::openapi::Problem)))]
pub(crate) async fn delete(
    State(app): State<Shared>,
    Path(id): Path<String>,
) -> Result<Json<DeletedView>, Problem> {
    Ok(Json(control::delete_job(&app, id).await?.into()))
}
