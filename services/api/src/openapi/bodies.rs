//! Schemas of JSON responses written by the catalogue or a worker.

use std::collections::BTreeMap;

use serde_json::Value;
use utoipa::ToSchema;

use super::ArtifactKind;

/// Columns of an image by name: strings, numbers, booleans; null if absent. `GET /v1/lists/columns` lists those of
/// every image.
#[derive(ToSchema)]
#[expect(dead_code, reason = "describes the body; the catalogue writes it")]
pub(crate) struct ImageRow {
    /// The job.
    #[schema(nullable = false)]
    job: Option<String>,
    /// The frame.
    #[schema(nullable = false)]
    frame: Option<u64>,
    #[serde(flatten)]
    columns: BTreeMap<String, Value>,
}

/// The record of an image.
#[derive(ToSchema)]
#[expect(dead_code, reason = "describes the body; `spec` writes it")]
pub(crate) struct ImageRecord {
    /// The job.
    job: String,
    /// The dataset.
    dataset: String,
    /// Storage time, RFC 3339 in UTC.
    #[schema(format = DateTime)]
    created_at: String,
    /// Position in the job, from 0.
    frame: u64,
    /// Its description with all distributions drawn.
    parameters: BTreeMap<String, Value>,
    /// Numbers of the water stage.
    optics: BTreeMap<String, Value>,
    /// For each stage its variant, share of the tolerance, bound, gain and cost.
    plan: Value,
    /// The error bound of the exposed light; absent without a tolerance.
    #[schema(nullable = false)]
    promise: Option<PromisedError>,
    /// Metrics by image (`rgb`, an enhancement) and name.
    measurements: BTreeMap<String, BTreeMap<String, f64>>,
    /// The stored files.
    artifacts: Vec<StoredArtifact>,
    /// Counters of the rendering.
    counts: FrameCounts,
    /// Milliseconds of each stage.
    timings_ms: BTreeMap<String, f64>,
    /// Warnings about the image.
    warnings: Vec<String>,
    /// Camera pose and visible objects, if the scene is known.
    #[schema(nullable = false)]
    scene: Option<SceneInView>,
    /// Software and inputs.
    provenance: Provenance,
}

/// The promised error bound of a frame.
#[derive(ToSchema)]
#[expect(dead_code, reason = "describes the body; `spec` writes it")]
pub(crate) struct PromisedError {
    /// The maximum error of any sample of the exposed light, black to white, against the exact chain in f64.
    bound: f64,
    /// The tolerance of the frame.
    tolerance: f64,
    /// Stages without a bound; absent without any.
    #[schema(nullable = false)]
    unbounded: Option<Vec<String>>,
    /// Why the bound exceeds the tolerance, and the remedy; absent if it does not.
    #[schema(nullable = false)]
    exceeds: Option<String>,
    /// The promise as one sentence.
    text: String,
}

/// A stored file.
#[derive(ToSchema)]
#[expect(dead_code, reason = "describes the body; `spec` writes it")]
pub(crate) struct StoredArtifact {
    /// Artifact kind.
    kind: ArtifactKind,
    /// SHA-256 of the bytes, lower-case hex.
    digest: String,
    /// Length in bytes.
    bytes: u64,
    /// Such as `image/png`.
    media_type: String,
}

/// Counters of the rendering.
#[derive(ToSchema)]
#[expect(dead_code, reason = "describes the body; `spec` writes it")]
pub(crate) struct FrameCounts {
    /// Pixels without a valid range.
    holes: u64,
    /// Samples of negative radiance set to 0.
    negative_radiance: u64,
    /// Samples outside 0..=1, clamped by the encoder.
    clamped: u64,
    /// Range pixels beyond the maximum of 16-bit millimeters.
    range_saturated: u64,
}

/// The camera and the objects in view.
#[derive(ToSchema)]
#[expect(dead_code, reason = "describes the body; `spec` writes it")]
pub(crate) struct SceneInView {
    /// Rows of the matrix from camera axes (right, down, ahead, 1) to the world of a procedural scene, m.
    #[schema(nullable = false)]
    world_from_camera: Option<Vec<Vec<f64>>>,
    /// The classes of an uploaded scene; those of procedural scenes are fixed.
    #[schema(nullable = false, value_type = Option<Vec<Value>>)]
    categories: Option<Vec<Value>>,
    /// The pinhole camera.
    intrinsics: CameraIntrinsics,
    /// Objects in view; absent without an artifact that needs labels.
    #[schema(nullable = false)]
    instances: Option<Vec<ObjectInView>>,
    /// Number of objects with visible contrast.
    #[schema(nullable = false)]
    visible: Option<u64>,
    /// Minimum visibility of the objects that have one.
    #[schema(nullable = false)]
    least_visibility: Option<f64>,
    /// Mean visibility.
    #[schema(nullable = false)]
    mean_visibility: Option<f64>,
}

/// A pinhole camera with square pixels, in index coordinates.
#[derive(ToSchema)]
#[expect(dead_code, reason = "describes the body; `spec` writes it")]
pub(crate) struct CameraIntrinsics {
    /// Focal length, px.
    focal_px: f64,
    /// Column of the principal point, px.
    cx: f64,
    /// Row of the principal point, px.
    cy: f64,
}

/// An object in view.
#[derive(ToSchema)]
#[expect(dead_code, reason = "describes the body; `spec` writes it")]
pub(crate) struct ObjectInView {
    /// Number in the instance mask.
    number: u16,
    /// Category; `GET /v1/lists/categories` lists them.
    category: String,
    /// Bounding box of the visible part, px: left, top, and the first column and row beyond.
    #[schema(min_items = 4, max_items = 4)]
    r#box: Vec<u64>,
    /// Visible pixels.
    pixels: u64,
    /// Median range, m.
    range_m: Option<f64>,
    /// Transmittance of the water at that range, R, G, B.
    transmittance: Option<Vec<f64>>,
    /// Contrast against its surround after the water.
    contrast: Option<f64>,
    /// Contrast after the water over contrast before it, at most 1.
    visibility: Option<f64>,
    /// Whether the contrast after the water reaches 0.02.
    visible: bool,
}

/// Software and inputs of an image.
#[derive(ToSchema)]
#[expect(dead_code, reason = "describes the body; `spec` writes it")]
pub(crate) struct Provenance {
    /// Version of the software.
    code_version: String,
    /// Version of ONNX Runtime, if a style network used it.
    onnx_runtime: Option<String>,
    /// CPU features that select code paths.
    cpu_features: String,
    /// SHA-256 of every model and uploaded file used, by name.
    inputs: BTreeMap<String, String>,
}

/// Metadata of a style model.
#[derive(ToSchema)]
#[expect(dead_code, reason = "describes the body; `style` writes it")]
pub(crate) struct StyleCard {
    /// Name of the style in jobs.
    name: String,
    /// Name of the ONNX file.
    file: String,
    /// SHA-256 of the ONNX file, lower-case hex.
    sha256: String,
    /// Kind of network.
    architecture: String,
    /// Number of trained parameters.
    parameters: Option<u64>,
    /// Training data.
    source: String,
    /// License of the model.
    licence: String,
    /// Its inputs.
    inputs: Vec<String>,
    /// Its outputs.
    outputs: Vec<String>,
    /// Whether it has a noise input, seeded by job and frame.
    takes_noise: bool,
    /// Whether it has a range input: it then needs scenes with a range.
    takes_range: bool,
    /// Effect of the style weight on its output.
    alpha: String,
    /// Caveats for users.
    caveats: Vec<String>,
    /// Training record, for a style trained from a photo.
    #[schema(nullable = false)]
    training: Option<TrainingRecord>,
    /// Measured distance of its color table from the network.
    #[schema(nullable = false)]
    table: Option<TableDistance>,
}

/// Training record of a style.
#[derive(ToSchema)]
#[expect(dead_code, reason = "describes the body; `style` writes it")]
pub(crate) struct TrainingRecord {
    /// SHA-256 of each photo's file.
    photos: Vec<String>,
    /// Random seed.
    seed: u64,
    /// Requested steps.
    steps: u64,
    /// The step with the selected weights; 0: only the color transfer.
    kept_step: u64,
    /// Mean losses of the steps leading to it.
    losses: Losses,
    /// Losses on new scenes.
    held_out: Losses,
    /// Losses of the color transfer alone on new scenes.
    #[schema(rename = "held_out_colour_transfer")]
    held_out_color_transfer: Losses,
    /// Contribution of the network beyond its color map on new scenes: root mean square, of 255.
    branch_rms_255: f64,
    /// Version of the trainer.
    code_version: String,
}

/// Parts of a loss; lower is better.
#[derive(ToSchema)]
#[expect(dead_code, reason = "describes the body; the trainer writes it")]
pub(crate) struct Losses {
    /// Distance of the texture from the photo's.
    texture: f64,
    /// Distance of the colors from the photo's.
    #[schema(rename = "colour")]
    color: f64,
    /// Lost share of the content.
    content: f64,
}

/// Distance of the color table from the network on new scenes.
#[derive(ToSchema)]
#[expect(dead_code, reason = "describes the body; `style` writes it")]
pub(crate) struct TableDistance {
    /// Mean absolute difference, of 255.
    mean_255: f64,
    /// 99.9th percentile of the absolute difference, of 255.
    high_255: f64,
    /// Maximum absolute difference, of 255.
    max_255: f64,
    /// Mean structural similarity of the brightness.
    ssim: f64,
    /// Mean color difference ΔE (CIE 1976).
    delta_e: f64,
}
