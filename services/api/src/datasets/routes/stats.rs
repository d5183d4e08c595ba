use crate::http::{Json, Path, Problem, Query, Slug, State, Topic, bounds};

use catalogue::{Catalogue, Statistics};
use serde::Deserialize;
use utoipa::IntoParams;

/// Metrics, filter and grouping.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(crate) struct Parameters {
    /// Metrics, separated by commas; `GET /v1/lists/metrics` lists them. Names of enhanced images begin with the
    /// method.
    #[param(example = "uiqm,hscm.uiqm")]
    metrics: String,
    /// A column listed by `GET /v1/datasets/{name}`; images with the same value form a group.
    #[param(example = "water.style")]
    group_by: Option<String>,
    /// Instead of `group_by`: up to 8 columns, separated by commas, numeric ones as `COLUMN:WIDTH`. Images with the
    /// same value of each column, or in the same bin, form a group. Bins begin at multiples of the width. At most
    /// 1000 groups, ordered by their values.
    #[param(example = "water.optics,alpha:0.1")]
    by: Option<String>,
    /// Only images that match this filter.
    filter: Option<String>,
}

/// Statistics of metrics over a dataset, per group.
#[utoipa::path(get, path = "/v1/datasets/{name}/stats", tag = "datasets", operation_id = "get_statistics",
    params(("name" = String, Path, description = "Name of the dataset"), Parameters),
    responses((status = 200, description = "Statistics per group and metric.", body = Statistics)))]
pub(crate) async fn stats(
    State(catalogue): Topic<Catalogue>,
    Path(name): Path<String>,
    Query(query): Query<Parameters>,
) -> Result<Json<Statistics>, Problem> {
    let metrics = bounds::split_names(&query.metrics);
    let filter = bounds::check_filter(query.filter)?;
    let statistics = match (&query.by, &query.group_by) {
        (Some(_), Some(_)) => {
            return Err(Problem::new(
                Slug::InvalidQuery,
                "give `by` or `group_by`, not both",
            ));
        }
        (Some(by), None) => {
            catalogue
                .grouped_stats(&name, &metrics, by, filter.as_deref())
                .await?
        }
        (None, group_by) => {
            catalogue
                .stats(&name, &metrics, group_by.as_deref(), filter.as_deref())
                .await?
        }
    };
    Ok(Json(statistics))
}
