//! Checks of each message: presence, lengths, digests, numbers.

use prost::Message;
use spec::{ArtifactKind, FrameRecord};

use crate::messages::{
    Artifact, BeatRequest, BeatResponse, Claim, CommitRequest, CommitResponse, FailRequest, Lease,
    LeaseRequest, LeaseResponse, PutArtifactsRequest, RegisterRequest, RegisterResponse, ReleaseRequest,
    Style, StylesResponse,
};
use crate::rules::{check_digest, check_id, check_length, check_text, check_value, check_version, require};
use crate::{MessageError, limits};

/// A message with field constraints.
pub trait Checked: Message + Default {
    /// Checks every field.
    ///
    /// # Errors
    /// [`MessageError`] for the first invalid field.
    fn check(&self) -> Result<(), MessageError>;
}

impl Checked for RegisterRequest {
    fn check(&self) -> Result<(), MessageError> {
        check_version(self.protocol)?;
        require("name", &self.name)?;
        check_text("name", &self.name, limits::NAME_BYTES)?;
        require("slots", &self.slots)?;
        check_value("slots", self.slots, self.slots <= limits::SLOTS, "1..=1024")?;
        check_text("code_version", &self.code_version, limits::NAME_BYTES)?;
        check_text("onnx_runtime", self.onnx_runtime(), limits::NAME_BYTES)?;
        check_text("cpu_features", &self.cpu_features, limits::NAME_BYTES)
    }
}

impl Checked for RegisterResponse {
    fn check(&self) -> Result<(), MessageError> {
        check_version(self.protocol)?;
        check_id("worker_id", &self.worker_id)?;
        require("lease_term_ms", &self.lease_term_ms)?;
        require("beat_ms", &self.beat_ms)
    }
}

impl Checked for LeaseRequest {
    fn check(&self) -> Result<(), MessageError> {
        check_id("worker_id", &self.worker_id)?;
        let holds = self.frame_ms.is_finite() && self.frame_ms >= 0.0;
        check_value("frame_ms", self.frame_ms, holds, "0 or more")
    }
}

impl Checked for LeaseResponse {
    fn check(&self) -> Result<(), MessageError> {
        self.lease.as_ref().map_or(Ok(()), Lease::check)
    }
}

impl Checked for Lease {
    fn check(&self) -> Result<(), MessageError> {
        require("frames", &self.frames)?;
        check_length("frames", self.frames.len(), limits::LEASE_FRAMES, "frames")?;
        for claim in &self.frames {
            require("attempt", &claim.attempt)?;
        }
        require("token", &self.token)?;
        check_id("job_id", &self.job_id)?;
        check_digest("spec_digest", &self.spec_digest)?;
        require("term_ms", &self.term_ms)
    }
}

impl Checked for BeatRequest {
    fn check(&self) -> Result<(), MessageError> {
        check_length("tokens", self.tokens.len(), limits::BEAT_TOKENS, "tokens")?;
        check_id("worker_id", &self.worker_id)
    }
}

impl Checked for BeatResponse {
    fn check(&self) -> Result<(), MessageError> {
        Ok(())
    }
}

impl Checked for PutArtifactsRequest {
    fn check(&self) -> Result<(), MessageError> {
        check_length("artifacts", self.artifacts.len(), limits::ARTIFACTS, "artifacts")?;
        check_claim(&self.claim)?;
        self.artifacts.iter().try_for_each(check_artifact)
    }
}

impl Checked for CommitRequest {
    fn check(&self) -> Result<(), MessageError> {
        check_claim(&self.claim)?;
        let bytes = self.record_json.len();
        check_length("record_json", bytes, limits::RECORD_BYTES, "bytes")
    }
}

impl CommitRequest {
    /// Parses the record of the claimed frame.
    ///
    /// # Errors
    /// [`MessageError::Record`] if it does not parse or belongs to another frame; [`MessageError::Value`] for a bad
    /// digest.
    pub fn record(&self) -> Result<FrameRecord, MessageError> {
        let record: FrameRecord = serde_json::from_slice(&self.record_json)
            .map_err(|error| MessageError::Record(error.to_string()))?;
        let claimed = self.claim.as_ref().map_or(0, |claim| claim.frame);
        if record.frame != claimed {
            let message = format!(
                "it belongs to frame {}, but the claim is for frame {claimed}",
                record.frame
            );
            return Err(MessageError::Record(message));
        }
        for artifact in &record.artifacts {
            check_digest("record_json", &artifact.digest)?;
        }
        Ok(record)
    }
}

impl Checked for CommitResponse {
    fn check(&self) -> Result<(), MessageError> {
        Ok(())
    }
}

impl Checked for FailRequest {
    fn check(&self) -> Result<(), MessageError> {
        check_length("timings_ms", self.timings_ms.len(), limits::TIMINGS, "entries")?;
        for (name, &ms) in &self.timings_ms {
            check_text("timings_ms", name, limits::ID_BYTES)?;
            check_value("timings_ms", ms, ms.is_finite(), "a finite number")?;
        }
        check_claim(&self.claim)?;
        check_text("error", &self.error, limits::ERROR_BYTES)
    }
}

impl Checked for ReleaseRequest {
    fn check(&self) -> Result<(), MessageError> {
        require("token", &self.token)?;
        check_text("reason", &self.reason, limits::ERROR_BYTES)
    }
}

impl Checked for StylesResponse {
    fn check(&self) -> Result<(), MessageError> {
        check_length("styles", self.styles.len(), limits::STYLES, "styles")?;
        for Style { name, card_json } in &self.styles {
            check_id("name", name)?;
            check_text("card_json", card_json, limits::CARD_BYTES)?;
        }
        Ok(())
    }
}

/// The empty response.
impl Checked for () {
    fn check(&self) -> Result<(), MessageError> {
        Ok(())
    }
}

fn check_claim(claim: &Option<Claim>) -> Result<(), MessageError> {
    let claim = claim.as_ref().ok_or(MessageError::Missing { field: "claim" })?;
    require("token", &claim.token)?;
    check_id("job_id", &claim.job_id)?;
    require("attempt", &claim.attempt)
}

/// Longest media type, bytes.
const MOST_MEDIA_TYPE: usize = 64;

fn check_artifact(artifact: &Artifact) -> Result<(), MessageError> {
    let Artifact { kind, media_type, .. } = artifact;
    check_value("kind", kind, ArtifactKind::is_name(kind), "an artifact kind")?;
    // Which type a kind has is for the service to judge.
    let is_plain = media_type
        .bytes()
        .all(|byte| byte.is_ascii_alphanumeric() || b"-+./".contains(&byte));
    check_value(
        "media_type",
        media_type,
        is_plain && media_type.len() <= MOST_MEDIA_TYPE && media_type.contains('/'),
        "such as image/png",
    )?;
    check_digest("digest", &artifact.digest)
}

#[cfg(test)]
mod tests;
