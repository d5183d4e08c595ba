//! The record of a rendered frame: parameters, plan, results. Workers send it to the catalogue.

use std::collections::BTreeMap;

use imaging::digest::hex;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value, json};
use sha2::{Digest, Sha256};
use utoipa::ToSchema;

use crate::artifact::ArtifactKind;
use crate::scene_record::SceneRecord;
use crate::truth::TruthRecord;

/// All data about one image except its bytes.
pub type FrameRecord = RecordOf<Value, Map<String, Value>>;

/// A record whose open parts have values of type `V` and maps of type `M`.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct RecordOf<V, M> {
    /// Position in the job.
    pub frame: u64,
    /// The resolved frame as canonical JSON ([`crate::Frame::parameters`]).
    pub parameters: V,
    /// Numbers of the water stage: per-channel coefficients after preset, derivation and range scale, and the derived
    /// ones; path lengths through turbidity patches; particles of snow. May be empty.
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
    /// Counters of the rendering.
    pub counts: Counts,
    /// Milliseconds per stage. Not part of any digest.
    pub timings_ms: BTreeMap<String, f64>,
    /// Warnings about this image.
    pub warnings: Vec<String>,
    /// Camera pose and visible objects. For uploaded scenes only with an artifact that needs labels.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scene: Option<SceneRecord>,
    /// The Monte Carlo result; only with an artifact that needs it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub truth: Option<TruthRecord>,
    /// Software and inputs.
    pub provenance: Provenance,
}

/// The promised error bound of a frame.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = PromisedError)]
pub struct Promise {
    /// The maximum error of any sample of the exposed light, black to white, against the exact chain in f64, without its relative part.
    pub bound: f64,
    /// The relative part of the error, as a share of the sample; 0 if the tolerance has none.
    #[serde(default)]
    pub relative: f64,
    /// The tolerance of the frame.
    pub tolerance: f64,
    /// The relative part of the tolerance, as a share of the sample.
    #[serde(default)]
    pub relative_tolerance: f64,
    /// Stages without a bound; absent without any.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unbounded: Vec<String>,
    /// Why the bound exceeds the tolerance, and the remedy; absent if it does not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schema(nullable = false)]
    pub exceeds: Option<String>,
    /// The promise as one sentence.
    pub text: String,
}

/// A stored file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[schema(as = StoredArtifact)]
pub struct ArtifactEntry {
    /// Artifact kind.
    #[schema(value_type = ArtifactKind)]
    pub kind: String,
    /// SHA-256 of the bytes, lower-case hex.
    pub digest: String,
    /// Length in bytes.
    pub bytes: u64,
    /// Such as `image/png`.
    pub media_type: String,
}

impl ArtifactEntry {
    /// Checks kind, digest and media type.
    ///
    /// # Errors
    /// The first invalid one.
    pub fn check(&self) -> Result<(), String> {
        let Self {
            kind,
            digest,
            media_type,
            ..
        } = self;
        if !ArtifactKind::is_name(kind) {
            return Err(format!("`{kind}` is not an artifact kind"));
        }
        if digest.len() != 64
            || !digest
                .bytes()
                .all(|byte: u8| byte.is_ascii_digit() || (b'a'..=b'f').contains(&byte))
        {
            return Err(format!(
                "digest `{digest}` of `{kind}` is not 64 lower-case hexadecimal digits"
            ));
        }
        if !ArtifactKind::MEDIA_TYPES.contains(&media_type.as_str()) {
            return Err(format!(
                "`{media_type}` of `{kind}` must be one of {}",
                ArtifactKind::MEDIA_TYPES.join(", ")
            ));
        }
        Ok(())
    }
}

/// Counters of the rendering.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[schema(as = FrameCounts)]
pub struct Counts {
    /// Pixels without a valid range.
    pub holes: u64,
    /// Samples of negative radiance set to 0.
    pub negative_radiance: u64,
    /// Samples outside 0..=1 of the style's network and of the developed picture, which were clamped.
    pub clamped: u64,
    /// Range pixels beyond the maximum of 16-bit millimeters.
    pub range_saturated: u64,
}

/// Software and inputs of an image.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
pub struct Provenance {
    /// Version of the software.
    pub code_version: String,
    /// Version of ONNX Runtime, if a style network used it.
    pub onnx_runtime: Option<String>,
    /// CPU features that select code paths.
    pub cpu_features: String,
    /// SHA-256 of every model and uploaded file used, by name.
    pub inputs: BTreeMap<String, String>,
}

impl Provenance {
    /// Each member that differs from that of another rendering, such as `code_version was "1" and is "2"`.
    #[must_use]
    pub fn describe_changes(&self, now: &Self) -> Vec<String> {
        let (then, now) = (json!(self), json!(now));
        let names = ["code_version", "onnx_runtime", "cpu_features", "inputs"];
        let changed = names.into_iter().filter(|name| then[name] != now[name]);
        changed
            .map(|name| format!("{name} was {} and is {}", then[name], now[name]))
            .collect()
    }
}

impl FrameRecord {
    /// SHA-256 over (frame, kind, artifact digest, resolved parameters), lower-case hex. It is reproducible for one
    /// build, runtime and CPU feature set.
    #[must_use]
    pub fn digest(&self) -> String {
        self.digest_with(&self.parameters.to_string())
    }
}

impl<V, M> RecordOf<V, M> {
    /// The digest for parameters in canonical text.
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
