//! `POST /v1/scenes`.

use client::SceneView;
use utoipa::ToSchema;

use crate::http::located::{Located, created, located};
use crate::http::{MultipartBody, Problem, State, Topic};
use crate::scenes::Scenes;
use crate::scenes::upload::SceneForm;
use crate::scenes::view::view;

/// The fields of a scene upload.
#[derive(ToSchema)]
#[expect(dead_code, reason = "describes the body; `SceneForm` reads it")]
pub(crate) struct SceneUpload {
    /// The image: PNG, JPEG, WebP, BMP, TIFF, or NPY `[h, w, 3]`. Integers are sRGB codes; floats, as of EXR, are linear
    /// light. The orientation tag is applied.
    #[schema(value_type = String, format = Binary)]
    rgb: Vec<u8>,
    /// Distances along the line of sight: gray PNG, BMP or TIFF, NPY `[h, w]`, or EXR with one channel or Z.
    #[schema(value_type = Option<String>, format = Binary)]
    range: Option<Vec<u8>>,
    /// Distances along the optical axis, as from depth cameras; requires the camera.
    #[schema(value_type = Option<String>, format = Binary)]
    z_depth: Option<Vec<u8>>,
    /// Meters per unit of the file. Required for integer files, and for floats with a median above 100.
    unit_m: Option<f64>,
    /// The code of a missing return. Required for integer files.
    invalid_code: Option<u16>,
    /// Focal length in pixels; `fx` is an alias.
    focal_px: Option<f64>,
    /// Column of the principal point; absent: the center.
    cx: Option<f64>,
    /// Row of the principal point; absent: the center.
    cy: Option<f64>,
    /// Horizontal field of view, instead of the focal length.
    hfov_deg: Option<f64>,
    /// Factor from the floats of the image to linear light, where 1 is white. Required for floats above 10.
    scale: Option<f64>,
    /// Instance of each pixel, 0 = background: whole numbers of 0 to 65535 in a gray or palette picture or an array.
    #[schema(value_type = Option<String>, format = Binary)]
    instances: Option<Vec<u8>>,
    /// Classes of the instances as JSON: `{"1": "pile", "2": "chain"}` or, with your ids, `categories` and
    /// `segments_info` as in COCO's panoptic annotations.
    #[schema(value_type = Option<String>, format = Binary)]
    classes: Option<Vec<u8>>,
    /// Camera pose as JSON: `{"world_from_camera": [[…], […], […], [0, 0, 0, 1]]}`, the rows of the matrix from
    /// camera axes (right, down, ahead) to the world, whose z axis points up, in meters.
    #[schema(value_type = Option<String>, format = Binary)]
    pose: Option<Vec<u8>>,
    /// The collection to add the scene to, such as `dock`; jobs may then use the collection.
    collection: Option<String>,
    /// Its name in the collection, which decides the order; absent: its id. An existing name is replaced.
    name: Option<String>,
}

/// Upload a scene.
///
/// It is decoded and checked before anything is stored. Scenes are identified by their content: repeating an upload
/// returns the same scene with 200.
#[utoipa::path(post, path = "/v1/scenes", tag = "scenes", operation_id = "upload_scene",
    request_body(content = SceneUpload, content_type = "multipart/form-data"),
    responses((status = 201, description = "Stored.", body = SceneView),
              (status = 200, description = "Already stored.", body = SceneView)))]
pub(crate) async fn create(
    State(scenes): Topic<Scenes>,
    MultipartBody(body): MultipartBody,
) -> Result<Located<SceneView>, Problem> {
    let kept = scenes.keep(SceneForm::read(body).await?).await?;
    let location = format!("/v1/scenes/{}", kept.row.id);
    let view = view(kept.row, Some(kept.summary));
    Ok(located(created(kept.is_new), location, view))
}
