//! Registering, leasing, beating, releasing.

use crate::check::{MessageError, digest, id, length, not_negative, number, text, version, wrong};
use crate::message::{Beat, BeatOf, Lease, Register, Registered, Release, WantLease};
use crate::{limits, wire};

impl TryFrom<wire::RegisterRequest> for Register {
    type Error = MessageError;

    fn try_from(wire: wire::RegisterRequest) -> Result<Self, MessageError> {
        version(wire.protocol)?;
        let name = text("name", number("name", wire.name)?, limits::NAME_BYTES)?;
        let slots = number("slots", wire.slots)?;
        if slots > limits::SLOTS {
            return Err(wrong("slots", &slots, "1..=1024"));
        }
        let onnx_runtime = text("onnx_runtime", wire.onnx_runtime, limits::NAME_BYTES)?;
        Ok(Self {
            name,
            slots,
            code_version: text("code_version", wire.code_version, limits::NAME_BYTES)?,
            onnx_runtime: (!onnx_runtime.is_empty()).then_some(onnx_runtime),
            cpu_features: text("cpu_features", wire.cpu_features, limits::NAME_BYTES)?,
        })
    }
}

impl From<Register> for wire::RegisterRequest {
    fn from(message: Register) -> Self {
        let Register {
            name,
            slots,
            code_version,
            onnx_runtime,
            cpu_features,
        } = message;
        Self {
            name,
            slots,
            code_version,
            onnx_runtime: onnx_runtime.unwrap_or_default(),
            cpu_features,
            protocol: crate::VERSION,
        }
    }
}

impl TryFrom<wire::RegisterResponse> for Registered {
    type Error = MessageError;

    fn try_from(wire: wire::RegisterResponse) -> Result<Self, MessageError> {
        version(wire.protocol)?;
        Ok(Self {
            worker_id: id("worker_id", wire.worker_id)?,
            lease_term_ms: number("lease_term_ms", wire.lease_term_ms)?,
            beat_ms: number("beat_ms", wire.beat_ms)?,
        })
    }
}

impl From<Registered> for wire::RegisterResponse {
    fn from(message: Registered) -> Self {
        let Registered {
            worker_id,
            lease_term_ms,
            beat_ms,
        } = message;
        Self {
            worker_id,
            lease_term_ms,
            beat_ms,
            protocol: crate::VERSION,
        }
    }
}

impl TryFrom<wire::LeaseRequest> for WantLease {
    type Error = MessageError;

    fn try_from(wire: wire::LeaseRequest) -> Result<Self, MessageError> {
        Ok(Self {
            worker_id: id("worker_id", wire.worker_id)?,
            wait_ms: wire.wait_ms,
            frame_ms: not_negative("frame_ms", wire.frame_ms)?,
        })
    }
}

impl From<WantLease> for wire::LeaseRequest {
    fn from(message: WantLease) -> Self {
        let WantLease {
            worker_id,
            wait_ms,
            frame_ms,
        } = message;
        Self {
            worker_id,
            wait_ms,
            frame_ms,
        }
    }
}

impl TryFrom<wire::Lease> for Lease {
    type Error = MessageError;

    fn try_from(wire: wire::Lease) -> Result<Self, MessageError> {
        if wire.frames.is_empty() {
            return Err(MessageError::Missing { field: "frames" });
        }
        length("frames", wire.frames.len(), limits::LEASE_FRAMES, "frames")?;
        let frames = wire
            .frames
            .into_iter()
            .map(|claim| Ok((claim.frame, number("attempt", claim.attempt)?)));
        Ok(Self {
            frames: frames.collect::<Result<_, _>>()?,
            token: number("token", wire.token)?,
            job_id: id("job_id", wire.job_id)?,
            spec_digest: digest("spec_digest", wire.spec_digest)?,
            term_ms: number("term_ms", wire.term_ms)?,
        })
    }
}

impl From<Lease> for wire::Lease {
    fn from(message: Lease) -> Self {
        let Lease {
            token,
            job_id,
            spec_digest,
            frames,
            term_ms,
        } = message;
        let frames = frames
            .into_iter()
            .map(|(frame, attempt)| wire::FrameClaim { frame, attempt })
            .collect();
        Self {
            token,
            job_id,
            spec_digest,
            frames,
            term_ms,
        }
    }
}

impl TryFrom<wire::BeatRequest> for BeatOf {
    type Error = MessageError;

    fn try_from(wire: wire::BeatRequest) -> Result<Self, MessageError> {
        length("tokens", wire.tokens.len(), limits::BEAT_TOKENS, "tokens")?;
        Ok(Self {
            worker_id: id("worker_id", wire.worker_id)?,
            tokens: wire.tokens,
        })
    }
}

impl From<BeatOf> for wire::BeatRequest {
    fn from(BeatOf { worker_id, tokens }: BeatOf) -> Self {
        Self { worker_id, tokens }
    }
}

impl From<wire::BeatResponse> for Beat {
    fn from(wire::BeatResponse { cancelled, lost }: wire::BeatResponse) -> Self {
        Self { cancelled, lost }
    }
}

impl From<Beat> for wire::BeatResponse {
    fn from(Beat { cancelled, lost }: Beat) -> Self {
        Self { cancelled, lost }
    }
}

impl TryFrom<wire::ReleaseRequest> for Release {
    type Error = MessageError;

    fn try_from(wire: wire::ReleaseRequest) -> Result<Self, MessageError> {
        Ok(Self {
            token: number("token", wire.token)?,
            reason: text("reason", wire.reason, limits::ERROR_BYTES)?,
        })
    }
}

impl From<Release> for wire::ReleaseRequest {
    fn from(Release { token, reason }: Release) -> Self {
        Self { token, reason }
    }
}
