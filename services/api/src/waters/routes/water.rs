use axum::http::StatusCode;
use catalogue::Page;
use client::WaterView;

use crate::http::{Json, Path, Problem, State, Topic, found};
use crate::waters::Waters;

/// List the optical waters on one page: the shipped ones, then the user-defined ones.
#[utoipa::path(get, path = "/v1/waters", tag = "waters", operation_id = "list_waters",
    responses((status = 200, description = "All waters.", body = Page<WaterView>)))]
pub(crate) async fn list(State(waters): Topic<Waters>) -> Json<Page<WaterView>> {
    Json(Page::whole(waters.all()))
}

/// Get a water. Write the `/` of a full name as `%2F`; a short name selects its default source.
#[utoipa::path(get, path = "/v1/waters/{name}", tag = "waters", operation_id = "get_water",
    params(("name" = String, Path, description = "Name")),
    responses((status = 200, description = "The water.", body = WaterView)))]
pub(crate) async fn get(
    State(waters): Topic<Waters>,
    Path(name): Path<String>,
) -> Result<Json<WaterView>, Problem> {
    Ok(Json(found(waters.find(&name), "water", &name)?))
}

/// Delete your water.
///
/// Accepted jobs contain its numbers: they continue, and their frames can be rendered again. Shipped waters cannot be
/// deleted.
#[utoipa::path(delete, path = "/v1/waters/{name}", tag = "waters", operation_id = "delete_water",
    params(("name" = String, Path, description = "Name")),
    responses((status = 204, description = "Deleted.")))]
pub(crate) async fn delete(
    State(waters): Topic<Waters>,
    Path(name): Path<String>,
) -> Result<StatusCode, Problem> {
    waters.delete(name).await?;
    Ok(StatusCode::NO_CONTENT)
}
