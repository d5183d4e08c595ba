//! Checks of a worker's report on a frame against the description, the files stored under the same lease, and the
//! worker's registration. A misbehaving worker must not be able to store false facts.

mod measured;
mod structure;

use serde_json::{Value, json};
use spec::{
    Agreement, ArtifactKind, Counts, Frame, FrameRecord, METRIC_NETWORK, Scene, Step, compare_values,
    find_unknown_members,
};
use wire::messages::{Artifact, RegisterRequest};

use super::pending::PendingArtifact;

/// Maximum time of a stage, ms: a week.
const MAX_MS: f64 = 7.0 * 86_400e3;
/// Maximum number and length of a frame's warnings: a few sentences.
const WARNINGS: usize = 64;
const WARNING_BYTES: usize = 4096;
/// Maximum stages of a plan: there are about 30.
const MAX_STAGES: usize = 64;
/// Maximum members of a stage, and bytes of its text.
const MAX_STAGE_MEMBERS: usize = 32;
const MAX_STAGE_BYTES: usize = 16_384;
/// Pointer to the camera of a frame.
const CAMERA: &str = "/parameters/camera";
/// Maximum faults of one kind in a rejection.
const MAX_FAULTS: usize = 20;

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
    let wrong = structure::find_fault(frame, kind, &file.data);
    faults.extend(
        wrong.map(|wrong| format!("the bytes of `{kind}` are not {media_type} as workers write it: {wrong}")),
    );
    faults
}

/// A record and the facts to check it against.
pub(crate) struct Evidence<'a> {
    pub(crate) frame: &'a Frame,
    pub(crate) pending: &'a [PendingArtifact],
    pub(crate) worker: &'a RegisterRequest,
    pub(crate) record: &'a FrameRecord,
    /// The record as it was received; `None` for a worker of the service.
    pub(crate) received: Option<&'a Value>,
}

impl Evidence<'_> {
    /// Returns all faults of the record.
    pub(crate) fn faults(&self) -> Vec<String> {
        let checks = [
            self.parameters(),
            self.artifacts(),
            self.sides(),
            measured::find_faults(self.frame, self.record),
            self.plan(),
            self.unknown(),
            self.numbers(),
            self.promise(),
            self.origin(),
        ];
        checks.into_iter().flatten().collect()
    }

    /// The parameters must match the resolved description. A non-procedural scene has its camera in the upload.
    fn parameters(&self) -> Vec<String> {
        let found = &self.record.parameters;
        let differences = compare_values("/parameters", &self.frame.parameters, found, Agreement::Exact);
        let is_ignored = !self.is_procedural();
        let wrong = differences
            .into_iter()
            .map(|difference| difference.pointer)
            .filter(|pointer: &String| !(is_ignored && is_of_camera(pointer)));
        wrong
            .take(MAX_FAULTS)
            .map(|pointer| format!("{pointer} is not what the description resolves to"))
            .collect()
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

    /// A plan is a list of stages, each a small object.
    fn plan(&self) -> Vec<String> {
        let mut faults = Vec::new();
        let Some(stages) = self.record.plan.as_array() else {
            return vec!["/plan is not a list of stages".to_owned()];
        };
        if stages.len() > MAX_STAGES {
            faults.push(format!(
                "/plan has {} stages; must be at most {MAX_STAGES}",
                stages.len()
            ));
        }
        let members = stages.iter().take(MAX_STAGES).enumerate();
        let wrong = members.filter(|(_, stage)| {
            let is_small = stage
                .as_object()
                .is_some_and(|stage| stage.len() <= MAX_STAGE_MEMBERS);
            !is_small || stage.to_string().len() > MAX_STAGE_BYTES
        });
        faults.extend(wrong.map(|(place, _)| {
            format!(
                "/plan/{place} is not an object of at most {MAX_STAGE_MEMBERS} members and {MAX_STAGE_BYTES} bytes"
            )
        }));
        let optics = json!(self.record.optics).to_string().len();
        if optics > MAX_STAGE_BYTES {
            faults.push(format!(
                "/optics has {optics} bytes; must be at most {MAX_STAGE_BYTES}"
            ));
        }
        faults.truncate(MAX_FAULTS);
        faults
    }

    /// A record has only the members that this version declares.
    fn unknown(&self) -> Vec<String> {
        let received = self.received.into_iter();
        let unknown = received.flat_map(|text| find_unknown_members(text, self.record));
        unknown
            .take(MAX_FAULTS)
            .map(|pointer| format!("{pointer} is unknown"))
            .collect()
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
            let least = promise
                .bound
                .min(promise.relative)
                .min(promise.relative_tolerance);
            if least < 0.0 || promise.tolerance <= 0.0 {
                faults.push("/promise has a bound below 0 or a tolerance of 0 or less".to_owned());
            }
        }
        faults
    }

    /// The provenance must match the worker's registration.
    fn origin(&self) -> Vec<String> {
        let (made, worker) = (&self.record.provenance, self.worker);
        let mut faults = Vec::new();
        for (name, is_same) in [
            ("code_version", made.code_version == worker.code_version),
            ("cpu_features", made.cpu_features == worker.cpu_features),
        ] {
            if !is_same {
                faults.push(format!(
                    "/provenance/{name} is not that of the worker's registration"
                ));
            }
        }
        match &made.onnx_runtime {
            Some(runtime) if !self.has_network() => faults.push(format!(
                "/provenance/onnx_runtime is `{runtime}`; must be null, because the frame has no style and no network"
            )),
            Some(_) if made.onnx_runtime != worker.onnx_runtime => {
                faults.push("/provenance/onnx_runtime is not that of the worker's registration".to_owned());
            }
            _ => {}
        }
        faults
    }

    /// Whether a stage of the frame can need ONNX Runtime.
    fn has_network(&self) -> bool {
        let mut steps = self
            .frame
            .enhance
            .iter()
            .flat_map(|enhancement| &enhancement.steps);
        (self.frame.water.style.is_some() && self.frame.alpha > 0.0)
            || steps.any(|step| matches!(step, Step::Onnx(_)))
            || self
                .frame
                .metrics
                .iter()
                .any(|metric| metric.starts_with(METRIC_NETWORK))
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

fn is_of_camera(pointer: &str) -> bool {
    let rest = pointer.strip_prefix(CAMERA);
    rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
}

/// The artifact of this name, if the frame requests it.
pub(crate) fn find_requested<'a>(frame: &'a Frame, name: &str) -> Option<&'a ArtifactKind> {
    frame.artifacts.iter().find(|kind| kind.to_string() == name)
}

#[cfg(test)]
pub(super) mod tests;
