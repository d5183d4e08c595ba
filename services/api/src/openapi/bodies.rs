//! Responses that the catalogue or a worker wrote as JSON: what stands in them.

use std::collections::BTreeMap;

use serde_json::Value;
use utoipa::ToSchema;

use super::ArtifactKind;

/// Columns of an image by name: strings, numbers, booleans; null where it has none. `GET /v1/lists/columns` lists those of
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

/// Everything that is known of an image.
#[derive(ToSchema)]
#[expect(dead_code, reason = "describes the body; `spec` writes it")]
pub(crate) struct ImageRecord {
    /// The job.
    job: String,
    /// The dataset.
    dataset: String,
    /// When it was stored, RFC 3339 in UTC.
    #[schema(format = DateTime)]
    created_at: String,
    /// Position in the job, from 0.
    frame: u64,
    /// Its description with every law replaced by its value.
    parameters: BTreeMap<String, Value>,
    /// The numbers that the water ran with.
    optics: BTreeMap<String, Value>,
    /// For each stage its variant, share of the tolerance, bound, gain and cost.
    plan: Value,
    /// The error bound of the exposed light; missing without a tolerance.
    #[schema(nullable = false)]
    promise: Option<PromisedError>,
    /// Metrics by picture (`rgb`, an enhancement) and name.
    measurements: BTreeMap<String, BTreeMap<String, f64>>,
    /// The stored files.
    artifacts: Vec<StoredArtifact>,
    /// What was counted on the way.
    counts: FrameCounts,
    /// Milliseconds of each stage.
    timings_ms: BTreeMap<String, f64>,
    /// What the user should know about it.
    warnings: Vec<String>,
    /// Where the camera was and what could be seen, where the scene is known.
    #[schema(nullable = false)]
    scene: Option<SceneInView>,
    /// With what it was made.
    provenance: Provenance,
}

/// The promised error bound of a frame.
#[derive(ToSchema)]
#[expect(dead_code, reason = "describes the body; `spec` writes it")]
pub(crate) struct PromisedError {
    /// The largest error of any sample of the exposed light, from black to white, against the exact chain in f64.
    bound: f64,
    /// The tolerance of the frame.
    tolerance: f64,
    /// Stages that run without a bound; missing without any.
    #[schema(nullable = false)]
    unbounded: Option<Vec<String>>,
    /// Why the bound exceeds the tolerance, and what to change; missing if it does not.
    #[schema(nullable = false)]
    exceeds: Option<String>,
    /// All of it in one sentence.
    text: String,
}

/// A stored file.
#[derive(ToSchema)]
#[expect(dead_code, reason = "describes the body; `spec` writes it")]
pub(crate) struct StoredArtifact {
    /// What it holds.
    kind: ArtifactKind,
    /// SHA-256 of the bytes, lower-case hex.
    digest: String,
    /// Length in bytes.
    bytes: u64,
    /// Such as `image/png`.
    media_type: String,
}

/// What was counted while rendering.
#[derive(ToSchema)]
#[expect(dead_code, reason = "describes the body; `spec` writes it")]
pub(crate) struct FrameCounts {
    /// Pixels without a valid range.
    holes: u64,
    /// Samples of negative radiance that were set to 0.
    negative_radiance: u64,
    /// Samples outside 0..=1 that the encoder clamped.
    clamped: u64,
    /// Range pixels beyond what 16-bit millimeters hold.
    range_saturated: u64,
}

/// The camera and the objects in view.
#[derive(ToSchema)]
#[expect(dead_code, reason = "describes the body; `spec` writes it")]
pub(crate) struct SceneInView {
    /// Rows of the matrix that takes camera axes (right, down, ahead, 1) to the world of a procedural scene, m.
    #[schema(nullable = false)]
    world_from_camera: Option<Vec<Vec<f64>>>,
    /// The classes of an uploaded scene; those of procedural scenes are always the same.
    #[schema(nullable = false, value_type = Option<Vec<Value>>)]
    categories: Option<Vec<Value>>,
    /// The pinhole camera.
    intrinsics: CameraIntrinsics,
    /// The objects in view; absent unless an artifact with labels was asked for.
    #[schema(nullable = false)]
    instances: Option<Vec<ObjectInView>>,
    /// How many of them have a contrast that can be seen.
    #[schema(nullable = false)]
    visible: Option<u64>,
    /// The least visibility of those that have one.
    #[schema(nullable = false)]
    least_visibility: Option<f64>,
    /// Their mean visibility.
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
    /// Its number in the instance mask.
    number: u16,
    /// What it is; `GET /v1/lists/categories` lists them.
    category: String,
    /// What is seen of it, px: left, top, and the first column and row beyond.
    #[schema(min_items = 4, max_items = 4)]
    r#box: Vec<u64>,
    /// How many pixels show it.
    pixels: u64,
    /// Its median range, m.
    range_m: Option<f64>,
    /// Transmittance of the water at that range, R, G, B.
    transmittance: Option<Vec<f64>>,
    /// Its contrast against its surround after the water.
    contrast: Option<f64>,
    /// That contrast over the one before the water, at most 1.
    visibility: Option<f64>,
    /// Whether the contrast after the water reaches 0.02.
    visible: bool,
}

/// With what an image was made.
#[derive(ToSchema)]
#[expect(dead_code, reason = "describes the body; `spec` writes it")]
pub(crate) struct Provenance {
    /// Version of the code.
    code_version: String,
    /// Version of ONNX Runtime, if a style network ran on it.
    onnx_runtime: Option<String>,
    /// CPU features that choose code paths.
    cpu_features: String,
    /// SHA-256 of every model and uploaded file that went in, by name.
    inputs: BTreeMap<String, String>,
}

/// What is known of a style model.
#[derive(ToSchema)]
#[expect(dead_code, reason = "describes the body; `style` writes it")]
pub(crate) struct StyleCard {
    /// Name by which jobs ask for it.
    name: String,
    /// Name of the ONNX file.
    file: String,
    /// SHA-256 of the ONNX file, lower-case hex.
    sha256: String,
    /// What kind of network it is.
    architecture: String,
    /// How many numbers were trained.
    parameters: Option<u64>,
    /// What it was trained on.
    source: String,
    /// Under what terms it may be used.
    licence: String,
    /// Its inputs.
    inputs: Vec<String>,
    /// Its outputs.
    outputs: Vec<String>,
    /// Whether it takes noise of the job's seed and the frame.
    takes_noise: bool,
    /// Whether it takes the range of each pixel: it cannot repaint a scene without one.
    takes_range: bool,
    /// What the style weight does with its output.
    alpha: String,
    /// What a user should know.
    caveats: Vec<String>,
    /// How it was trained, if it was trained from a photo.
    #[schema(nullable = false)]
    training: Option<TrainingRecord>,
    /// How far its color table is from the network, if that was measured.
    #[schema(nullable = false)]
    table: Option<TableDistance>,
}

/// How a style came about.
#[derive(ToSchema)]
#[expect(dead_code, reason = "describes the body; `style` writes it")]
pub(crate) struct TrainingRecord {
    /// SHA-256 of each photo's file.
    photos: Vec<String>,
    /// Seed of all chance.
    seed: u64,
    /// Steps asked for.
    steps: u64,
    /// The step whose weights were kept; 0: the color transfer alone.
    kept_step: u64,
    /// Mean losses of the steps that led to it.
    losses: Losses,
    /// Losses on new scenes.
    held_out: Losses,
    /// The same for the color transfer alone.
    #[schema(rename = "held_out_colour_transfer")]
    held_out_color_transfer: Losses,
    /// What the network does beyond its color map on new scenes: root mean square, of 255.
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
    /// Share of the content that is lost.
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
    /// Greatest absolute difference, of 255.
    max_255: f64,
    /// Mean structural similarity of the brightness.
    ssim: f64,
    /// Mean color difference ΔE (CIE 1976).
    delta_e: f64,
}
