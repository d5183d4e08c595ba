//! `GET /version`.

use std::sync::Arc;

use axum::Json;
use axum::extract::State;
use serde::Serialize;
use utoipa::ToSchema;

use crate::operations::Operations;

/// What runs here.
#[derive(Serialize, ToSchema)]
pub(crate) struct Version {
    /// Version of the code.
    code_version: &'static str,
    /// Version of the ONNX Runtime that this machine's workers find; null: none, jobs with a style need a worker
    /// that has one.
    onnx_runtime: Option<String>,
}

/// Versions of the code and of the style runtime.
#[utoipa::path(get, path = "/version", tag = "operations", security(()),
    responses((status = 200, description = "Versions.", body = Version)))]
pub(crate) async fn version(State(operations): State<Arc<Operations>>) -> Json<Version> {
    Json(Version {
        code_version: env!("CARGO_PKG_VERSION"),
        onnx_runtime: operations.styles.runtime.clone().ok(),
    })
}
