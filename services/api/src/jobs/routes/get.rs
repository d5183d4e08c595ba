use catalogue::JobRow;
use serde::Deserialize;
use utoipa::IntoParams;

use crate::http::{Json, Path, Problem, Query, State, Topic, bounds};
use crate::jobs::Jobs;
use crate::jobs::wait::Until;

/// Long-poll parameters.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(crate) struct Parameters {
    /// Maximum wait in seconds, 0..=60.
    #[param(default = 0, maximum = 60)]
    wait: Option<u64>,
    /// Return as soon as the job's version is larger than this. Without it, wait until the job has ended.
    since: Option<u64>,
}

/// Get a job, or wait for it to change.
///
/// A job that has ended is returned immediately.
#[utoipa::path(get, path = "/v1/jobs/{id}", tag = "jobs", operation_id = "get_job",
    params(("id" = String, Path, description = "`job_…`"), Parameters),
    responses((status = 200, description = "The present state of the job.", body = JobRow)))]
pub(crate) async fn get(
    State(jobs): Topic<Jobs>,
    Path(id): Path<String>,
    Query(query): Query<Parameters>,
) -> Result<Json<JobRow>, Problem> {
    let limit = bounds::check_wait(query.wait)?;
    let until = query.since.map_or(Until::Ended, Until::After);
    Ok(Json(jobs.wait(&id, limit, until).await?))
}
