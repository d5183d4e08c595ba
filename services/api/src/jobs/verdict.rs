//! Compares a stored frame with the same frame rendered again: the whole record, and the artifacts if machines differ.

use std::sync::Arc;

use serde::Deserialize;
use spec::{Agreement, ArtifactEntry, FrameRecord, Provenance, compare_records, describe_differences};

use super::Jobs;
use super::rounding::artifact_differs;
use crate::http::problem::Problem;
use crate::images::rerender::Again;

/// Result of a check.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Verdict {
    Good,
    /// The check is inconclusive.
    Open(String),
    /// The frames differ.
    Differs(String),
}

/// How the records of two provenances are compared; the verdict if they are not.
fn choose_agreement(stored: &Provenance, again: &Provenance) -> Result<Agreement, Verdict> {
    if stored.code_version != again.code_version {
        let reason = format!("the frame is of version {}", stored.code_version);
        return Err(Verdict::Open(reason));
    }
    match (&stored.onnx_runtime, &again.onnx_runtime) {
        (Some(stored), Some(again)) if stored != again => {
            return Err(Verdict::Open(format!("the frame used ONNX Runtime {stored}")));
        }
        // Either the network ran natively, or it did not.
        (stored, again) if stored != again => {
            let claim = format!("/provenance/onnx_runtime is {stored:?}, but the frame uses {again:?}");
            return Err(Verdict::Differs(claim));
        }
        _ => {}
    }
    match stored.cpu_features == again.cpu_features {
        true => Ok(Agreement::Exact),
        false => Ok(Agreement::Rounded),
    }
}

impl Jobs {
    /// The record of a stored frame, or why it cannot be checked at all.
    pub(super) async fn read_checkable(&self, job: &str, frame: u64) -> Result<FrameRecord, Verdict> {
        let image = self.images.get(job, frame).await;
        let image = image.map_err(|problem| Verdict::Open(problem.to_string()))?;
        let stored = FrameRecord::deserialize(&image);
        let stored = stored.map_err(|error| Verdict::Open(error.to_string()))?;
        match stored.provenance.code_version == renderer::CODE_VERSION {
            true => Ok(stored),
            false => {
                let version = &stored.provenance.code_version;
                Err(Verdict::Open(format!("the frame is of version {version}")))
            }
        }
    }

    /// Compares a stored frame with the same frame rendered again.
    pub(super) async fn judge(
        &self,
        job: &str,
        stored: &FrameRecord,
        again: Again,
    ) -> Result<Verdict, Problem> {
        let agreement = match choose_agreement(&stored.provenance, &again.record.provenance) {
            Ok(agreement) => agreement,
            Err(verdict) => return Ok(verdict),
        };
        let differences = compare_records(&again.record, stored, agreement);
        if let Some(difference) = describe_differences(&differences) {
            return Ok(Verdict::Differs(difference));
        }
        if agreement == Agreement::Exact {
            return Ok(Verdict::Good);
        }
        let again = Arc::new(again);
        for ArtifactEntry { kind, .. } in &stored.artifacts {
            let artifact = self.images.artifact(job, stored.frame, kind).await?;
            let bytes = self.images.stored(artifact).await?.bytes;
            let (again, name) = (Arc::clone(&again), kind.clone());
            let compare = move || artifact_differs(&name, &bytes, &again.bytes(&name).unwrap_or_default());
            if let Some(difference) = self.processes.compute.run(compare).await? {
                return Ok(Verdict::Differs(format!("`{kind}`: {difference}")));
            }
        }
        Ok(Verdict::Good)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn provenance(version: &str, runtime: Option<&str>, cpu_features: &str) -> Provenance {
        Provenance {
            code_version: version.to_owned(),
            onnx_runtime: runtime.map(str::to_owned),
            cpu_features: cpu_features.to_owned(),
            ..Provenance::default()
        }
    }

    /// The choice for a frame that renders natively here.
    fn chosen(stored: Provenance) -> Result<Agreement, Verdict> {
        choose_agreement(&stored, &provenance("1", None, "avx2"))
    }

    #[test]
    fn a_runtime_is_verified_and_other_versions_are_open() {
        assert_eq!(chosen(provenance("1", None, "avx2")), Ok(Agreement::Exact));
        assert_eq!(chosen(provenance("1", None, "none")), Ok(Agreement::Rounded));
        assert!(matches!(
            chosen(provenance("9.9.9", None, "avx2")),
            Err(Verdict::Open(_))
        ));
        let claimed = chosen(provenance("1", Some("1.20"), "avx2"));
        assert!(matches!(claimed, Err(Verdict::Differs(what)) if what.contains("/provenance/onnx_runtime")));
        let other = choose_agreement(
            &provenance("1", Some("1.20"), "avx2"),
            &provenance("1", Some("1.22"), "avx2"),
        );
        assert!(matches!(other, Err(Verdict::Open(_))));
    }
}
