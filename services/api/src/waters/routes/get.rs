//! `GET /v1/waters/{name}`.

use std::sync::Arc;

use axum::Json;
use axum::extract::State;

use crate::http::extract::Path;
use crate::http::problem::{Problem, found};
use crate::waters::Waters;
use crate::waters::view::WaterView;

/// See one water. The `/` of a full name is written `%2F`; a bare name means its default source.
#[utoipa::path(get, path = "/v1/waters/{name}", tag = "waters",
    params(("name" = String, Path, description = "Its name")),
    responses((status = 200, description = "The water.", body = WaterView)))]
pub(crate) async fn get(
    State(waters): State<Arc<Waters>>,
    Path(name): Path<String>,
) -> Result<Json<WaterView>, Problem> {
    Ok(Json(found(waters.find(&name), "water", &name)?))
}
