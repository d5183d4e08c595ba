//! `GET /v1/workers`.

use std::sync::Arc;

use axum::Json;
use axum::extract::State;
use catalogue::Page;

use crate::leases::{Leases, Worker};

/// List the workers that are registered, all on one page.
#[utoipa::path(get, path = "/v1/workers", tag = "operations",
    responses((status = 200, description = "All workers.", body = Page<Worker>)))]
pub(crate) async fn list(State(leases): State<Arc<Leases>>) -> Json<Page<Worker>> {
    Json(Page::whole(leases.dispatch.workers()))
}
