//! `GET /v1/datasets/{name}/stats`.

use crate::http::{Json, Path, Problem, Query, State, Topic, bounds};

use catalogue::{Catalogue, GroupStats};
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

/// Which metrics, over which images, grouped how.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(crate) struct Parameters {
    /// Metrics, separated by commas; `GET /v1/lists/metrics` lists them. Those of an enhanced picture begin with its method.
    #[param(example = "uiqm,hscm.uiqm")]
    metrics: String,
    /// A column of `GET /v1/datasets/{name}`; images with the same value form a group.
    #[param(example = "water.style")]
    group_by: Option<String>,
    /// Only images that fulfill this.
    filter: Option<String>,
}

/// All groups.
#[derive(Debug, Serialize, ToSchema)]
pub(crate) struct Statistics {
    /// One entry for each group and metric.
    groups: Vec<GroupStats>,
}

/// Statistics of metrics over a dataset, per group.
#[utoipa::path(get, path = "/v1/datasets/{name}/stats", tag = "datasets", operation_id = "get_statistics",
    params(("name" = String, Path, description = "Name of the dataset"), Parameters),
    responses((status = 200, description = "Statistics per group and metric.", body = Statistics)))]
pub(crate) async fn stats(
    State(catalogue): Topic<Catalogue>,
    Path(name): Path<String>,
    Query(asked): Query<Parameters>,
) -> Result<Json<Statistics>, Problem> {
    let metrics = bounds::names(&asked.metrics);
    let filter = bounds::filter(asked.filter)?;
    let groups = catalogue.stats(&name, &metrics, asked.group_by.as_deref(), filter.as_deref());
    Ok(Json(Statistics {
        groups: groups.await?,
    }))
}
