//! Schemas of JSON responses written by the catalogue or a worker.

use std::collections::BTreeMap;

use serde_json::Value;
use spec::{ArtifactEntry, Counts, Promise, Provenance, SceneRecord};
use style::{InputScale, Layout, ModelRole, SizeRule, TableDistance, TrainingCard};
use utoipa::ToSchema;

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
    promise: Option<Promise>,
    /// Metrics by image (`rgb`, an enhancement) and name.
    measurements: BTreeMap<String, BTreeMap<String, f64>>,
    /// The stored files.
    artifacts: Vec<ArtifactEntry>,
    /// Counters of the rendering.
    counts: Counts,
    /// Milliseconds of each stage.
    timings_ms: BTreeMap<String, f64>,
    /// Warnings about the image.
    warnings: Vec<String>,
    /// Camera pose and visible objects, if the scene is known.
    #[schema(nullable = false)]
    scene: Option<SceneRecord>,
    /// Software and inputs.
    provenance: Provenance,
}

/// Metadata of a style model.
#[derive(ToSchema)]
#[expect(dead_code, reason = "describes the body; `style` writes it")]
pub(crate) struct StyleCard {
    /// Name of the model in jobs.
    name: String,
    /// Its use in jobs.
    role: ModelRole,
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
    /// Enhancers and metrics only: the values of black and white.
    #[schema(nullable = false)]
    input_scale: Option<InputScale>,
    /// Enhancers and metrics only: the order of the axes.
    #[schema(nullable = false)]
    layout: Option<Layout>,
    /// Enhancers and metrics only: the sizes that it takes, `any`, `multiple of N` or `fixed WxH`.
    #[schema(nullable = false, value_type = Option<String>)]
    size: Option<SizeRule>,
    /// Effect of the style weight on its output.
    alpha: String,
    /// Caveats for users.
    caveats: Vec<String>,
    /// Training record, for a style trained from a photo.
    #[schema(nullable = false)]
    training: Option<TrainingCard>,
    /// Measured distance of its color table from the network.
    #[schema(nullable = false)]
    table: Option<TableDistance>,
}
