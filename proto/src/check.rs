//! What each message must hold: presence, lengths, digests, numbers.

use prost::Message;
use spec::{ArtifactKind, FrameRecord, is_media_type};

use crate::rules::{digest, id, length, present, text, value_holds, version};
use crate::wire::{
    Artifact, BeatRequest, BeatResponse, Claim, CommitRequest, CommitResponse, FailRequest, Lease,
    LeaseRequest, LeaseResponse, PutArtifactsRequest, RegisterRequest, RegisterResponse, ReleaseRequest,
    Style, StylesResponse,
};
use crate::{MessageError, limits};

/// A message that knows what its fields must hold.
pub trait Checked: Message + Default {
    /// Checks every field.
    ///
    /// # Errors
    /// [`MessageError`] for the first field that holds what it must not.
    fn check(&self) -> Result<(), MessageError>;
}

impl Checked for RegisterRequest {
    fn check(&self) -> Result<(), MessageError> {
        version(self.protocol)?;
        present("name", &self.name)?;
        text("name", &self.name, limits::NAME_BYTES)?;
        present("slots", &self.slots)?;
        value_holds("slots", self.slots, self.slots <= limits::SLOTS, "1..=1024")?;
        text("code_version", &self.code_version, limits::NAME_BYTES)?;
        text("onnx_runtime", self.onnx_runtime(), limits::NAME_BYTES)?;
        text("cpu_features", &self.cpu_features, limits::NAME_BYTES)
    }
}

impl Checked for RegisterResponse {
    fn check(&self) -> Result<(), MessageError> {
        version(self.protocol)?;
        id("worker_id", &self.worker_id)?;
        present("lease_term_ms", &self.lease_term_ms)?;
        present("beat_ms", &self.beat_ms)
    }
}

impl Checked for LeaseRequest {
    fn check(&self) -> Result<(), MessageError> {
        id("worker_id", &self.worker_id)?;
        let holds = self.frame_ms.is_finite() && self.frame_ms >= 0.0;
        value_holds("frame_ms", self.frame_ms, holds, "0 or more")
    }
}

impl Checked for LeaseResponse {
    fn check(&self) -> Result<(), MessageError> {
        self.lease.as_ref().map_or(Ok(()), Lease::check)
    }
}

impl Checked for Lease {
    fn check(&self) -> Result<(), MessageError> {
        present("frames", &self.frames)?;
        length("frames", self.frames.len(), limits::LEASE_FRAMES, "frames")?;
        for claim in &self.frames {
            present("attempt", &claim.attempt)?;
        }
        present("token", &self.token)?;
        id("job_id", &self.job_id)?;
        digest("spec_digest", &self.spec_digest)?;
        present("term_ms", &self.term_ms)
    }
}

impl Checked for BeatRequest {
    fn check(&self) -> Result<(), MessageError> {
        length("tokens", self.tokens.len(), limits::BEAT_TOKENS, "tokens")?;
        id("worker_id", &self.worker_id)
    }
}

impl Checked for BeatResponse {
    fn check(&self) -> Result<(), MessageError> {
        Ok(())
    }
}

impl Checked for PutArtifactsRequest {
    fn check(&self) -> Result<(), MessageError> {
        length("artifacts", self.artifacts.len(), limits::ARTIFACTS, "artifacts")?;
        claim(&self.claim)?;
        self.artifacts.iter().try_for_each(artifact)
    }
}

impl Checked for CommitRequest {
    fn check(&self) -> Result<(), MessageError> {
        claim(&self.claim)?;
        let bytes = self.record_json.len();
        length("record_json", bytes, limits::RECORD_BYTES, "bytes")
    }
}

impl CommitRequest {
    /// The record of the claimed frame.
    ///
    /// # Errors
    /// [`MessageError::Record`], also for the record of another frame; [`MessageError::Value`] for a digest.
    pub fn record(&self) -> Result<FrameRecord, MessageError> {
        let record: FrameRecord = serde_json::from_slice(&self.record_json)
            .map_err(|error| MessageError::Record(error.to_string()))?;
        let claimed = self.claim.as_ref().map_or(0, |claim| claim.frame);
        if record.frame != claimed {
            let message = format!("it is of frame {}, the claim is on frame {claimed}", record.frame);
            return Err(MessageError::Record(message));
        }
        for artifact in &record.artifacts {
            digest("record_json", &artifact.digest)?;
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
        length("timings_ms", self.timings_ms.len(), limits::TIMINGS, "entries")?;
        for (name, &ms) in &self.timings_ms {
            text("timings_ms", name, limits::ID_BYTES)?;
            value_holds("timings_ms", ms, ms.is_finite(), "a finite number")?;
        }
        claim(&self.claim)?;
        text("error", &self.error, limits::ERROR_BYTES)
    }
}

impl Checked for ReleaseRequest {
    fn check(&self) -> Result<(), MessageError> {
        present("token", &self.token)?;
        text("reason", &self.reason, limits::ERROR_BYTES)
    }
}

impl Checked for StylesResponse {
    fn check(&self) -> Result<(), MessageError> {
        length("styles", self.styles.len(), limits::STYLES, "styles")?;
        for Style { name, card_json } in &self.styles {
            id("name", name)?;
            text("card_json", card_json, limits::CARD_BYTES)?;
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

fn claim(claim: &Option<Claim>) -> Result<(), MessageError> {
    let claim = claim.as_ref().ok_or(MessageError::Missing { field: "claim" })?;
    present("token", &claim.token)?;
    id("job_id", &claim.job_id)?;
    present("attempt", &claim.attempt)
}

fn artifact(artifact: &Artifact) -> Result<(), MessageError> {
    let Artifact { kind, media_type, .. } = artifact;
    value_holds("kind", kind, ArtifactKind::is_name(kind), "an artifact kind")?;
    value_holds(
        "media_type",
        media_type,
        is_media_type(media_type),
        "such as image/png",
    )?;
    digest("digest", &artifact.digest)
}

#[cfg(test)]
mod tests;
