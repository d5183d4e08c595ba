//! A scene as shown to clients.

use catalogue::SceneRow;
use client::{SceneSummary, SceneView};
use spec::SceneFiles;

/// The view of a stored scene; `summary` only after an upload.
pub(super) fn view(row: SceneRow, summary: Option<SceneSummary>) -> SceneView {
    let SceneFiles {
        rgb,
        range,
        instances,
        intrinsics,
        classes,
        world_from_camera,
        hfov_deg,
        scale,
    } = row.files;
    SceneView {
        id: row.id,
        width: row.width,
        height: row.height,
        rgb_digest: rgb,
        range_kind: range.as_ref().map(|range| range.kind.name().to_owned()),
        unit_m: range.as_ref().and_then(|range| range.unit_m),
        invalid_code: range.as_ref().and_then(|range| range.invalid_code),
        range_digest: range.map(|range| range.file),
        instances_digest: instances,
        classes,
        world_from_camera,
        focal_px: intrinsics.map(|camera| camera.focal_px),
        cx: intrinsics.map(|camera| camera.cx),
        cy: intrinsics.map(|camera| camera.cy),
        hfov_deg,
        scale,
        summary,
        created_at: row.created_at.to_string(),
    }
}
