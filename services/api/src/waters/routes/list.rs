//! `GET /v1/waters`.

use std::sync::Arc;

use axum::Json;
use axum::extract::State;
use catalogue::Page;

use crate::waters::Waters;
use crate::waters::view::WaterView;

/// List the optical waters, all on one page: the shipped ones, then the users' own.
#[utoipa::path(get, path = "/v1/waters", tag = "waters",
    responses((status = 200, description = "All waters.", body = Page<WaterView>)))]
pub(crate) async fn list(State(waters): State<Arc<Waters>>) -> Json<Page<WaterView>> {
    Json(Page::whole(waters.all()))
}
