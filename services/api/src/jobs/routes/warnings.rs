use catalogue::Page;
use client::FrameWarning;

use crate::http::{Json, Path, Problem, State, Topic};
use crate::jobs::Jobs;

/// Get the warnings of a job's frames, counted by their text.
///
/// Available in every state of the job; counts the first 10 000 frames with warnings so far.
#[utoipa::path(get, path = "/v1/jobs/{id}/warnings", tag = "jobs", operation_id = "list_job_warnings",
    params(("id" = String, Path, description = "`job_…`")),
    responses((status = 200, description = "The most frequent first, on one page.", body = Page<FrameWarning>)))]
pub(crate) async fn warnings(
    State(jobs): Topic<Jobs>,
    Path(id): Path<String>,
) -> Result<Json<Page<FrameWarning>>, Problem> {
    jobs.get(&id).await?;
    Ok(Json(Page::whole(jobs.catalogue.frame_warnings(&id).await?)))
}
