//! `GET /v1/worker/scenes/{id}`.

use axum::extract::State;
use proto::wire::SceneResponse;

use crate::app::Shared;
use crate::http::extract::{Path, ProtoBody};
use crate::http::problem::Problem;

/// What a worker needs to load an uploaded scene.
pub(crate) async fn scene(
    State(app): State<Shared>,
    Path(id): Path<String>,
) -> Result<ProtoBody<SceneResponse>, Problem> {
    let row = app
        .catalogue
        .scene(&id)
        .await?
        .ok_or_else(|| Problem::not_found(format!("no scene `{id}`")))?;
    Ok(ProtoBody(row.files.into()))
}
