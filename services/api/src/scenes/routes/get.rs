//! `GET /v1/scenes/{id}`.

use catalogue::Catalogue;

use crate::http::{Json, Path, Problem, State, Topic, found};
use crate::scenes::view::SceneView;

/// See an uploaded scene.
#[utoipa::path(get, path = "/v1/scenes/{id}", tag = "scenes", operation_id = "get_scene",
    params(("id" = String, Path, description = "`scn_…`")),
    responses((status = 200, description = "The scene.", body = SceneView)))]
pub(crate) async fn get(
    State(catalogue): Topic<Catalogue>,
    Path(id): Path<String>,
) -> Result<Json<SceneView>, Problem> {
    Ok(Json(found(catalogue.scene(&id).await?, "scene", &id)?.into()))
}
