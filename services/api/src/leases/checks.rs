//! Checks of a worker's report on a frame against the description, the files stored under the same lease, and the
//! worker's registration. A misbehaving worker must not be able to store false facts.

use serde_json::{Number, Value};
use spec::{ArtifactKind, Counts, Frame, FrameRecord, Scene};
use wire::messages::{Artifact, RegisterRequest};

use super::pending::PendingArtifact;

/// Maximum time of a stage, ms: a week.
const MAX_MS: f64 = 7.0 * 86_400e3;
/// Maximum number and length of a frame's warnings: a few sentences.
const WARNINGS: usize = 64;
const WARNING_BYTES: usize = 4096;

/// Returns all faults of a file of a frame.
pub(crate) fn check_file(frame: &Frame, file: &Artifact) -> Vec<String> {
    let Some(kind) = find_requested(frame, &file.kind) else {
        let requested: Vec<String> = frame.artifacts.iter().map(ToString::to_string).collect();
        return vec![format!(
            "`{}` was not requested, but {}",
            file.kind,
            requested.join(", ")
        )];
    };
    let media_type = kind.media_type(frame.encode);
    let mut faults = Vec::new();
    if file.media_type != media_type {
        faults.push(format!("`{kind}` is {media_type}, not {}", file.media_type));
    }
    let is_json = matches!(kind, ArtifactKind::Boxes);
    let is_readable = if is_json {
        serde_json::from_slice::<serde::de::IgnoredAny>(&file.data).is_ok()
    } else {
        imaging::codec::read_sides(&file.data).is_some()
    };
    if !is_readable {
        faults.push(format!("the bytes of `{kind}` are not {media_type}"));
    }
    faults
}

/// A record and the facts to check it against.
pub(crate) struct Evidence<'a> {
    pub(crate) frame: &'a Frame,
    pub(crate) pending: &'a [PendingArtifact],
    pub(crate) worker: &'a RegisterRequest,
    pub(crate) record: &'a FrameRecord,
}

impl Evidence<'_> {
    /// Returns all faults of the record.
    pub(crate) fn faults(&self) -> Vec<String> {
        let checks = [
            self.parameters(),
            self.artifacts(),
            self.sides(),
            self.measurements(),
            self.numbers(),
            self.promise(),
            self.origin(),
        ];
        checks.into_iter().flatten().collect()
    }

    /// The parameters must match the resolved description. A non-procedural scene has its camera in the upload.
    fn parameters(&self) -> Vec<String> {
        let ignored = (!self.is_procedural()).then_some("camera");
        let place = difference(&self.frame.parameters, &self.record.parameters, ignored);
        let fault = place.map(|place| format!("/parameters{place} is not what the description resolves to"));
        fault.into_iter().collect()
    }

    /// The files must match the stored ones, each once, and include all mandatory kinds.
    fn artifacts(&self) -> Vec<String> {
        let named = &self.record.artifacts;
        let mut faults = Vec::new();
        for (position, entry) in named.iter().enumerate() {
            let kind = &entry.kind;
            if named[..position].iter().any(|other| other.kind == *kind) {
                faults.push(format!("`{kind}` is named twice"));
            }
            if !self.pending.iter().any(|put| put.entry == *entry) {
                faults.push(format!(
                    "`{kind}` with the digest {}, {} bytes, {} was not stored under this lease",
                    entry.digest, entry.bytes, entry.media_type
                ));
            }
        }
        for kind in self.frame.artifacts.iter().filter(|kind| !kind.may_be_absent()) {
            let kind = kind.to_string();
            if !named.iter().any(|entry| entry.kind == kind) {
                faults.push(format!("`{kind}` is missing"));
            }
        }
        faults
    }

    /// Every image except the thumbnail must have the frame's size.
    fn sides(&self) -> Vec<String> {
        let Some(size) = self.size() else {
            return vec!["/parameters/camera has no width and height".to_owned()];
        };
        let preview = ArtifactKind::Preview.to_string();
        let pictures = self.pending.iter().filter(|put| put.entry.kind != preview);
        let wrong = pictures.filter_map(|put| Some((&put.entry.kind, put.sides?)));
        let wrong = wrong.filter(|(_, sides)| *sides != size);
        wrong
            .map(|(kind, (width, height)): (&String, (usize, usize))| {
                format!("`{kind}` is {width}×{height}, the frame {}×{}", size.0, size.1)
            })
            .collect()
    }

    /// Only requested metrics of present images are allowed.
    fn measurements(&self) -> Vec<String> {
        let frame = self.frame;
        let mut faults = Vec::new();
        for (subject, values) in &self.record.measurements {
            let is_enhanced = frame
                .enhance
                .iter()
                .any(|enhancement| enhancement.name == *subject);
            if subject != "rgb" && !is_enhanced {
                faults.push(format!("/measurements/{subject}: the frame has no such picture"));
            }
            let others = values.keys().filter(|metric| !frame.metrics.contains(metric));
            faults.extend(others.map(|metric| format!("/measurements/{subject}/{metric} was not requested")));
        }
        faults
    }

    /// Counts, times and warnings must be plausible, so that sums over many frames stay finite.
    fn numbers(&self) -> Vec<String> {
        let Counts {
            holes,
            negative_radiance,
            clamped,
            range_saturated,
        } = self.record.counts;
        let pixels = self
            .size()
            .map_or(0, |(width, height)| width as u64 * height as u64);
        let counts = [
            ("holes", holes, pixels),
            ("negative_radiance", negative_radiance, 3 * pixels),
            ("clamped", clamped, 3 * pixels),
            ("range_saturated", range_saturated, pixels),
        ];
        let beyond = counts.into_iter().filter(|(_, count, most)| count > most);
        let mut faults: Vec<String> = beyond
            .map(|(name, count, most)| format!("/counts/{name} is {count}; must be at most {most}"))
            .collect();
        let times = &self.record.timings_ms;
        if times.len() > wire::limits::TIMINGS || times.values().any(|ms| !(0.0..=MAX_MS).contains(ms)) {
            faults.push(format!(
                "/timings_ms has more than {} stages, or one beyond 0..={MAX_MS}",
                wire::limits::TIMINGS
            ));
        }
        let warnings = &self.record.warnings;
        if warnings.len() > WARNINGS || warnings.iter().any(|warning| warning.len() > WARNING_BYTES) {
            faults.push(format!(
                "/warnings has more than {WARNINGS} texts, or one beyond {WARNING_BYTES} bytes"
            ));
        }
        faults
    }

    /// A promise is a bound and a few short sentences.
    fn promise(&self) -> Vec<String> {
        let mut faults = Vec::new();
        if let Some(promise) = &self.record.promise {
            let sentences = [Some(&promise.text), promise.exceeds.as_ref()];
            let mut texts = sentences.into_iter().flatten().chain(&promise.unbounded);
            if promise.unbounded.len() > WARNINGS || texts.any(|text| text.len() > WARNING_BYTES) {
                faults.push(format!(
                    "/promise names more than {WARNINGS} stages, or has a text beyond {WARNING_BYTES} bytes"
                ));
            }
            if promise.bound < 0.0 || promise.tolerance <= 0.0 {
                faults.push("/promise has a bound below 0 or a tolerance of 0 or less".to_owned());
            }
        }
        faults
    }

    /// The provenance must match the worker's registration.
    fn origin(&self) -> Vec<String> {
        let (made, worker) = (&self.record.provenance, self.worker);
        let runtime = made.onnx_runtime.as_deref();
        let pairs = [
            ("code_version", made.code_version == worker.code_version),
            ("cpu_features", made.cpu_features == worker.cpu_features),
            (
                "onnx_runtime",
                runtime.is_none() || runtime == worker.onnx_runtime.as_deref(),
            ),
        ];
        let wrong = pairs.into_iter().filter(|(_, is_same)| !is_same);
        wrong
            .map(|(name, _)| format!("/provenance/{name} is not that of the worker's registration"))
            .collect()
    }

    fn is_procedural(&self) -> bool {
        matches!(self.frame.scene, Scene::Procedural { .. })
    }

    fn size(&self) -> Option<(usize, usize)> {
        if self.is_procedural() {
            return Some((self.frame.camera.width, self.frame.camera.height));
        }
        let camera = &self.record.parameters["camera"];
        let (width, height) = (camera["width"].as_u64()?, camera["height"].as_u64()?);
        Some((width as usize, height as usize))
    }
}

/// The artifact of this name, if the frame requests it.
fn find_requested<'a>(frame: &'a Frame, name: &str) -> Option<&'a ArtifactKind> {
    frame.artifacts.iter().find(|kind| kind.to_string() == name)
}

/// JSON pointer to the first difference of two values; one key may be ignored.
fn difference(expected: &Value, found: &Value, ignored: Option<&str>) -> Option<String> {
    match (expected, found) {
        (Value::Object(a), Value::Object(b)) => {
            let mut keys = a
                .keys()
                .chain(b.keys())
                .filter(|key| Some(key.as_str()) != ignored);
            keys.find_map(|key| match (a.get(key), b.get(key)) {
                (Some(value), Some(other)) => {
                    difference(value, other, None).map(|rest| format!("/{key}{rest}"))
                }
                _ => Some(format!("/{key}")),
            })
        }
        (Value::Array(a), Value::Array(b)) if a.len() == b.len() => {
            let mut pairs = a.iter().zip(b).enumerate();
            pairs.find_map(|(index, (a, b))| difference(a, b, None).map(|rest| format!("/{index}{rest}")))
        }
        (Value::Number(a), Value::Number(b)) => (!is_same_number(a, b)).then(String::new),
        _ => (expected != found).then(String::new),
    }
}

/// A parser may round a number of a record by its last bit, so the expected number is parsed as well.
fn is_same_number(expected: &Number, found: &Number) -> bool {
    expected == found
        || serde_json::from_str::<Number>(&expected.to_string()).is_ok_and(|parsed| parsed == *found)
}

#[cfg(test)]
pub(super) mod tests;
