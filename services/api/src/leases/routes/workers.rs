//! `GET /v1/workers`.

use axum::Json;
use axum::extract::State;
use serde::Serialize;
use utoipa::ToSchema;

use crate::app::Shared;
use crate::http::paging::Page;

/// A worker process.
#[derive(Debug, Serialize, ToSchema)]
pub(crate) struct Worker {
    /// `wrk_…`, new with every registration.
    pub(crate) id: String,
    /// The name it gave itself; the service's own are `local-1`, `local-2`, …
    pub(crate) name: String,
    /// Frames that it renders side by side.
    pub(crate) slots: u32,
    /// Frames that it holds.
    pub(crate) leased_frames: u64,
    /// Milliseconds since it was last heard of.
    pub(crate) silent_ms: u64,
    /// Version of its code.
    pub(crate) code_version: String,
    /// Version of its ONNX Runtime; null: none.
    pub(crate) onnx_runtime: Option<String>,
    /// CPU features that choose its code paths.
    pub(crate) cpu_features: String,
}

/// List the workers that are registered, all on one page.
#[utoipa::path(get, path = "/v1/workers", tag = "operations",
    responses((status = 200, description = "All workers.", body = Page<Worker>)))]
pub(crate) async fn list(State(app): State<Shared>) -> Json<Page<Worker>> {
    Json(Page {
        items: app.dispatch.workers(),
        next_cursor: None,
    })
}
