//! `GET /v1/waters`; `GET` and `DELETE /v1/waters/{name}`.

use axum::http::StatusCode;
use catalogue::Page;
use client::WaterView;

use crate::http::{Json, Path, Problem, State, Topic, found};
use crate::waters::Waters;

/// List the optical waters, all on one page: the shipped ones, then the users' own.
#[utoipa::path(get, path = "/v1/waters", tag = "waters", operation_id = "list_waters",
    responses((status = 200, description = "All waters.", body = Page<WaterView>)))]
pub(crate) async fn list(State(waters): Topic<Waters>) -> Json<Page<WaterView>> {
    Json(Page::whole(waters.all()))
}

/// See one water. The `/` of a full name is written `%2F`; a bare name means its default source.
#[utoipa::path(get, path = "/v1/waters/{name}", tag = "waters", operation_id = "get_water",
    params(("name" = String, Path, description = "Its name")),
    responses((status = 200, description = "The water.", body = WaterView)))]
pub(crate) async fn get(
    State(waters): Topic<Waters>,
    Path(name): Path<String>,
) -> Result<Json<WaterView>, Problem> {
    Ok(Json(found(waters.find(&name), "water", &name)?))
}

/// Delete a water of your own.
///
/// Jobs that were accepted hold its numbers: they go on, and their frames can be rendered again. Shipped waters stay.
#[utoipa::path(delete, path = "/v1/waters/{name}", tag = "waters", operation_id = "delete_water",
    params(("name" = String, Path, description = "Its name")),
    responses((status = 204, description = "It is gone.")))]
pub(crate) async fn delete(
    State(waters): Topic<Waters>,
    Path(name): Path<String>,
) -> Result<StatusCode, Problem> {
    waters.delete(name).await?;
    Ok(StatusCode::NO_CONTENT)
}
