//! The rendering thread of a slot.

use std::sync::mpsc::SyncSender;
use std::time::{Duration, Instant};

use imaging::cancel;
use spec::Job;
use wire::messages::{Claim, FrameClaim, Lease, LeaseRequest};

use super::client::{ClientError, Outcome};
use super::deliver::{Parcel, Refusal};
use super::held::Hold;
use super::patience::persist;
use super::shared::Shared;
use crate::error::RenderError;
use crate::slot::{Rendered, Slot};
use crate::source::SceneSource;

/// How long the service may hold a lease request. Short, so that a stop is not delayed.
const LEASE_WAIT_MS: u32 = 2000;
/// Pause after a refusal, which only a change to the service can lift.
const AFTER_REFUSAL: Duration = Duration::from_secs(10);
/// Weight of the newest frame in the moving average of the cost of a frame.
const NEWEST: f64 = 0.3;

/// Leases and renders frames until the worker stops.
pub(crate) fn run(shared: &Shared, number: usize, parcels: &SyncSender<Parcel>) {
    let mut slot = Slot::new(&shared.engine);
    let mut frame_ms = 0.0;
    let stop = &shared.stop;
    while !stop.is_set() {
        match persist(stop, || !stop.is_set(), || lease(shared, frame_ms)).result {
            Ok(Some(lease)) => {
                if work(shared, (number, &mut slot), &lease, &mut frame_ms, parcels).is_err() {
                    return;
                }
            }
            Ok(None) | Err(ClientError::Unavailable { .. }) => {}
            Err(error) => {
                tracing::error!(%error, "the service gives no lease");
                stop.pause(AFTER_REFUSAL);
            }
        }
    }
}

/// Requests a lease.
fn lease(shared: &Shared, frame_ms: f64) -> Outcome<Option<Lease>> {
    let worker_id = shared.membership.worker_id();
    let request = LeaseRequest {
        worker_id: worker_id.clone(),
        wait_ms: LEASE_WAIT_MS,
        frame_ms,
    };
    match shared.client.lease(&request) {
        Err(ClientError::UnknownWorker) => {
            shared.membership.rejoin(&shared.client, &worker_id)?;
            Ok(None)
        }
        leased => leased,
    }
}

/// The delivery thread has ended.
struct Gone;

/// Renders the frames of a lease until all are rendered, the lease is lost or the worker stops.
fn work(
    shared: &Shared,
    (number, slot): (usize, &mut Slot),
    lease: &Lease,
    frame_ms: &mut f64,
    parcels: &SyncSender<Parcel>,
) -> Result<(), Gone> {
    let hold = shared.held.take(lease.token);
    faults::point("worker.leased");
    let job = shared.jobs.get(shared, &hold, lease).map_err(Refusal::from);
    let mut finished = true;
    for &FrameClaim { frame, attempt } in &lease.frames {
        if shared.stop.is_set() || hold.is_lost() {
            finished = false;
            break;
        }
        let claim = Claim {
            token: lease.token,
            job_id: lease.job_id.clone(),
            frame,
            attempt,
        };
        let begun = Instant::now();
        shared.running.begin(number, &claim, &hold);
        let outcome = match &job {
            Ok(job) => render(shared, slot, job, frame, &hold).map_err(Refusal::from),
            Err(refusal) => Err(refusal.clone()),
        };
        shared.running.end(number);
        if hold.is_lost() {
            finished = false;
            break;
        }
        *frame_ms = mean(*frame_ms, begun.elapsed().as_secs_f64() * 1000.0);
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

fn render(
    shared: &Shared,
    slot: &mut Slot,
    job: &Job,
    frame: u64,
    hold: &Hold,
) -> Result<Rendered, RenderError> {
    let frame = job.resolve(frame).map_err(RenderError::Resolve)?;
    let source = match frame.scene.uploaded_id() {
        Some(id) => SceneSource::Uploaded(shared.scenes.get(shared, hold, id)?),
        None => SceneSource::Local,
    };
    cancel::watched(&hold.lost, || slot.attempt(&frame, &source))
}

fn mean(running: f64, newest: f64) -> f64 {
    if running == 0.0 {
        newest
    } else {
        running + NEWEST * (newest - running)
    }
}
