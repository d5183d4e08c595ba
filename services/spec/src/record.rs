//! The record of a rendered frame: what was asked, what was done, what came out. It travels from worker to catalogue.

use std::collections::BTreeMap;

use imaging::digest::hex;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use sha2::{Digest, Sha256};

use crate::artifact::{ArtifactKind, is_media_type};
use crate::scene_record::SceneRecord;
use crate::truth::TruthRecord;

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
    /// The plan: per stage its variant, terms, bound, gain and expected cost.
    pub plan: V,
    /// The promised error bound; `None` without a tolerance, and in records of older versions.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub promise: Option<Promise>,
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
    /// What was traced of it by Monte Carlo; only where an artifact asked for it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub truth: Option<TruthRecord>,
    /// With what it was made.
    pub provenance: Provenance,
}

/// The promised error bound of a frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Promise {
    /// The largest error of any sample of the exposed light, from black to white, against the exact chain in f64.
    pub bound: f64,
    /// The tolerance of the frame.
    pub tolerance: f64,
    /// Stages that run without a bound: the promise does not count them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unbounded: Vec<String>,
    /// Why the bound exceeds the tolerance, and what to change; `None` if it does not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub exceeds: Option<String>,
    /// All of it in one sentence.
    pub text: String,
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
