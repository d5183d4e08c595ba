//! The delivery thread of a slot: submits finished frames in order.

use std::collections::BTreeMap;
use std::sync::mpsc::Receiver;

use wire::limits::shorten;
use wire::messages::{Artifact, Claim, CommitRequest, FailRequest, PutArtifactsRequest};

use super::client::{ClientError, Outcome};
use super::held::Hold;
use super::patience::persist;
use super::shared::Shared;
use crate::error::RenderError;
use crate::file::File;
use crate::slot::Rendered;

pub(crate) enum Parcel {
    /// A frame, rendered or not.
    Frame {
        claim: Claim,
        outcome: Box<Result<Rendered, Refusal>>,
        hold: Hold,
    },
    /// The end of this lease. `finished`: all its frames were sent.
    End { hold: Hold, finished: bool },
}

/// The reported reason for a frame without an image.
#[derive(Clone)]
pub(crate) struct Refusal {
    error: String,
    retryable: bool,
}

impl From<RenderError> for Refusal {
    fn from(error: RenderError) -> Self {
        Self {
            error: error.to_string(),
            retryable: error.retryable(),
        }
    }
}

/// Delivers until the rendering thread has ended.
pub(crate) fn run(shared: &Shared, parcels: &Receiver<Parcel>) {
    let mut all_arrived = true;
    for parcel in parcels {
        match parcel {
            Parcel::Frame { claim, outcome, hold } => {
                all_arrived &= hold.is_lost() || deliver(shared, claim, *outcome, &hold);
            }
            Parcel::End { hold, finished } => {
                let complete = finished && all_arrived;
                if !complete && !hold.is_lost() {
                    hand_back(shared, &hold);
                }
                shared.held.end(hold.token);
                all_arrived = true;
            }
        }
    }
}

/// Submits one frame; returns whether the service has recorded it.
fn deliver(shared: &Shared, claim: Claim, outcome: Result<Rendered, Refusal>, hold: &Hold) -> bool {
    let (job, frame) = (&claim.job_id, claim.frame);
    let delivered = match outcome {
        Ok(rendered) => hand_in(shared, &claim, rendered, hold),
        Err(refusal) => {
            let Refusal { error, retryable } = &refusal;
            tracing::warn!(job, frame, error, retryable, "a frame failed");
            report(shared, &claim, refusal, BTreeMap::new(), hold)
        }
    };
    if let Err(error) = &delivered {
        tracing::warn!(job, frame, %error, "a frame could not be handed in");
    }
    delivered.is_ok()
}

/// Submits the files, then the record that lists them.
fn hand_in(shared: &Shared, claim: &Claim, rendered: Rendered, hold: &Hold) -> Outcome<()> {
    let Rendered { files, mut record } = rendered;
    if faults::frame_point("record.wrong", record.frame) {
        record.parameters["seed"] = serde_json::Value::Null;
    }
    let files = PutArtifactsRequest {
        claim: Some(claim.clone()),
        artifacts: files.into_iter().map(artifact).collect(),
    };
    let commit = CommitRequest {
        claim: Some(claim.clone()),
        record_json: serde_json::to_vec(&record).expect("maps with string keys and numbers always serialize"),
    };
    faults::point("worker.rendered");
    let stored = insist(shared, hold, || shared.client.put_artifacts(&files)).and_then(|()| {
        faults::point("worker.stored");
        insist(shared, hold, || shared.client.commit(&commit).map(drop))
    });
    faults::point("worker.committed");
    match stored {
        // The service would refuse the same bytes again, and the frame would be retried forever.
        Err(ClientError::Refused { status, problem }) => {
            let refusal = Refusal {
                error: format!("the service refused the image ({status}): {problem}"),
                retryable: false,
            };
            report(shared, claim, refusal, record.timings_ms, hold)
        }
        stored => stored,
    }
}

fn artifact(file: File) -> Artifact {
    Artifact {
        kind: file.kind,
        media_type: file.media_type.to_owned(),
        data: file.bytes,
        digest: file.digest,
    }
}

fn report(
    shared: &Shared,
    claim: &Claim,
    refusal: Refusal,
    timings_ms: BTreeMap<String, f64>,
    hold: &Hold,
) -> Outcome<()> {
    let fail = FailRequest {
        claim: Some(claim.clone()),
        error: shorten(&refusal.error),
        retryable: refusal.retryable,
        timings_ms,
    };
    insist(shared, hold, || shared.client.fail(&fail))
}

/// Repeats a call while the lease lasts. A stale lease is dropped. After a repeated call it may also mean that the first call
/// arrived, which the next heartbeat resolves.
fn insist(shared: &Shared, hold: &Hold, call: impl Fn() -> Outcome<()>) -> Outcome<()> {
    let persisted = persist(&shared.stop, || !hold.is_lost(), call);
    match persisted.result {
        Err(ClientError::Stale) => {
            if !persisted.repeated {
                hold.lose();
            }
            Ok(())
        }
        result => result,
    }
}

fn hand_back(shared: &Shared, hold: &Hold) {
    let reason = "the worker is stopping, or could not hand in a frame";
    let release = || shared.client.release(hold.token, reason);
    if let Err(error) = persist(&shared.stop, || !hold.is_lost(), release).result {
        tracing::warn!(token = hold.token, %error, "cannot hand a lease back; it will run out");
    }
}
