//! `GET /v1/datasets/{name}/stats`.

use axum::Json;
use axum::extract::State;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use utoipa::{IntoParams, ToSchema};

use crate::app::Shared;
use crate::http::extract::{Path, Query};
use crate::http::problem::Problem;
use crate::images::routes::list::checked_filter;

/// Which metrics, over which images, grouped how.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(crate) struct Parameters {
    /// Metrics, separated by commas.
    #[param(example = "uiqm,hscm.uiqm")]
    metrics: String,
    /// A parameter column; images with the same value form a group.
    #[param(example = "water.style")]
    group_by: Option<String>,
    /// Only images that fulfil this.
    filter: Option<String>,
}

/// Statistics of a metric in a group of images.
#[derive(Debug, Serialize, ToSchema)]
pub(crate) struct GroupStatistics {
    /// Value of the `group_by` column; null without one.
    group: Value,
    /// The metric.
    metric: String,
    /// Images that have a value.
    count: u64,
    /// Their mean.
    mean: Option<f64>,
    /// Their standard deviation.
    sd: Option<f64>,
    /// The smallest value.
    min: Option<f64>,
    /// A quarter of the values is below.
    q25: Option<f64>,
    /// Half of them is below.
    median: Option<f64>,
    /// Three quarters are below.
    q75: Option<f64>,
    /// The largest value.
    max: Option<f64>,
}

/// All groups.
#[derive(Debug, Serialize, ToSchema)]
pub(crate) struct Statistics {
    /// One entry for each group and metric.
    groups: Vec<GroupStatistics>,
}

/// Statistics of metrics over a dataset, per group.
#[utoipa::path(get, path = "/v1/datasets/{name}/stats", tag = "datasets",
    params(("name" = String, Path, description = "Name of the dataset"), Parameters),
    responses((status = 200, description = "Statistics per group and metric.", body = Statistics),
              (status = 404, response = crate::openapi::Problem)))]
pub(crate) async fn stats(
    State(app): State<Shared>,
    Path(name): Path<String>,
    Query(asked): Query<Parameters>,
) -> Result<Json<Statistics>, Problem> {
    let metrics: Vec<_> = asked
        .metrics
        .split(',')
        .map(|metric| metric.trim().to_owned())
        .collect();
    let filter = checked_filter(asked.filter)?;
    let groups = app
        .catalogue
        .stats(&name, &metrics, asked.group_by.as_deref(), filter.as_deref())
        .await?;
    let groups = groups.into_iter().map(|g| GroupStatistics {
        group: g.group,
        metric: g.metric,
        count: g.count,
        mean: g.mean,
        sd: g.sd,
        min: g.min,
        q25: g.q25,
        median: g.median,
        q75: g.q75,
        max: g.max,
    });
    Ok(Json(Statistics {
        groups: groups.collect(),
    }))
}
