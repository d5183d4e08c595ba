//! `GET /metrics`.

use axum::extract::State;
use axum::http::header;
use axum::response::IntoResponse;

use crate::app::Shared;
use crate::telemetry;

/// What the service counts, in Prometheus' text form.
#[utoipa::path(get, path = "/metrics", tag = "operations",
    responses((status = 200, description = "Metrics named `fathom_…`, in base units.", body = String)))]
pub(crate) async fn metrics(State(app): State<Shared>) -> impl IntoResponse {
    app.dispatch.measure();
    telemetry::stored(&app.store.stats(), app.space.wal_bytes().await);
    (
        [(header::CONTENT_TYPE, "text/plain; version=0.0.4; charset=utf-8")],
        app.telemetry.render(),
    )
}
