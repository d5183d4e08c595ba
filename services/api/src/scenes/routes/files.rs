//! `GET /v1/worker/scenes/{id}`.

use axum::extract::State;
use proto::message::{Intrinsics, RangeFile, RangeKind, SceneFiles};
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
    let intrinsics = match (row.focal_px, row.cx, row.cy) {
        (Some(focal_px), Some(cx), Some(cy)) => Some(Intrinsics { focal_px, cx, cy }),
        _ => None,
    };
    let kind = match row.range_kind.as_deref() {
        Some("z_depth") => RangeKind::ZDepth,
        _ => RangeKind::Range,
    };
    let (unit_m, invalid_code) = (row.unit_m, row.invalid_code);
    let range = row.range_digest.map(|digest| RangeFile {
        digest,
        kind,
        unit_m,
        invalid_code,
    });
    let (rgb_digest, instances_digest) = (row.rgb_digest, row.instances_digest);
    let files = SceneFiles {
        rgb_digest,
        range,
        intrinsics,
        instances_digest,
    };
    Ok(ProtoBody(files.into()))
}
