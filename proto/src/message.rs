//! The messages as the program uses them: complete and checked.

use std::collections::BTreeMap;

use spec::FrameRecord;

/// A worker's hold on a frame. The token changes with every lease, the attempt with every try: a claim that is not the
/// newest changes nothing.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub struct Claim {
    /// The lease.
    pub token: u64,
    /// The job.
    pub job_id: String,
    /// The frame of the job.
    pub frame: u64,
    /// Which try this is, from 1.
    pub attempt: u32,
}

/// A worker introduces itself.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Register {
    /// Shown in the list of workers.
    pub name: String,
    /// Frames rendered side by side, at least 1.
    pub slots: u32,
    /// Version of the code.
    pub code_version: String,
    /// Version of ONNX Runtime; `None`: no style water can be rendered.
    pub onnx_runtime: Option<String>,
    /// CPU features that choose code paths.
    pub cpu_features: String,
}

/// The service's answer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Registered {
    /// `wrk_…`.
    pub worker_id: String,
    /// A lease ends this long after the last beat that named it.
    pub lease_term_ms: u32,
    /// How often to beat.
    pub beat_ms: u32,
}

/// A slot wants work.
#[derive(Debug, Clone, PartialEq)]
pub struct WantLease {
    /// `wrk_…`.
    pub worker_id: String,
    /// How long the service may hold the request.
    pub wait_ms: u32,
    /// Running mean of what a frame costs in milliseconds; 0: not known yet.
    pub frame_ms: f64,
}

/// A timed claim on some frames of a job.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Lease {
    /// Names the lease in every later call.
    pub token: u64,
    /// `job_…`.
    pub job_id: String,
    /// SHA-256 of the job's canonical description.
    pub spec_digest: String,
    /// Frames with the number of the try, at least one.
    pub frames: Vec<(u64, u32)>,
    /// How long the lease lasts without a beat.
    pub term_ms: u32,
}

/// A worker is alive and holds these leases.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BeatOf {
    /// `wrk_…`.
    pub worker_id: String,
    /// Tokens of all its leases.
    pub tokens: Vec<u64>,
}

/// What became of the leases of a beat; those not named go on.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Beat {
    /// Their jobs were cancelled.
    pub cancelled: Vec<u64>,
    /// They have ended.
    pub lost: Vec<u64>,
}

/// Files of a finished frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PutArtifacts {
    /// The frame.
    pub claim: Claim,
    /// The files.
    pub artifacts: Vec<Artifact>,
}

/// A file of a frame.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Artifact {
    /// Artifact kind, such as `rgb`.
    pub kind: String,
    /// Such as `image/png`.
    pub media_type: String,
    /// The file.
    pub data: Vec<u8>,
    /// SHA-256 as the sender says: 64 lower-case hex digits, not yet compared with the bytes.
    pub digest: String,
}

/// A frame is finished and its files are stored.
#[derive(Debug, Clone, PartialEq)]
pub struct Commit {
    /// The frame.
    pub claim: Claim,
    /// Everything known about it.
    pub record: FrameRecord,
}

/// A frame could not be rendered.
#[derive(Debug, Clone, PartialEq)]
pub struct Fail {
    /// The frame.
    pub claim: Claim,
    /// What was wrong.
    pub error: String,
    /// Whether trying again can help.
    pub retryable: bool,
    /// Milliseconds of the stages that ran.
    pub timings_ms: BTreeMap<String, f64>,
}

/// A worker gives back what is left of a lease.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Release {
    /// The lease.
    pub token: u64,
    /// For the log.
    pub reason: String,
}

/// A style model that jobs may name; its ONNX file comes by name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Style {
    /// Name by which jobs ask for it.
    pub name: String,
    /// The model's card as JSON, with the digest of the file.
    pub card_json: String,
}
