//! A scene as shown to clients.

use catalogue::SceneRow;
use serde::Serialize;
use spec::{Classes, SceneFiles};
use utoipa::ToSchema;

/// An uploaded scene.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = Scene)]
pub(crate) struct SceneView {
    /// `scn_` and a UUID.
    #[schema(example = "scn_0198c0ffee007000800000000000000a")]
    id: String,
    /// Image columns.
    width: u32,
    /// Image rows.
    height: u32,
    /// SHA-256 of the image.
    rgb_digest: String,
    /// SHA-256 of the range file; null: no range, and no job with water over this scene.
    range_digest: Option<String>,
    /// `range` (along the line of sight) or `z_depth` (along the optical axis).
    range_kind: Option<&'static str>,
    /// Meters per unit of the range file.
    unit_m: Option<f64>,
    /// The code of a missing return.
    invalid_code: Option<u16>,
    /// SHA-256 of the instance mask.
    instances_digest: Option<String>,
    /// Classes of its objects: `categories` with `id` and `name`, and `segments_info` with the class of each object
    /// by its number in the mask.
    #[schema(value_type = Option<Object>)]
    classes: Option<Classes>,
    /// Camera pose: rows of the matrix from camera axes (right, down, ahead) to the world, in meters.
    #[schema(value_type = Option<Vec<Vec<f64>>>)]
    world_from_camera: Option<[[f64; 4]; 4]>,
    /// Focal length in pixels.
    focal_px: Option<f64>,
    /// Column of the principal point in pixels.
    cx: Option<f64>,
    /// Row of the principal point in pixels.
    cy: Option<f64>,
    /// Upload time, RFC 3339 in UTC.
    #[schema(format = DateTime)]
    created_at: String,
}

impl From<SceneRow> for SceneView {
    fn from(row: SceneRow) -> Self {
        let SceneFiles {
            rgb,
            range,
            instances,
            intrinsics,
            classes,
            world_from_camera,
        } = row.files;
        Self {
            id: row.id,
            width: row.width,
            height: row.height,
            rgb_digest: rgb,
            range_kind: range.as_ref().map(|range| range.kind.name()),
            unit_m: range.as_ref().and_then(|range| range.unit_m),
            invalid_code: range.as_ref().and_then(|range| range.invalid_code),
            range_digest: range.map(|range| range.file),
            instances_digest: instances,
            classes,
            world_from_camera,
            focal_px: intrinsics.map(|camera| camera.focal_px),
            cx: intrinsics.map(|camera| camera.cx),
            cy: intrinsics.map(|camera| camera.cy),
            created_at: row.created_at.to_string(),
        }
    }
}
