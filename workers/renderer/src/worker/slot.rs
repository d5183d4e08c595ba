//! The rendering thread of a slot.

use std::sync::Arc;
use std::sync::mpsc::SyncSender;
use std::time::{Duration, Instant};

use super::client::ClientError;
use proto::message::{Claim, Lease};
use spec::{Job, Scene};

use super::Shared;
use super::deliver::Parcel;
use super::held::Hold;
use super::patience::pause_after;
use crate::attempt::attempt;
use crate::error::RenderError;
use crate::record::Rendered;
use crate::slot::Slot;
use crate::source::SceneSource;

/// After a refusal, which repeats itself until somebody changes something.
const AFTER_REFUSAL: Duration = Duration::from_secs(10);
/// Share of the newest frame in the running mean of what a frame costs.
const NEWEST: f64 = 0.3;

/// Leases and renders until the worker is to stop.
pub(crate) fn run(shared: &Shared, number: usize, parcels: &SyncSender<Parcel>) {
    let mut slot = Slot::new(&shared.engine);
    let mut frame_ms = 0.0;
    let mut tries = 0;
    while !shared.stop.is_set() {
        let worker_id = shared.service.worker_id();
        let answer = match shared.service.lease(&worker_id, frame_ms) {
            Err(ClientError::UnknownWorker) => shared.service.rejoin(&worker_id).map(|()| None),
            answer => answer,
        };
        match answer {
            Ok(lease) => {
                tries = 0;
                let Some(lease) = lease else { continue };
                if work(shared, (number, &mut slot), &lease, &mut frame_ms, parcels).is_err() {
                    return;
                }
            }
            Err(ClientError::Unavailable { reason }) => {
                if tries == 0 {
                    tracing::warn!(reason, "waiting for the service");
                }
                tries += 1;
                shared.stop.pause(pause_after(tries));
            }
            Err(error) => {
                tracing::error!(%error, "the service gives no lease");
                shared.stop.pause(AFTER_REFUSAL);
            }
        }
    }
}

/// The delivering thread is gone.
struct Gone;

/// Renders the frames of a lease until they are done, the lease is lost, or the worker is to stop.
fn work(
    shared: &Shared,
    (number, slot): (usize, &mut Slot),
    lease: &Lease,
    frame_ms: &mut f64,
    parcels: &SyncSender<Parcel>,
) -> Result<(), Gone> {
    let hold = shared.held.take(lease.token);
    faults::point("worker.leased");
    let job = shared.jobs.get(shared, &hold, lease);
    let mut finished = true;
    for &(frame, attempt) in &lease.frames {
        if shared.stop.is_set() || hold.is_lost() {
            finished = false;
            break;
        }
        let begun = Instant::now();
        shared.running.begin(number, &lease.job_id, frame);
        let outcome = match &job {
            Ok(job) => render(shared, slot, job, frame, &hold).map_err(Refusal::from),
            Err(refusal) => Err(refusal.clone()),
        };
        shared.running.end(number);
        *frame_ms = mean(*frame_ms, begun.elapsed().as_secs_f64() * 1000.0);
        let claim = Claim {
            token: lease.token,
            job_id: lease.job_id.clone(),
            frame,
            attempt,
        };
        parcels
            .send(Parcel::Frame {
                claim,
                outcome: Box::new(outcome),
                hold: hold.clone(),
            })
            .map_err(|_| Gone)?;
    }
    parcels.send(Parcel::End { hold, finished }).map_err(|_| Gone)
}

/// Why a frame has no image, as the service is told.
#[derive(Clone)]
pub(crate) struct Refusal {
    pub(crate) error: String,
    pub(crate) retryable: bool,
}

impl From<RenderError> for Refusal {
    fn from(error: RenderError) -> Self {
        Self {
            error: error.to_string(),
            retryable: error.retryable(),
        }
    }
}

fn render(
    shared: &Shared,
    slot: &mut Slot,
    job: &Arc<Job>,
    frame: u64,
    hold: &Hold,
) -> Result<Rendered, RenderError> {
    let frame = job.resolve(frame).map_err(RenderError::Resolve)?;
    let source = match &frame.scene {
        Scene::Uploaded { id } => SceneSource::Uploaded(shared.scenes.get(shared, hold, id)?),
        Scene::Procedural { .. } | Scene::Files { .. } => SceneSource::Local,
    };
    attempt(slot, &shared.engine, &frame, &source)
}

fn mean(running: f64, newest: f64) -> f64 {
    if running == 0.0 {
        newest
    } else {
        running + NEWEST * (newest - running)
    }
}
