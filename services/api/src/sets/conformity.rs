//! Checks imported records as a commit does, except their artifacts' bytes: the author of a set is not trusted.

use serde::Deserialize;
use serde_json::Value;
use spec::{ArtifactEntry, Frame, FrameRecord, Invalid, Job, RecordText, is_of_earlier_version};
use wire::messages::RegisterRequest;

use crate::leases::checks::{Evidence, find_requested};
use crate::leases::pending::PendingArtifact;

/// Most faults of a record in a message.
const NAMED_FAULTS: usize = 5;

/// The job of a set, against which its records are checked.
pub struct SetJob(Option<Job>);

impl SetJob {
    /// `canonical`: the checked description. Frames of version 0.1 cannot be resolved here.
    pub(super) fn read(canonical: &str) -> Result<Self, Invalid> {
        if is_of_earlier_version(canonical) {
            return Ok(Self(None));
        }
        Job::from_canonical(canonical).map(|job| Self(Some(job)))
    }

    /// Returns the faults of a record, separated by semicolons.
    pub(super) fn check(&self, record: &RecordText) -> Result<(), String> {
        let faults = match &self.0 {
            None => check_types(&record.record().artifacts),
            Some(job) => {
                let received: Value =
                    serde_json::from_str(record.as_str()).map_err(|error| error.to_string())?;
                let record = FrameRecord::deserialize(&received).map_err(|error| error.to_string())?;
                let frame = job.resolve(record.frame).map_err(|error| error.to_string())?;
                check_record(&frame, &record, &received)
            }
        };
        match faults.len() {
            0 => Ok(()),
            count => {
                let mut named: Vec<String> = faults.into_iter().take(NAMED_FAULTS).collect();
                if count > NAMED_FAULTS {
                    named.push(format!("and {} more faults", count - NAMED_FAULTS));
                }
                Err(named.join("; "))
            }
        }
    }
}

/// The checks of a commit by a worker that registered with the provenance of the record and stored its files.
fn check_record(frame: &Frame, record: &FrameRecord, received: &Value) -> Vec<String> {
    let stored = record
        .artifacts
        .iter()
        .map(|entry: &ArtifactEntry| PendingArtifact {
            entry: entry.clone(),
            sides: None,
        });
    let pending: Vec<PendingArtifact> = stored.collect();
    let worker = RegisterRequest {
        code_version: record.provenance.code_version.clone(),
        cpu_features: record.provenance.cpu_features.clone(),
        onnx_runtime: record.provenance.onnx_runtime.clone(),
        ..RegisterRequest::default()
    };
    let evidence = Evidence {
        frame,
        pending: &pending,
        worker: &worker,
        record,
        received: Some(received),
    };
    let mut faults = evidence.faults();
    for entry in &record.artifacts {
        match find_requested(frame, &entry.kind).map(|kind| kind.media_type(frame.encode)) {
            None => faults.push(format!("`{}` was not requested", entry.kind)),
            Some(media_type) if media_type != entry.media_type => {
                faults.push(format!(
                    "`{}` is {media_type}, not {}",
                    entry.kind, entry.media_type
                ));
            }
            Some(_) => {}
        }
    }
    faults
}

/// Rejects types that no artifact has.
fn check_types(artifacts: &[ArtifactEntry]) -> Vec<String> {
    let mut faults = Vec::new();
    for ArtifactEntry { kind, media_type, .. } in artifacts {
        if renderer::EXTENSIONS.iter().all(|(known, _)| known != media_type) {
            faults.push(format!("`{kind}` is {media_type}, the type of no artifact"));
        }
    }
    faults
}

#[cfg(test)]
mod tests {
    use serde_json::json;
    use spec::{Provenance, Vocabulary};

    use super::*;

    fn job() -> Job {
        let description = json!({
            "count": 2, "seed": 5, "labels": {"site": "quay"},
            "scene": {"kind": "procedural", "family": "structure", "seed": {"int": [0, 1_000_000]}},
            "camera": {"width": 32, "height": 24, "hfov_deg": 80},
            "water": {"optics": "jerlov-3C"}, "metrics": ["uiqm"], "artifacts": ["rgb", "range"]
        });
        let vocabulary: Vocabulary = renderer::vocabulary(&style::Library::embedded().unwrap(), false);
        Job::parse(description.to_string().as_bytes(), &vocabulary).unwrap()
    }

    fn honest(job: &Job) -> FrameRecord {
        let frame = job.resolve(1).unwrap();
        let artifacts = frame.artifacts.iter().map(|kind| ArtifactEntry {
            kind: kind.to_string(),
            digest: "ab".repeat(32),
            bytes: 9,
            media_type: kind.media_type(frame.encode).to_owned(),
        });
        let provenance = Provenance {
            code_version: "1".to_owned(),
            cpu_features: "avx2".to_owned(),
            ..Provenance::default()
        };
        let record = json!({
            "frame": 1, "parameters": frame.parameters, "optics": {}, "plan": [],
            "measurements": {"rgb": {"uiqm": 0.5}}, "artifacts": artifacts.collect::<Vec<_>>(),
            "counts": {"holes": 0, "negative_radiance": 0, "clamped": 0, "range_saturated": 0},
            "timings_ms": {"water": 3.0}, "warnings": [],
            "provenance": provenance
        });
        serde_json::from_value(record).unwrap()
    }

    fn check(job: &Job, record: &FrameRecord) -> Result<(), String> {
        let text = RecordText::read(serde_json::to_string(record).unwrap()).unwrap();
        SetJob::read(job.canonical()).unwrap().check(&text)
    }

    /// A change of an honest record.
    type Lie = fn(&mut FrameRecord);

    #[test]
    fn a_record_that_no_commit_could_store_is_not_imported() {
        let job = job();
        assert_eq!(check(&job, &honest(&job)), Ok(()));
        let lies: [(&str, Lie); 9] = [
            ("/parameters/alpha", |r| r.parameters["alpha"] = json!(0.123)),
            ("/parameters/labels", |r| {
                r.parameters["labels"] = json!({"site": "<script>"})
            }),
            ("/parameters", |r| r.frame = 0),
            ("/counts/holes", |r| r.counts.holes = i64::MAX as u64),
            ("/timings_ms", |r| {
                r.timings_ms.insert("water".to_owned(), 1.7e308);
            }),
            ("text/html", |r| {
                r.artifacts[0].media_type = "text/html".to_owned()
            }),
            ("missing", |r| drop(r.artifacts.remove(0))),
            ("was not requested", |r| r.artifacts[1].kind = "raw".to_owned()),
            ("/measurements/rgb/entropy", |r| {
                r.measurements
                    .entry("rgb".to_owned())
                    .or_default()
                    .insert("entropy".to_owned(), 1.0);
            }),
        ];
        for (named, lie) in lies {
            let mut record = honest(&job);
            lie(&mut record);
            let refused = check(&job, &record);
            assert!(
                refused.as_ref().is_err_and(|why| why.contains(named)),
                "{named}: {refused:?}"
            );
        }
        let mut beyond = honest(&job);
        beyond.frame = 2;
        assert!(check(&job, &beyond).is_err(), "the job has two frames");
    }

    #[test]
    fn artifacts_of_earlier_versions_have_known_types_too() {
        let mut artifacts = honest(&job()).artifacts;
        assert!(check_types(&artifacts).is_empty());
        artifacts[0].media_type = "text/html".to_owned();
        assert_eq!(
            check_types(&artifacts),
            ["`rgb` is text/html, the type of no artifact"]
        );
    }
}
