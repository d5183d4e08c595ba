use axum::http::header;
use axum::response::IntoResponse;
use serde::Serialize;
use utoipa::ToSchema;

use crate::http::{Json, Problem, Slug, State, Topic};
use crate::operations::Operations;
use crate::telemetry;

/// Check whether the process responds.
#[utoipa::path(get, path = "/livez", tag = "operations", operation_id = "get_liveness", security(()),
    responses((status = 200, description = "The process responds.", body = String)))]
pub(crate) async fn livez() -> &'static str {
    "ok\n"
}

/// Check whether requests can be served: the catalogue is readable, there is space, writes work, the service is not
/// stopping, and none of its workers was dismissed.
///
/// A full disk and failed writes are checked again each time; the status is 200 as soon as writes work. With
/// damage found since the start and not restored yet, the status is 200 and the body is `degraded` and one line for each
/// damaged item. Damaged items are not served.
#[utoipa::path(get, path = "/readyz", tag = "operations", operation_id = "get_readiness", security(()),
    responses((status = 200, description = "Ready.", body = String),
              (status = 507, response = crate::openapi::Problem)))]
pub(crate) async fn readyz(State(operations): Topic<Operations>) -> Result<String, Problem> {
    if operations.stop.is_cancelled() {
        return Err(Problem::overloaded("the service is stopping"));
    }
    if operations.bytes.space.is_full().await {
        let detail = "the data folder has no space left; reads still work";
        return Err(Problem::new(Slug::StorageFull, detail));
    }
    if let Some(reason) = operations.bytes.write_failure().await {
        return Err(Problem::new(Slug::StorageFailed, reason));
    }
    let dismissed = operations.leases.dispatch.dismissed_own();
    if !dismissed.is_empty() {
        let detail = format!(
            "dismissed for wrong frames: {}; test this machine's memory, then restart the service",
            dismissed.join(", ")
        );
        return Err(Problem::overloaded(detail));
    }
    operations
        .catalogue
        .job("")
        .await
        .map_err(|error| Problem::overloaded(error.to_string()))?;
    let damage = operations.catalogue.damage();
    let state = if damage.is_empty() {
        "ready\n"
    } else {
        "degraded\n"
    };
    let lines = damage.iter().map(|what| format!("damaged: {what}\n"));
    Ok([state.to_owned()].into_iter().chain(lines).collect())
}

/// Versions of the running software.
#[derive(Serialize, ToSchema)]
pub(crate) struct Version {
    /// Version of the service.
    code_version: &'static str,
    /// Version of the ONNX Runtime available to this machine's workers; null: none, jobs with a style need a worker
    /// that has one.
    onnx_runtime: Option<String>,
}

/// Get the versions of the service and the style runtime.
#[utoipa::path(get, path = "/version", tag = "operations", operation_id = "get_version", security(()),
    responses((status = 200, description = "Versions.", body = Version)))]
pub(crate) async fn version(State(operations): Topic<Operations>) -> Json<Version> {
    Json(Version {
        code_version: env!("CARGO_PKG_VERSION"),
        onnx_runtime: operations.styles.runtime.clone().ok(),
    })
}

/// Get the service's telemetry in Prometheus' text format.
#[utoipa::path(get, path = "/metrics", tag = "operations", operation_id = "get_telemetry",
    responses((status = 200, description = "Metrics named `fathom_…`, in base units.", body = String)))]
pub(crate) async fn metrics(State(operations): Topic<Operations>) -> Result<impl IntoResponse, Problem> {
    operations.leases.dispatch.measure();
    telemetry::stored(&operations.bytes.store.stats(), operations.catalogue.wal_bytes());
    let text = telemetry::render().map_err(|error| Problem::internal(&error))?;
    Ok((
        [(header::CONTENT_TYPE, "text/plain; version=0.0.4; charset=utf-8")],
        text,
    ))
}
