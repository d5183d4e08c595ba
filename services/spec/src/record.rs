//! The record of a rendered frame: what was asked, what was done, what came out. It travels from worker to catalogue.

use std::collections::BTreeMap;

use imaging::digest::hex;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use sha2::{Digest, Sha256};

use crate::artifact::{ArtifactKind, is_media_type};
use crate::scene_record::SceneRecord;
use crate::schema::{Names, Range, Shape};

/// Everything known about one image apart from its bytes.
pub type FrameRecord = RecordOf<Value, Map<String, Value>>;

/// A record whose open parts are kept as values of type `V`, in maps of type `M`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct RecordOf<V, M> {
    /// Position in the job.
    pub frame: u64,
    /// The resolved frame as canonical JSON ([`crate::Frame::parameters`]).
    pub parameters: V,
    /// The numbers the water stage ran with: per-channel coefficients after preset, derivation and range scale, and
    /// which of them were derived; how long the paths through patches were, and how much snow fell. Empty without any of these.
    pub optics: M,
    /// The plan: per stage whether it was skipped, its variant, terms and bound.
    pub plan: V,
    /// Metric values by subject (`rgb`, `hscm`, …) and metric (`uiqm`, `uiqm@table1`, …).
    pub measurements: BTreeMap<String, BTreeMap<String, f64>>,
    /// The stored files.
    pub artifacts: Vec<ArtifactEntry>,
    /// What was counted on the way.
    pub counts: Counts,
    /// Milliseconds per stage. Not part of any digest.
    pub timings_ms: BTreeMap<String, f64>,
    /// What the user should know about this image.
    pub warnings: Vec<String>,
    /// Where the camera was and what could be seen; of uploaded scenes only where an artifact with labels was asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scene: Option<SceneRecord>,
    /// With what it was made.
    pub provenance: Provenance,
}

/// One stored file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct ArtifactEntry {
    /// Artifact kind, such as `rgb`.
    pub kind: String,
    /// SHA-256 of the bytes, lower-case hex.
    pub digest: String,
    /// Length in bytes.
    pub bytes: u64,
    /// Such as `image/png`.
    pub media_type: String,
}

impl ArtifactEntry {
    /// Finds a kind, digest or type that cannot be one.
    ///
    /// # Errors
    /// What is wrong.
    pub fn check(&self) -> Result<(), String> {
        let Self {
            kind,
            digest,
            media_type,
            ..
        } = self;
        let is_digit = |byte: u8| byte.is_ascii_digit() || (b'a'..=b'f').contains(&byte);
        if !ArtifactKind::is_name(kind) {
            return Err(format!("`{kind}` is not an artifact kind"));
        }
        if digest.len() != 64 || !digest.bytes().all(is_digit) {
            return Err(format!(
                "digest `{digest}` of `{kind}` is not 64 lower-case hexadecimal digits"
            ));
        }
        if !is_media_type(media_type) {
            return Err(format!(
                "`{media_type}` of `{kind}` is not a media type such as image/png"
            ));
        }
        Ok(())
    }
}

/// What was counted while rendering.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Counts {
    /// Pixels without a valid range.
    pub holes: u64,
    /// Samples of negative radiance that were set to 0.
    pub negative_radiance: u64,
    /// Samples of the result outside 0..=1 that the encoder clamped.
    pub clamped: u64,
    /// Range pixels beyond what 16-bit millimeters hold.
    pub range_saturated: u64,
}

/// With what an image was made.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Provenance {
    /// Version of the code.
    pub code_version: String,
    /// Version of ONNX Runtime, if a style network ran.
    pub onnx_runtime: Option<String>,
    /// CPU features that choose code paths, such as `avx2,fma`.
    pub cpu_features: String,
    /// SHA-256 of every model and uploaded file that went in, by name.
    pub inputs: BTreeMap<String, String>,
}

/// A result that images can be asked for.
pub(crate) struct ResultField {
    /// Its name in questions.
    pub(crate) name: &'static str,
    /// Where it stands in a record.
    pub(crate) pointer: &'static str,
    pub(crate) shape: Shape,
    pub(crate) unit: Option<&'static str>,
    /// What it means.
    pub(crate) doc: &'static str,
}

/// What came out of a frame, beside its metrics: the numbers that its water ran with, what was met, counted and taken.
pub(crate) const RESULTS: &[ResultField] = &[
    // The water by name: of a preset, or of a water of the user's own, whose numbers the record holds.
    result(
        "water.optics",
        "/parameters/water/optics/preset",
        TEXT,
        "",
        "the water by name",
    ),
    result(
        "absorption_per_m",
        "/optics/absorption_per_m",
        RGB,
        "1/m",
        "a, absorption of the water",
    ),
    result(
        "scattering_per_m",
        "/optics/scattering_per_m",
        RGB,
        "1/m",
        "b, scattering of the water",
    ),
    result(
        "beam_attenuation_per_m",
        "/optics/beam_attenuation_per_m",
        RGB,
        "1/m",
        "c = a + b, attenuation of light along the ray",
    ),
    result(
        "backscatter_attenuation_per_m",
        "/optics/backscatter_attenuation_per_m",
        RGB,
        "1/m",
        "attenuation of the veiling light",
    ),
    result(
        "diffuse_attenuation_per_m",
        "/optics/diffuse_attenuation_per_m",
        RGB,
        "1/m",
        "K_d, decay of daylight with depth",
    ),
    result(
        "veiling_light",
        "/optics/veiling_light",
        RGB,
        "",
        "backscatter radiance at infinite range, linear",
    ),
    result(
        "radiance_gain",
        "/optics/radiance_gain",
        RGB,
        "",
        "what the scene's radiance was multiplied by",
    ),
    result(
        "g_per_m",
        "/optics/g_per_m",
        RGB,
        "1/m",
        "G, attenuation of light that is scattered forward",
    ),
    result(
        "spread_px_per_m",
        "/optics/spread_px_per_m",
        RGB,
        "px/m",
        "growth of the forward-scatter kernel with range",
    ),
    result(
        "spread_offset_px",
        "/optics/spread_offset_px",
        RGB,
        "px",
        "width of the forward-scatter kernel at range 0",
    ),
    result(
        "backscatter_fraction",
        "/optics/backscatter_fraction",
        NUMBER,
        "",
        "share of the scattering that goes back, b_b/b",
    ),
    result(
        "snow.particles",
        "/optics/snow/particles",
        WHOLE,
        "",
        "particles of marine snow in view",
    ),
    result(
        "snow.cover",
        "/optics/snow/cover",
        NUMBER,
        "",
        "share of the picture that marine snow covers",
    ),
    result(
        "turbidity.mean",
        "/optics/turbidity/mean",
        NUMBER,
        "",
        "what multiplies the water's coefficients along the rays, mean over the picture",
    ),
    result(
        "turbidity.least",
        "/optics/turbidity/least",
        NUMBER,
        "",
        "the same, least of all rays",
    ),
    result(
        "turbidity.most",
        "/optics/turbidity/most",
        NUMBER,
        "",
        "the same, greatest of all rays",
    ),
    result(
        "daylight.shallowest_m",
        "/optics/daylight/shallowest_m",
        NUMBER,
        "m",
        "least depth of the surfaces that light from above falls on",
    ),
    result(
        "daylight.deepest_m",
        "/optics/daylight/deepest_m",
        NUMBER,
        "m",
        "the same, greatest depth",
    ),
    result(
        "daylight.caustics_peak",
        "/optics/daylight/caustics_peak",
        NUMBER,
        "",
        "brightest place of the caustics over their mean",
    ),
    result("instances", "/scene/instances", LIST, "", "objects in view"),
    result(
        "instances.visible",
        "/scene/visible",
        WHOLE,
        "",
        "objects whose contrast can be seen",
    ),
    result(
        "instances.least_visibility",
        "/scene/least_visibility",
        NUMBER,
        "",
        "least visibility of an object in view",
    ),
    result(
        "instances.mean_visibility",
        "/scene/mean_visibility",
        NUMBER,
        "",
        "mean visibility of the objects in view",
    ),
    result(
        "holes",
        "/counts/holes",
        WHOLE,
        "",
        "pixels without a valid range",
    ),
    result(
        "negative_radiance",
        "/counts/negative_radiance",
        WHOLE,
        "",
        "samples of negative radiance that were set to 0",
    ),
    result(
        "clamped",
        "/counts/clamped",
        WHOLE,
        "",
        "samples of the result outside 0..=1 that were clamped",
    ),
    result(
        "range_saturated",
        "/counts/range_saturated",
        WHOLE,
        "",
        "pixels whose range is beyond what the range file holds",
    ),
    result("total_ms", "/timings_ms/total", NUMBER, "ms", "time of rendering"),
    result(
        "code_version",
        "/provenance/code_version",
        TEXT,
        "",
        "version of the program that rendered it",
    ),
    result(
        "onnx_runtime",
        "/provenance/onnx_runtime",
        TEXT,
        "",
        "version of ONNX Runtime, if a network ran on it",
    ),
    result(
        "cpu_features",
        "/provenance/cpu_features",
        TEXT,
        "",
        "CPU features that choose code paths",
    ),
];

const NUMBER: Shape = Shape::Number(Range::FINITE);
const WHOLE: Shape = Shape::Integer(0, 1 << 53);
const TEXT: Shape = Shape::Text(Names::Words);
const RGB: Shape = Shape::Rgb(Range::FINITE);
/// Its elements are objects of their own, reached through the record.
const LIST: Shape = Shape::List {
    element: &Shape::Scalar,
    max: usize::MAX,
    distinct: false,
};

const fn result(
    name: &'static str,
    pointer: &'static str,
    shape: Shape,
    unit: &'static str,
    doc: &'static str,
) -> ResultField {
    let unit = if unit.is_empty() { None } else { Some(unit) };
    ResultField {
        name,
        pointer,
        shape,
        unit,
        doc,
    }
}

impl FrameRecord {
    /// SHA-256 over (frame, kind, artifact digest, resolved parameters): the same wherever and however often the
    /// frame is rendered on one build, runtime and CPU feature set. Lower-case hex.
    #[must_use]
    pub fn digest(&self) -> String {
        self.digest_with(&self.parameters.to_string())
    }
}

impl<V, M> RecordOf<V, M> {
    /// The same of parameters that are there as canonical text.
    pub(crate) fn digest_with(&self, parameters: &str) -> String {
        let mut artifacts: Vec<_> = self
            .artifacts
            .iter()
            .map(|a| (a.kind.as_str(), a.digest.as_str()))
            .collect();
        artifacts.sort_unstable();
        let mut hash = Sha256::new();
        hash.update(b"fathom-frame-v1");
        hash.update(self.frame.to_le_bytes());
        for (kind, digest) in artifacts {
            hash.update(kind.as_bytes());
            hash.update([0]);
            hash.update(digest.as_bytes());
            hash.update([0]);
        }
        hash.update(parameters.as_bytes());
        hex(&hash.finalize())
    }
}

/// SHA-256 over the frame digests of a job in frame order, lower-case hex.
#[must_use]
pub fn job_digest<'a>(frame_digests: impl IntoIterator<Item = &'a str>) -> String {
    let mut hash = Sha256::new();
    hash.update(b"fathom-job-v1");
    for digest in frame_digests {
        hash.update(digest.as_bytes());
    }
    hex(&hash.finalize())
}
