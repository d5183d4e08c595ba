//! What a worker says about one frame: its files, its record, its failure.

use spec::{ArtifactKind, FrameRecord};

use crate::check::{MessageError, digest, finite, id, length, number, text, wrong};
use crate::message::{Artifact, Claim, Commit, Fail, PutArtifacts};
use crate::{limits, wire};

fn claim(token: u64, job_id: String, frame: u64, attempt: u32) -> Result<Claim, MessageError> {
    Ok(Claim {
        token: number("token", token)?,
        job_id: id("job_id", job_id)?,
        frame,
        attempt: number("attempt", attempt)?,
    })
}

impl TryFrom<wire::PutArtifactsRequest> for PutArtifacts {
    type Error = MessageError;

    fn try_from(wire: wire::PutArtifactsRequest) -> Result<Self, MessageError> {
        length("artifacts", wire.artifacts.len(), limits::ARTIFACTS, "artifacts")?;
        Ok(Self {
            claim: claim(wire.token, wire.job_id, wire.frame, wire.attempt)?,
            artifacts: wire
                .artifacts
                .into_iter()
                .map(Artifact::try_from)
                .collect::<Result<_, _>>()?,
        })
    }
}

impl From<PutArtifacts> for wire::PutArtifactsRequest {
    fn from(PutArtifacts { claim, artifacts }: PutArtifacts) -> Self {
        let Claim {
            token,
            job_id,
            frame,
            attempt,
        } = claim;
        Self {
            token,
            job_id,
            frame,
            attempt,
            artifacts: artifacts.into_iter().map(Into::into).collect(),
        }
    }
}

impl TryFrom<wire::Artifact> for Artifact {
    type Error = MessageError;

    fn try_from(wire: wire::Artifact) -> Result<Self, MessageError> {
        if !is_kind(&wire.kind) {
            return Err(wrong("kind", &wire.kind, "an artifact kind"));
        }
        if !is_media_type(&wire.media_type) {
            return Err(wrong("media_type", &wire.media_type, "such as image/png"));
        }
        let digest = digest("digest", wire.digest)?;
        Ok(Self {
            kind: wire.kind,
            media_type: wire.media_type,
            data: wire.data,
            digest,
        })
    }
}

/// It becomes part of paths and file names elsewhere, so a method's name is a plain word here, known or not.
fn is_kind(text: &str) -> bool {
    let plain = |byte: u8| byte.is_ascii_lowercase() || byte.is_ascii_digit() || b"._-".contains(&byte);
    text.len() <= limits::ID_BYTES && text.bytes().all(plain) && ArtifactKind::parse(text).is_some()
}

/// It becomes a header of answers, so nothing else may pass.
fn is_media_type(text: &str) -> bool {
    let plain = |part: &str| {
        !part.is_empty()
            && part
                .bytes()
                .all(|byte| byte.is_ascii_alphanumeric() || b"-+.".contains(&byte))
    };
    text.len() <= limits::ID_BYTES
        && text
            .split_once('/')
            .is_some_and(|(kind, name)| plain(kind) && plain(name))
}

impl From<Artifact> for wire::Artifact {
    fn from(
        Artifact {
            kind,
            media_type,
            data,
            digest,
        }: Artifact,
    ) -> Self {
        Self {
            kind,
            media_type,
            data,
            digest,
        }
    }
}

impl TryFrom<wire::CommitRequest> for Commit {
    type Error = MessageError;

    fn try_from(wire: wire::CommitRequest) -> Result<Self, MessageError> {
        let claim = claim(wire.token, wire.job_id, wire.frame, wire.attempt)?;
        length(
            "record_json",
            wire.record_json.len(),
            limits::RECORD_BYTES,
            "bytes",
        )?;
        let record: FrameRecord = serde_json::from_slice(&wire.record_json)
            .map_err(|error| MessageError::Record(error.to_string()))?;
        if record.frame != claim.frame {
            let message = format!(
                "it is of frame {}, the claim is on frame {}",
                record.frame, claim.frame
            );
            return Err(MessageError::Record(message));
        }
        for artifact in &record.artifacts {
            digest("record_json", artifact.digest.clone())?;
        }
        Ok(Self { claim, record })
    }
}

impl From<Commit> for wire::CommitRequest {
    fn from(Commit { claim, record }: Commit) -> Self {
        let Claim {
            token,
            job_id,
            frame,
            attempt,
        } = claim;
        let record_json =
            serde_json::to_vec(&record).expect("maps with string keys and numbers always serialise");
        Self {
            token,
            job_id,
            frame,
            attempt,
            record_json,
        }
    }
}

impl TryFrom<wire::FailRequest> for Fail {
    type Error = MessageError;

    fn try_from(wire: wire::FailRequest) -> Result<Self, MessageError> {
        length("timings_ms", wire.timings_ms.len(), limits::TIMINGS, "entries")?;
        for (name, ms) in &wire.timings_ms {
            length("timings_ms", name.len(), limits::ID_BYTES, "bytes")?;
            finite("timings_ms", *ms)?;
        }
        Ok(Self {
            claim: claim(wire.token, wire.job_id, wire.frame, wire.attempt)?,
            error: text("error", wire.error, limits::ERROR_BYTES)?,
            retryable: wire.retryable,
            timings_ms: wire.timings_ms,
        })
    }
}

impl From<Fail> for wire::FailRequest {
    fn from(
        Fail {
            claim,
            error,
            retryable,
            timings_ms,
        }: Fail,
    ) -> Self {
        let Claim {
            token,
            job_id,
            frame,
            attempt,
        } = claim;
        Self {
            token,
            job_id,
            frame,
            attempt,
            error,
            retryable,
            timings_ms,
        }
    }
}
