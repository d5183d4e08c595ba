//! Uploaded scenes and collections of them.

use serde::{Deserialize, Serialize};
use spec::Classes;
use utoipa::ToSchema;

/// An uploaded scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = Scene)]
pub struct SceneView {
    /// `scn_` and a UUID.
    #[schema(example = "scn_0198c0ffee007000800000000000000a")]
    pub id: String,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// SHA-256 of the picture.
    pub rgb_digest: String,
    /// SHA-256 of the range file; null: no range, and no job with water over this scene.
    pub range_digest: Option<String>,
    /// `range` (along the line of sight) or `z_depth` (along the optical axis).
    pub range_kind: Option<String>,
    /// Meters of one unit of the range file.
    pub unit_m: Option<f64>,
    /// The code that means "no return".
    pub invalid_code: Option<u16>,
    /// SHA-256 of the instance mask.
    pub instances_digest: Option<String>,
    /// What its objects are: `categories` with `id` and `name`, and `segments_info` with the class of each object by its
    /// number in the mask.
    #[schema(value_type = Option<Object>)]
    pub classes: Option<Classes>,
    /// Where the camera was: the rows of the matrix from camera axes (right, down, ahead) to the world, in meters.
    #[schema(value_type = Option<Vec<Vec<f64>>>)]
    pub world_from_camera: Option<[[f64; 4]; 4]>,
    /// Focal length in pixels.
    pub focal_px: Option<f64>,
    /// Column of the principal point in pixels.
    pub cx: Option<f64>,
    /// Row of the principal point in pixels.
    pub cy: Option<f64>,
    /// Horizontal field of view in degrees, if it was given instead of the focal length.
    #[serde(default)]
    pub hfov_deg: Option<f64>,
    /// Factor from the floats of the picture to linear light.
    #[serde(default)]
    pub scale: Option<f64>,
    /// Content of the files; only in the response to an upload.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub summary: Option<SceneSummary>,
    /// When it was uploaded, RFC 3339 in UTC.
    #[schema(format = DateTime)]
    pub created_at: String,
}

/// The content of uploaded files.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct SceneSummary {
    /// Share of pixels with a distance; null without a range.
    pub valid_share: Option<f64>,
    /// Nearest distance along the line of sight, m.
    pub nearest_m: Option<f64>,
    /// Farthest distance, m.
    pub farthest_m: Option<f64>,
    /// Pixels of each class in the mask, the most first; objects without a class are `unlabeled`.
    pub classes: Vec<ClassPixels>,
    /// Objects in the mask; null without one.
    pub objects: Option<usize>,
    /// How a file was read where that is not obvious, such as an orientation tag.
    pub notes: Vec<String>,
}

/// Pixels of a class.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct ClassPixels {
    /// Its name.
    #[schema(example = "pile")]
    pub name: String,
    /// Pixels of all its objects.
    pub pixels: u64,
}

/// A collection of uploaded scenes.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[schema(as = Collection)]
pub struct CollectionRow {
    /// Its name.
    #[schema(example = "dock")]
    pub name: String,
    /// How many scenes it has.
    pub scenes: u64,
}

/// A scene in a collection.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[schema(as = CollectionScene)]
pub struct CollectionScene {
    /// Its name in the collection, which is its place in the order.
    #[schema(example = "frame-0001")]
    pub name: String,
    /// The scene.
    #[schema(example = "scn_0198c0ffee007000800000000000000a")]
    pub id: String,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// `range`, `z_depth`, or null without a range: no job with water over this scene.
    pub range_kind: Option<String>,
    /// Whether it has an instance mask.
    pub instances: bool,
}
