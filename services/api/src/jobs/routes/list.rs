//! `GET /v1/jobs`.

use axum::Json;
use axum::extract::State;
use serde::Deserialize;
use utoipa::IntoParams;

use crate::app::Shared;
use crate::http::extract::Query;
use crate::http::paging::{Page, rows};
use crate::http::problem::Problem;
use crate::jobs::view::JobView;

/// Which jobs.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(crate) struct Parameters {
    /// Only jobs of this dataset.
    dataset: Option<String>,
    /// Only jobs in this state.
    state: Option<String>,
    /// Rows of the page, 1..=1000.
    #[param(default = 100)]
    limit: Option<u32>,
    /// `next_cursor` of the page before.
    cursor: Option<String>,
}

/// List jobs, newest first.
#[utoipa::path(get, path = "/v1/jobs", tag = "jobs", params(Parameters),
    responses((status = 200, description = "A page of jobs.", body = Page<JobView>)))]
pub(crate) async fn list(
    State(app): State<Shared>,
    Query(asked): Query<Parameters>,
) -> Result<Json<Page<JobView>>, Problem> {
    let limit = rows(asked.limit)?;
    let page = app
        .catalogue
        .jobs(asked.dataset, asked.state, limit, asked.cursor)
        .await?;
    let items = page.items.into_iter().map(JobView::from).collect();
    Ok(Json(Page {
        items,
        next_cursor: page.next_cursor,
    }))
}
