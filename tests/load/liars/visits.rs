//! A worker in this process that registers, delivers frames and leaves.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use renderer::worker::client::{Client, ClientError};
use renderer::{CODE_VERSION, Engine, SceneSource, Slot, cpu_features};
use spec::{FrameRecord, Job};
use style::Library;
use wire::messages::{
    Artifact, Claim, CommitRequest, Lease, LeaseRequest, PutArtifactsRequest, RegisterRequest,
};

use super::lies::{Delivered, Lie};

/// The registration of a worker.
#[derive(Clone)]
pub(super) struct Identity {
    pub(super) name: String,
    pub(super) code_version: String,
    pub(super) onnx_runtime: Option<String>,
    pub(super) cpu_features: String,
}

impl Identity {
    /// That of a worker of this program on this machine.
    pub(super) fn honest(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            code_version: CODE_VERSION.to_owned(),
            onnx_runtime: None,
            cpu_features: cpu_features(),
        }
    }

    pub(super) fn with_runtime(name: &str, runtime: &str) -> Self {
        Self {
            onnx_runtime: Some(runtime.to_owned()),
            ..Self::honest(name)
        }
    }
}

/// A registered worker.
pub(super) struct Visitor {
    client: Client,
    id: String,
    slot: Slot,
    identity: Identity,
}

impl Visitor {
    pub(super) fn register(url: &str, identity: &Identity) -> Result<Self, ClientError> {
        let client = Client::new(url, None);
        let registered = client.register(&RegisterRequest {
            name: identity.name.clone(),
            slots: 1,
            code_version: identity.code_version.clone(),
            onnx_runtime: identity.onnx_runtime.clone(),
            cpu_features: identity.cpu_features.clone(),
            protocol: wire::VERSION,
        })?;
        let library = Library::embedded().expect("the shipped styles");
        Ok(Self {
            client,
            id: registered.worker_id,
            slot: Slot::new(&Arc::new(Engine::new(library, None))),
            identity: identity.clone(),
        })
    }

    /// A lease of one frame; `None` also for a dismissed worker.
    pub(super) fn lease(&mut self, wait_ms: u32) -> Option<Lease> {
        let request = LeaseRequest {
            worker_id: self.id.clone(),
            wait_ms,
            frame_ms: 0.0,
        };
        self.client.lease(&request).ok().flatten()
    }

    /// The true frame of a lease, with the provenance of the registration.
    pub(super) fn render(&mut self, lease: &Lease) -> Delivered {
        let description = self.client.description(&lease.job_id).expect("a description");
        let description = String::from_utf8(description).expect("text");
        let job = Job::from_canonical(&description).expect("a job");
        let frame = job.resolve(lease.frames[0].frame).expect("a frame");
        let rendered = self.slot.attempt(&frame, &SceneSource::Local).expect("an image");
        let mut record = rendered.record;
        record
            .provenance
            .code_version
            .clone_from(&self.identity.code_version);
        record
            .provenance
            .cpu_features
            .clone_from(&self.identity.cpu_features);
        let files = rendered.files.into_iter().map(|file| Artifact {
            kind: file.kind,
            media_type: file.media_type.to_owned(),
            data: file.bytes,
            digest: file.digest,
        });
        Delivered {
            record,
            files: files.collect(),
        }
    }

    /// Stores and commits a frame.
    pub(super) fn deliver(&self, lease: &Lease, delivered: &Delivered) -> Result<bool, ClientError> {
        let claim = Claim {
            token: lease.token,
            job_id: lease.job_id.clone(),
            frame: lease.frames[0].frame,
            attempt: lease.frames[0].attempt,
        };
        self.client.put_artifacts(&PutArtifactsRequest {
            claim: Some(claim.clone()),
            artifacts: delivered.files.clone(),
        })?;
        self.client.commit(&CommitRequest {
            claim: Some(claim),
            record_json: serde_json::to_vec(&delivered.record).expect("JSON"),
        })
    }
}

/// Visits to one job, and the true records of the frames that were lies.
#[derive(Default)]
pub(super) struct Campaign {
    kinds: Vec<Lie>,
    told: BTreeSet<Lie>,
    lies: usize,
    truths: BTreeMap<u64, FrameRecord>,
}

impl Campaign {
    /// A campaign of these lies, in turn.
    pub(super) fn with_lies(kinds: &[Lie]) -> Self {
        Self {
            kinds: kinds.to_vec(),
            ..Self::default()
        }
    }

    /// Delivers up to `length` frames and leaves. Returns the number of delivered frames.
    pub(super) fn visit(
        &mut self,
        url: &str,
        identity: &Identity,
        length: usize,
        is_lie: fn(usize) -> bool,
    ) -> usize {
        let Ok(mut visitor) = Visitor::register(url, identity) else {
            return 0;
        };
        for place in 0..length {
            let Some(lease) = visitor.lease(1000) else {
                return place;
            };
            let truth = visitor.render(&lease);
            let mut delivered = truth.clone();
            let lie = is_lie(place).then(|| self.kinds[self.lies % self.kinds.len()]);
            if let Some(lie) = lie {
                lie.apply(&mut delivered);
            }
            if visitor.deliver(&lease, &delivered).is_err() {
                return place;
            }
            if let Some(lie) = lie {
                self.lies += 1;
                self.told.insert(lie);
                self.truths.insert(truth.record.frame, truth.record);
            }
        }
        length
    }

    pub(super) fn lies(&self) -> usize {
        self.lies
    }

    pub(super) fn has_every_lie(&self) -> bool {
        self.told.len() == Lie::ALL.len()
    }

    /// Frames that were lies, with their true records.
    pub(super) fn truths(&self) -> impl Iterator<Item = (&u64, &FrameRecord)> {
        self.truths.iter()
    }
}
