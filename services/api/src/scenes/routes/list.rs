use catalogue::{Catalogue, Page};
use client::SceneView;

use crate::http::paging::Paging;
use crate::http::{Json, Problem, Query, State, Topic, bounds};
use crate::scenes::view::view;

/// List uploaded scenes.
#[utoipa::path(get, path = "/v1/scenes", tag = "scenes", operation_id = "list_scenes", params(Paging),
    responses((status = 200, description = "A page of scenes.", body = Page<SceneView>)))]
pub(crate) async fn list(
    State(catalogue): Topic<Catalogue>,
    Query(query): Query<Paging>,
) -> Result<Json<Page<SceneView>>, Problem> {
    let limit = bounds::check_rows(query.limit)?;
    let page = catalogue.scenes(limit, query.cursor).await?;
    Ok(Json(Page {
        items: page.items.into_iter().map(|row| view(row, None)).collect(),
        next_cursor: page.next_cursor,
        damaged: page.damaged,
    }))
}
