//! `GET /v1/worker/scenes/{id}`.

use std::sync::Arc;

use axum::extract::State;
use catalogue::Catalogue;
use proto::wire::SceneResponse;

use crate::http::extract::{Path, ProtoBody};
use crate::http::problem::{Problem, found};

/// What a worker needs to load an uploaded scene.
pub(crate) async fn scene(
    State(catalogue): State<Arc<Catalogue>>,
    Path(id): Path<String>,
) -> Result<ProtoBody<SceneResponse>, Problem> {
    let row = found(catalogue.scene(&id).await?, "scene", &id)?;
    Ok(ProtoBody(row.files.into()))
}
