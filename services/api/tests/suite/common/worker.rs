//! A worker over the real protocol that stores synthetic images.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;

use renderer::worker::client::{Client, ClientError};
use renderer::worker::{Limits, WorkerOptions};
use serde_json::{Map, json};
use spec::{ArtifactEntry, Counts, Frame, FrameRecord, Job, Provenance};
use style::Library;
use wire::messages::{
    Artifact, BeatRequest, BeatResponse, Claim, CommitRequest, FailRequest, Lease, LeaseRequest,
    PutArtifactsRequest, RegisterRequest,
};

use super::Running;
use super::bytes::numbered_png;

pub(crate) struct Fake {
    pub(crate) client: Client,
    pub(crate) id: String,
}

impl Fake {
    pub(crate) fn register(service: &Running) -> Self {
        Self::with_runtime(service, None)
    }

    /// A worker with or without the runtime of the style models.
    pub(crate) fn with_runtime(service: &Running, onnx_runtime: Option<&str>) -> Self {
        Self::try_named(service, "fake", onnx_runtime).unwrap()
    }

    pub(crate) fn try_named(
        service: &Running,
        name: &str,
        onnx_runtime: Option<&str>,
    ) -> Result<Self, ClientError> {
        let client = Client::new(&service.url, service.token);
        let about = RegisterRequest {
            name: name.into(),
            slots: 1,
            code_version: "test".into(),
            onnx_runtime: onnx_runtime.map(str::to_owned),
            cpu_features: "none".into(),
            protocol: wire::VERSION,
        };
        let id = client.register(&about)?.worker_id;
        Ok(Self { client, id })
    }

    pub(crate) fn try_lease(&self, wait_ms: u32) -> Result<Option<Lease>, ClientError> {
        let request = LeaseRequest {
            worker_id: self.id.clone(),
            wait_ms,
            frame_ms: 0.0,
        };
        self.client.lease(&request)
    }

    pub(crate) fn lease(&self, wait_ms: u32) -> Option<Lease> {
        self.try_lease(wait_ms).unwrap()
    }

    pub(crate) fn beat(&self, tokens: &[u64]) -> BeatResponse {
        let leases = BeatRequest {
            worker_id: self.id.clone(),
            tokens: tokens.to_vec(),
            wait_ms: 0,
        };
        self.client.beat(&leases).unwrap()
    }

    pub(crate) fn release(&self, lease: &Lease) {
        self.client.release(lease.token, "test").unwrap();
    }

    /// Stores and commits the first frame of a lease; returns whether it already existed.
    pub(crate) fn finish(&self, lease: &Lease) -> Result<bool, ClientError> {
        let frame = self.frame(lease)?;
        let picture = numbered_png(frame.camera.width, frame.camera.height, frame.index);
        self.finish_with(lease, picture)
    }

    /// The first frame of a lease, as its description resolves it.
    pub(crate) fn frame(&self, lease: &Lease) -> Result<Frame, ClientError> {
        let description = self.client.description(&lease.job_id)?;
        let job = Job::from_canonical(&String::from_utf8(description).unwrap()).unwrap();
        Ok(job.resolve(lease.frames[0].frame).unwrap())
    }

    /// Finishes with this image.
    pub(crate) fn finish_with(&self, lease: &Lease, picture: Vec<u8>) -> Result<bool, ClientError> {
        let record = self.put(lease, picture)?;
        self.client.commit(&commit(claim(lease), &record))
    }

    /// Stores an image for the first frame of a lease; returns the record to commit.
    pub(crate) fn put(&self, lease: &Lease, picture: Vec<u8>) -> Result<FrameRecord, ClientError> {
        let claim = claim(lease);
        let digest = spec::sha256(&picture);
        let record = record(&self.frame(lease)?, &digest, picture.len() as u64);
        let file = Artifact {
            kind: "rgb".into(),
            media_type: "image/png".into(),
            data: picture,
            digest,
        };
        self.client.put_artifacts(&PutArtifactsRequest {
            claim: Some(claim),
            artifacts: vec![file],
        })?;
        Ok(record)
    }

    /// Reports a failure of the first frame of a lease.
    pub(crate) fn fail(&self, lease: &Lease, error: &str) {
        self.try_fail(lease, error).unwrap();
    }

    pub(crate) fn try_fail(&self, lease: &Lease, error: &str) -> Result<(), ClientError> {
        let fail = FailRequest {
            claim: Some(claim(lease)),
            error: error.into(),
            retryable: false,
            timings_ms: BTreeMap::new(),
        };
        self.client.fail(&fail)
    }

    /// Leases and finishes all available frames. Leases of an unknown cost have one frame.
    pub(crate) fn work(&self) {
        while let Some(lease) = self.lease(300) {
            self.finish(&lease).unwrap();
        }
    }
}

/// The real worker, on threads of this process, over real HTTP; stops when dropped.
pub(crate) struct Real {
    stop: Arc<AtomicBool>,
    thread: Option<JoinHandle<()>>,
}

impl Real {
    pub(crate) fn start(service: &Running) -> Self {
        let stop = Arc::new(AtomicBool::new(false));
        let options = WorkerOptions {
            server: service.url.clone(),
            token: service.token.map(str::to_owned),
            slots: 2,
            name: "real".to_owned(),
            library: Library::embedded().unwrap(),
            onnxruntime: None,
            limits: Limits::NONE,
        };
        let told = Arc::clone(&stop);
        let thread = std::thread::spawn(move || renderer::worker::run(options, told).unwrap());
        Self {
            stop,
            thread: Some(thread),
        }
    }
}

impl Drop for Real {
    fn drop(&mut self) {
        self.stop.store(true, Ordering::SeqCst);
        if let Some(thread) = self.thread.take() {
            thread.join().unwrap();
        }
    }
}

/// The claim on the first frame of a lease.
pub(crate) fn claim(lease: &Lease) -> Claim {
    let first = lease.frames[0];
    Claim {
        token: lease.token,
        job_id: lease.job_id.clone(),
        frame: first.frame,
        attempt: first.attempt,
    }
}

pub(crate) fn commit(claim: Claim, record: &FrameRecord) -> CommitRequest {
    CommitRequest {
        claim: Some(claim),
        record_json: serde_json::to_vec(record).unwrap(),
    }
}

/// The record of an honest worker.
pub(crate) fn record(frame: &Frame, digest: &str, bytes: u64) -> FrameRecord {
    let values = [("uiqm", 0.5 + frame.index as f64), ("uciqe", 0.4)].into_iter();
    let measured = values.filter(|(metric, _)| frame.metrics.iter().any(|asked| asked == metric));
    let measured = measured
        .map(|(metric, value)| (metric.to_owned(), value))
        .collect();
    FrameRecord {
        frame: frame.index,
        parameters: frame.parameters.clone(),
        optics: Map::new(),
        plan: json!([]),
        promise: None,
        measurements: BTreeMap::from([("rgb".to_owned(), measured)]),
        artifacts: vec![ArtifactEntry {
            kind: "rgb".into(),
            digest: digest.to_owned(),
            bytes,
            media_type: "image/png".into(),
        }],
        counts: Counts::default(),
        timings_ms: BTreeMap::from([("water".to_owned(), 3.0)]),
        warnings: Vec::new(),
        scene: None,
        truth: None,
        provenance: Provenance {
            code_version: "test".into(),
            cpu_features: "none".into(),
            ..Provenance::default()
        },
    }
}
