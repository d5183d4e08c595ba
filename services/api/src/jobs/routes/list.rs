use crate::http::{Json, Problem, Query, State, Topic, bounds};

use catalogue::{Catalogue, JobRow, JobState, Page};
use serde::Deserialize;
use utoipa::IntoParams;

/// Selection of jobs.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(crate) struct Parameters {
    /// Only jobs of this dataset; `GET /v1/datasets` lists them.
    dataset: Option<String>,
    /// Only jobs in this state.
    #[param(value_type = Option<JobState>)]
    state: Option<String>,
    /// Rows of the page, 1..=1000.
    #[param(default = 100, minimum = 1, maximum = 1000)]
    limit: Option<u32>,
    /// `next_cursor` of the previous page.
    cursor: Option<String>,
}

/// List jobs, newest first.
#[utoipa::path(get, path = "/v1/jobs", tag = "jobs", operation_id = "list_jobs", params(Parameters),
    responses((status = 200, description = "A page of jobs.", body = Page<JobRow>)))]
pub(crate) async fn list(
    State(catalogue): Topic<Catalogue>,
    Query(query): Query<Parameters>,
) -> Result<Json<Page<JobRow>>, Problem> {
    let limit = bounds::check_rows(query.limit)?;
    let page = catalogue.jobs(query.dataset, query.state, limit, query.cursor);
    Ok(Json(page.await?))
}
