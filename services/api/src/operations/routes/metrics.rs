//! `GET /metrics`.

use std::sync::Arc;

use axum::extract::State;
use axum::http::header;
use axum::response::IntoResponse;

use crate::operations::Operations;
use crate::telemetry;

/// What the service counts, in Prometheus' text form.
#[utoipa::path(get, path = "/metrics", tag = "operations",
    responses((status = 200, description = "Metrics named `fathom_…`, in base units.", body = String)))]
pub(crate) async fn metrics(State(operations): State<Arc<Operations>>) -> impl IntoResponse {
    operations.leases.dispatch.measure();
    telemetry::stored(&operations.bytes.store.stats(), operations.catalogue.wal_bytes());
    (
        [(header::CONTENT_TYPE, "text/plain; version=0.0.4; charset=utf-8")],
        operations.telemetry.render(),
    )
}
