use axum::http::StatusCode;
use catalogue::{Catalogue, CollectionRow, CollectionScene, Page};

use crate::http::{Json, Path, Problem, State, Topic};

/// List the collections of uploaded scenes on one page.
#[utoipa::path(get, path = "/v1/collections", tag = "scenes", operation_id = "list_collections",
    responses((status = 200, description = "All collections by name.", body = Page<CollectionRow>)))]
pub(crate) async fn list(State(catalogue): Topic<Catalogue>) -> Result<Json<Page<CollectionRow>>, Problem> {
    Ok(Json(Page::whole(catalogue.collections().await?)))
}

/// Get the scenes of a collection in the order used by jobs, on one page.
#[utoipa::path(get, path = "/v1/collections/{name}", tag = "scenes", operation_id = "get_collection",
    params(("name" = String, Path, description = "Name")),
    responses((status = 200, description = "The scenes.", body = Page<CollectionScene>)))]
pub(crate) async fn get(
    State(catalogue): Topic<Catalogue>,
    Path(name): Path<String>,
) -> Result<Json<Page<CollectionScene>>, Problem> {
    let scenes = catalogue.collection(&name).await?;
    if scenes.is_empty() {
        return Err(Problem::not_found(format!("no collection `{name}`")));
    }
    Ok(Json(Page::whole(scenes)))
}

/// Delete a collection. Its scenes are kept, and so are jobs that use it.
#[utoipa::path(delete, path = "/v1/collections/{name}", tag = "scenes", operation_id = "delete_collection",
    params(("name" = String, Path, description = "Name")),
    responses((status = 204, description = "Deleted.")))]
pub(crate) async fn delete(
    State(catalogue): Topic<Catalogue>,
    Path(name): Path<String>,
) -> Result<StatusCode, Problem> {
    if !catalogue.delete_collection(&name).await? {
        return Err(Problem::not_found(format!("no collection `{name}`")));
    }
    Ok(StatusCode::NO_CONTENT)
}
