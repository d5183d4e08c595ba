//! A scene as clients see it.

use catalogue::SceneRow;
use serde::Serialize;
use utoipa::ToSchema;

use crate::http::time::rfc3339;

/// An uploaded scene.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = Scene)]
pub(crate) struct SceneView {
    /// `scn_` and a UUID.
    #[schema(example = "scn_0198c0ffee007000800000000000000a")]
    id: String,
    /// Columns.
    width: u32,
    /// Rows.
    height: u32,
    /// SHA-256 of the picture.
    rgb_digest: String,
    /// SHA-256 of the range file; null: no range, no water.
    range_digest: Option<String>,
    /// `range` (along the line of sight) or `z_depth` (along the optical axis).
    range_kind: Option<String>,
    /// Metres of one unit of the range file.
    unit_m: Option<f64>,
    /// The code that means "no return".
    invalid_code: Option<u16>,
    /// SHA-256 of the instance mask.
    instances_digest: Option<String>,
    /// Focal length in pixels.
    focal_px: Option<f64>,
    /// Column of the principal point in pixels.
    cx: Option<f64>,
    /// Row of the principal point in pixels.
    cy: Option<f64>,
    /// When it was uploaded, RFC 3339 in UTC.
    created_at: String,
}

impl From<SceneRow> for SceneView {
    fn from(row: SceneRow) -> Self {
        Self {
            id: row.id,
            width: row.width,
            height: row.height,
            rgb_digest: row.rgb_digest,
            range_digest: row.range_digest,
            range_kind: row.range_kind,
            unit_m: row.unit_m,
            invalid_code: row.invalid_code,
            instances_digest: row.instances_digest,
            focal_px: row.focal_px,
            cx: row.cx,
            cy: row.cy,
            created_at: rfc3339(row.created_ms),
        }
    }
}
