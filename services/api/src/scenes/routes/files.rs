use crate::http::{Json, Path, Problem, State, Topic, found};
use catalogue::Catalogue;
use spec::SceneFiles;

/// Returns the data a worker needs to load an uploaded scene.
pub(crate) async fn scene(
    State(catalogue): Topic<Catalogue>,
    Path(id): Path<String>,
) -> Result<Json<SceneFiles<String>>, Problem> {
    Ok(Json(found(catalogue.scene(&id).await?, "scene", &id)?.files))
}
