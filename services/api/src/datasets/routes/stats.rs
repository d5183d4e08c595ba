use crate::http::{Json, Path, Problem, Query, Slug, State, Topic, bounds};

use catalogue::{Catalogue, GroupColumn, GroupStats, GroupedStats, Source};
use serde::{Deserialize, Serialize};
use utoipa::{IntoParams, ToSchema};

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

/// Statistics of all groups.
#[derive(Debug, Serialize, ToSchema)]
pub(crate) struct Statistics {
    /// The columns of `by`; absent without it.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    by: Option<Vec<GroupColumn>>,
    /// One entry per group and metric.
    groups: Vec<GroupStats>,
    /// Storage that the query read.
    source: Source,
}

/// Get statistics of metrics over a dataset, per group.
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
    let Some(by) = query.by else {
        let groups = catalogue.stats(&name, &metrics, query.group_by.as_deref(), filter.as_deref());
        let GroupedStats { groups, source, .. } = groups.await?;
        return Ok(Json(Statistics {
            by: None,
            groups,
            source,
        }));
    };
    if query.group_by.is_some() {
        let detail = "give `by` or `group_by`, not both";
        return Err(Problem::new(Slug::InvalidQuery, detail));
    }
    let stats = catalogue.grouped_stats(&name, &metrics, &by, filter.as_deref());
    let GroupedStats { by, groups, source } = stats.await?;
    Ok(Json(Statistics {
        by: Some(by),
        groups,
        source,
    }))
}
