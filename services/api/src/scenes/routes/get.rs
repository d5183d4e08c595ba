use axum::http::StatusCode;
use catalogue::Catalogue;
use client::SceneView;

use crate::http::{Json, Path, Problem, State, Topic, found};
use crate::scenes::Scenes;
use crate::scenes::view::view;

/// Get an uploaded scene.
#[utoipa::path(get, path = "/v1/scenes/{id}", tag = "scenes", operation_id = "get_scene",
    params(("id" = String, Path, description = "`scn_…`")),
    responses((status = 200, description = "The scene.", body = SceneView)))]
pub(crate) async fn get(
    State(catalogue): Topic<Catalogue>,
    Path(id): Path<String>,
) -> Result<Json<SceneView>, Problem> {
    let row = found(catalogue.scene(&id).await?, "scene", &id)?;
    Ok(Json(view(row, None)))
}

/// Delete an uploaded scene that no job uses.
///
/// It is removed from its collections, and its space is reclaimed in the background. A scene with frames in jobs
/// cannot be deleted, because their images could not be rendered again.
#[utoipa::path(delete, path = "/v1/scenes/{id}", tag = "scenes", operation_id = "delete_scene",
    params(("id" = String, Path, description = "`scn_…`")),
    responses((status = 204, description = "Deleted."),
              (status = 409, response = crate::openapi::Problem)))]
pub(crate) async fn delete(
    State(scenes): Topic<Scenes>,
    Path(id): Path<String>,
) -> Result<StatusCode, Problem> {
    scenes.delete(id).await?;
    Ok(StatusCode::NO_CONTENT)
}
