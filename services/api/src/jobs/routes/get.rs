//! `GET /v1/jobs/{id}`, with long-poll.

use std::time::Duration;

use axum::Json;
use axum::extract::State;
use serde::Deserialize;
use utoipa::IntoParams;

use crate::app::Shared;
use crate::http::extract::{Path, Query};
use crate::http::problem::{Problem, Slug};
use crate::jobs::view::JobView;
use crate::jobs::wait::{Until, wait_for_job};
use crate::limits;

/// How long to wait, and for what.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(crate) struct Parameters {
    /// Seconds to wait at most, 0..=60.
    #[param(default = 0, maximum = 60)]
    wait: Option<u64>,
    /// Answer as soon as the job's version is larger than this. Without it, wait until the job has ended.
    since: Option<u64>,
}

/// See a job, or wait for it to change.
///
/// A job that has ended is always answered at once.
#[utoipa::path(get, path = "/v1/jobs/{id}", tag = "jobs",
    params(("id" = String, Path, description = "`job_…`"), Parameters),
    responses((status = 200, description = "The job as it is now.", body = JobView),
              (status = 404, response = crate::openapi::Problem)))]
pub(crate) async fn get(
    State(app): State<Shared>,
    Path(id): Path<String>,
    Query(asked): Query<Parameters>,
) -> Result<Json<JobView>, Problem> {
    let limit = bearable(asked.wait.unwrap_or(0))?;
    let until = asked.since.map_or(Until::Ended, Until::After);
    let row = wait_for_job(&app, &id, limit, until).await?;
    Ok(Json(row.into()))
}

fn bearable(seconds: u64) -> Result<Duration, Problem> {
    let limit = limits::MAX_WAIT;
    match Duration::from_secs(seconds) {
        wait if wait <= limit => Ok(wait),
        _ => {
            let detail = format!("wait: is {seconds} but must be in 0..={}", limit.as_secs());
            Err(Problem::new(Slug::InvalidQuery, detail))
        }
    }
}
