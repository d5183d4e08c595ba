//! `GET /v1/scenes`.

use catalogue::{Catalogue, Page};
use serde::Deserialize;
use utoipa::IntoParams;

use crate::http::{Json, Problem, Query, State, Topic, bounds};
use crate::scenes::view::SceneView;

/// Which page.
#[derive(Deserialize, IntoParams)]
#[serde(deny_unknown_fields)]
#[into_params(parameter_in = Query)]
pub(crate) struct Parameters {
    /// Rows of the page, 1..=1000.
    #[param(default = 100, minimum = 1, maximum = 1000)]
    limit: Option<u32>,
    /// `next_cursor` of the page before.
    cursor: Option<String>,
}

/// List uploaded scenes.
#[utoipa::path(get, path = "/v1/scenes", tag = "scenes", operation_id = "list_scenes", params(Parameters),
    responses((status = 200, description = "A page of scenes.", body = Page<SceneView>)))]
pub(crate) async fn list(
    State(catalogue): Topic<Catalogue>,
    Query(asked): Query<Parameters>,
) -> Result<Json<Page<SceneView>>, Problem> {
    let limit = bounds::rows(asked.limit)?;
    let page = catalogue.scenes(limit, asked.cursor).await?;
    Ok(Json(Page {
        items: page.items.into_iter().map(SceneView::from).collect(),
        next_cursor: page.next_cursor,
    }))
}
