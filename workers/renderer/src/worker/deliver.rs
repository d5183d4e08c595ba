//! The delivering thread of a slot: hands in what the other thread has finished, in order.

use std::collections::BTreeMap;
use std::sync::mpsc::Receiver;

use super::client::ClientError;
use proto::limits::shorten;
use proto::message::{Artifact, Claim, Commit, Fail, PutArtifacts};
use proto::wire;

use super::Shared;
use super::held::Hold;
use super::patience::{Answered, persist};
use super::slot::Refusal;
use crate::record::Rendered;

/// What comes from the rendering thread.
pub(crate) enum Parcel {
    /// A frame, rendered or not.
    Frame {
        claim: Claim,
        outcome: Box<Result<Rendered, Refusal>>,
        hold: Hold,
    },
    /// Nothing more of this lease. `finished`: all its frames came.
    End { hold: Hold, finished: bool },
}

/// Delivers until the rendering thread has ended.
pub(crate) fn run(shared: &Shared, parcels: &Receiver<Parcel>) {
    let mut all_arrived = true;
    for parcel in parcels {
        match parcel {
            Parcel::Frame { claim, outcome, hold } => {
                all_arrived &= frame(shared, claim, *outcome, &hold);
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

/// Hands in one frame; returns whether the service has taken note of it.
fn frame(shared: &Shared, claim: Claim, outcome: Result<Rendered, Refusal>, hold: &Hold) -> bool {
    if hold.is_lost() {
        return true;
    }
    let told = match outcome {
        Ok(rendered) => image(shared, &claim, rendered, hold),
        Err(refusal) => failure(shared, &claim, refusal, hold),
    };
    match told {
        Ok(()) => true,
        Err(error) => {
            let Claim { job_id, frame, .. } = &claim;
            tracing::warn!(job = job_id, frame, %error, "a frame could not be handed in");
            false
        }
    }
}

/// Files first, then the record that names them.
fn image(shared: &Shared, claim: &Claim, rendered: Rendered, hold: &Hold) -> Result<(), ClientError> {
    let Rendered { files, record } = rendered;
    let artifacts = files.into_iter().map(|file| Artifact {
        kind: file.kind,
        media_type: file.media_type.to_owned(),
        data: file.bytes,
        digest: file.digest,
    });
    let timings_ms = record.timings_ms.clone();
    let files = PutArtifacts {
        claim: claim.clone(),
        artifacts: artifacts.collect(),
    };
    let files = wire::PutArtifactsRequest::from(files);
    let commit = wire::CommitRequest::from(Commit {
        claim: claim.clone(),
        record,
    });
    faults::point("worker.rendered");
    let stored = insist(shared, hold, || shared.service.put(&files)).and_then(|()| {
        faults::point("worker.stored");
        insist(shared, hold, || shared.service.commit(&commit).map(drop))
    });
    faults::point("worker.committed");
    match stored {
        // It would refuse the same bytes again and again, and the frame would circle for ever.
        Err(ClientError::Refused { status, problem }) => {
            let error = format!("the service refused the image ({status}): {problem}");
            report(
                shared,
                claim,
                Refusal {
                    error,
                    retryable: false,
                },
                timings_ms,
                hold,
            )
        }
        stored => stored,
    }
}

fn failure(shared: &Shared, claim: &Claim, refusal: Refusal, hold: &Hold) -> Result<(), ClientError> {
    let Refusal { error, retryable } = &refusal;
    tracing::warn!(
        job = claim.job_id,
        frame = claim.frame,
        error,
        retryable,
        "a frame failed"
    );
    report(shared, claim, refusal, BTreeMap::new(), hold)
}

fn report(
    shared: &Shared,
    claim: &Claim,
    refusal: Refusal,
    timings_ms: BTreeMap<String, f64>,
    hold: &Hold,
) -> Result<(), ClientError> {
    let Refusal { error, retryable } = refusal;
    let fail = Fail {
        claim: claim.clone(),
        error: shorten(&error),
        retryable,
        timings_ms,
    };
    let fail = wire::FailRequest::from(fail);
    insist(shared, hold, || shared.service.fail(&fail))
}

/// Repeats a call while the lease lasts. A stale lease is dropped; after a repeated call it may also mean that the first
/// one arrived, so that is left for the beat to find out.
fn insist(
    shared: &Shared,
    hold: &Hold,
    call: impl Fn() -> Result<(), ClientError>,
) -> Result<(), ClientError> {
    let Answered { result, repeated } = persist(&shared.stop, || !hold.is_lost(), call);
    match result {
        Err(ClientError::Stale) if repeated => Ok(()),
        Err(ClientError::Stale) => {
            hold.lose();
            Ok(())
        }
        result => result,
    }
}

fn hand_back(shared: &Shared, hold: &Hold) {
    let reason = "the worker is stopping, or could not hand in a frame";
    let release = || shared.service.release(hold.token, reason);
    if let Err(error) = persist(&shared.stop, || !hold.is_lost(), release).result {
        tracing::warn!(token = hold.token, %error, "cannot hand a lease back; it will run out");
    }
}
