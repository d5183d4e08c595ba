//! The lease table with its clock, tokens and waiting workers.
//!
//! The table itself is a pure state machine. Its lock is held for microseconds and never across an await.

mod reject;
mod report;

use std::collections::{BTreeSet, HashMap};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use catalogue::{JobState, OpenJob, UnixMs};
use tokio::sync::Notify;
use tokio::time::{Instant, timeout_at};
use wire::messages::{BeatResponse, FrameClaim, Lease, RegisterRequest};

use super::costs::count_price;
use super::misbehavior::Misbehavior;
use super::table::{JobEntry, LeaseTable, Millis, Rules, StrikeEvent, Toolchain};
use crate::clock::{Clock, ordered_id};
use crate::leases::table::{Grant, TERM_MS};
use crate::limits;
use crate::telemetry;

/// Interval at which a waiting worker checks again: frames become available without a notification when their pause
/// after a failure ends.
const LOOK_AGAIN: Duration = Duration::from_millis(250);

pub(super) struct State {
    pub(super) table: LeaseTable,
    open: HashMap<String, Open>,
    pub(super) misbehavior: Misbehavior,
    /// Ids of the workers started by the service.
    own: BTreeSet<String>,
}

/// An open job, except its frames.
struct Open {
    submitted_at: UnixMs,
    spec_digest: String,
}

/// The lease table behind a lock.
pub(crate) struct Dispatch {
    state: Mutex<State>,
    work: Notify,
    /// Notified when leases are cancelled.
    cancelled: Notify,
    next_token: AtomicU64,
    clock: Clock,
}

impl Dispatch {
    pub(crate) fn new(clock: Clock, rules: Rules) -> Self {
        let state = State {
            table: LeaseTable::with_rules(rules),
            open: HashMap::new(),
            misbehavior: Misbehavior::default(),
            own: BTreeSet::new(),
        };
        // Tokens only increase, also over restarts: the high half of a UUIDv7 is the time in milliseconds and a
        // random part.
        let first_token = ordered_id().as_u64_pair().0;
        Self {
            state: Mutex::new(state),
            work: Notify::new(),
            cancelled: Notify::new(),
            next_token: AtomicU64::new(first_token),
            clock,
        }
    }

    /// Offers a job's open frames to workers.
    pub(crate) fn add_job(&self, job: OpenJob) {
        self.add_job_with_priority(job, limits::JOB_PRIORITY);
    }

    /// Offers a job's open frames with a priority among the jobs of its caller.
    pub(crate) fn add_job_with_priority(&self, job: OpenJob, priority: i32) {
        let OpenJob {
            row,
            done,
            failed,
            strikes,
            provenance,
        } = job;
        let open = Open {
            submitted_at: row.created_at,
            spec_digest: row.spec_digest,
        };
        let mut state = self.state();
        state.open.insert(row.id.clone(), open);
        let cost = row.price.as_ref().map(count_price).unwrap_or_default();
        state.table.add_job(JobEntry {
            id: row.id,
            caller: row.owner.unwrap_or_default(),
            frames: row.frames,
            frame_cost: cost.divided(row.frames),
            priority,
            done,
            failed,
            strikes,
            paused: row.state == JobState::Paused,
            made: provenance.as_ref().map(Toolchain::from_provenance),
            mixed: row.mixed,
        });
        drop(state);
        self.work.notify_waiters();
    }

    /// Reads or changes the table without freeing a frame.
    pub(crate) fn table<T>(&self, work: impl FnOnce(&mut LeaseTable, Millis) -> T) -> T {
        work(&mut self.state().table, self.now())
    }

    /// Changes the table in a way that may free frames, and wakes waiting workers.
    pub(crate) fn free<T>(&self, work: impl FnOnce(&mut LeaseTable, Millis) -> T) -> T {
        let freed = self.table(work);
        self.work.notify_waiters();
        freed
    }

    /// Registers a worker and returns its id; `None` if a worker of this name was dismissed.
    pub(crate) fn register(&self, about: RegisterRequest, is_own: bool) -> Option<String> {
        let mut state = self.state();
        if state.misbehavior.is_dismissed(&about.name) {
            return None;
        }
        let id = format!("wrk_{}", ordered_id().simple());
        if is_own {
            state.own.insert(id.clone());
        }
        state.table.register(&id, about, self.now());
        Some(id)
    }

    /// Waits for frames to render. `None`: none in time. `Err`: the worker is not registered.
    pub(crate) async fn lease(
        &self,
        worker: &str,
        wait: Duration,
        frame_ms: f64,
    ) -> Result<Option<Granted<'_>>, Unknown> {
        let deadline = Instant::now() + wait;
        loop {
            let mut bell = std::pin::pin!(self.work.notified());
            bell.as_mut().enable();
            {
                let mut state = self.state();
                if !state.table.has_worker(worker) {
                    return Err(Unknown);
                }
                let token = self.next_token.fetch_add(1, Ordering::Relaxed);
                if let Some(grant) = state.table.grant(worker, self.now(), token, frame_ms) {
                    telemetry::granted(grant.frames.len());
                    let open = state.open.get(&grant.job_id);
                    let spec_digest = open.map(|open| open.spec_digest.clone()).unwrap_or_default();
                    return Ok(Some(Granted::new(self, grant, spec_digest)));
                }
            }
            let now = Instant::now();
            if now >= deadline {
                return Ok(None);
            }
            // The next look at the table decides, woken or not.
            let _ = timeout_at(deadline.min(now + LOOK_AGAIN), bell).await;
        }
    }

    /// Cancels the leases of a job and notifies their workers.
    pub(crate) fn cancel(&self, job: &str) {
        self.table(|table, _| table.cancel(job));
        self.cancelled.notify_waiters();
    }

    /// Extends a worker's leases. If none is cancelled, waits until one is.
    pub(crate) async fn beat(
        &self,
        worker: &str,
        tokens: &[u64],
        wait: Duration,
    ) -> Result<BeatResponse, Unknown> {
        let deadline = Instant::now() + wait;
        let mut named = tokens;
        loop {
            let mut bell = std::pin::pin!(self.cancelled.notified());
            bell.as_mut().enable();
            let beat = {
                let mut state = self.state();
                if !state.table.has_worker(worker) {
                    return Err(Unknown);
                }
                state.table.beat(worker, named, self.now())
            };
            let is_news = !(beat.cancelled.is_empty() && beat.lost.is_empty());
            if is_news || timeout_at(deadline, bell).await.is_err() {
                return Ok(beat);
            }
            // They were extended when the heartbeat arrived.
            named = &[];
        }
    }

    /// Takes back expired leases.
    pub(crate) fn expire(&self) -> Vec<StrikeEvent> {
        let mut state = self.state();
        let now = self.now();
        telemetry::expired(state.table.ended(now));
        let stalled = state.table.stalled(now);
        let mut events = state.table.expire(now);
        for worker in stalled {
            events.extend(state.blame(&worker, "it holds frames without committing any", now));
        }
        let State {
            table,
            misbehavior,
            own,
            ..
        } = &mut *state;
        misbehavior.retain_registered(|id| table.has_worker(id));
        own.retain(|id| table.has_worker(id));
        drop(state);
        self.after_loss(events)
    }

    /// Takes back all leases of the workers of this name immediately, because their process has ended. Also returns
    /// whether one was registered.
    pub(crate) fn drop_workers_named(&self, name: &str) -> (bool, Vec<StrikeEvent>) {
        let mut state = self.state();
        let workers = state.table.workers();
        let named = workers.filter(|(_, about, _)| about.name == name);
        let ids: Vec<String> = named.map(|(id, ..)| id.to_owned()).collect();
        let registered = !ids.is_empty();
        let mut events = Vec::new();
        for id in ids {
            events.append(&mut state.table.drop_worker(&id, self.now()));
        }
        drop(state);
        (registered, self.after_loss(events))
    }

    pub(super) fn after_loss(&self, events: Vec<StrikeEvent>) -> Vec<StrikeEvent> {
        telemetry::strikes(events.len());
        self.work.notify_waiters();
        events
    }

    pub(super) fn now(&self) -> Millis {
        Millis(self.clock.monotonic_ms())
    }

    pub(super) fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl State {
    /// Counts a fault of a worker. After a few it is dismissed with all its leases.
    pub(super) fn blame(&mut self, id: &str, why: &str, now: Millis) -> Vec<StrikeEvent> {
        let name = self.table.workers().find(|(known, ..)| *known == id);
        let Some(name) = name.map(|(_, about, _)| about.name.clone()) else {
            return Vec::new();
        };
        let is_own = self.own.contains(id);
        if !self.misbehavior.count_rejection(id, &name, is_own) {
            return Vec::new();
        }
        tracing::error!(worker = name, why, "worker dismissed");
        self.table.drop_worker(id, now)
    }
}

impl Dispatch {
    /// Dismisses a worker that committed a wrong frame.
    pub(crate) fn dismiss(&self, id: &str) {
        let mut state = self.state();
        let now = self.now();
        let known = state.table.workers().find(|(known, ..)| *known == id);
        let Some(name) = known.map(|(_, about, _)| about.name.clone()) else {
            return;
        };
        let is_own = state.own.contains(id);
        state.misbehavior.dismiss(id, &name, is_own);
        tracing::error!(worker = name, "worker dismissed for a wrong frame");
        state.table.dismiss(id, now);
        drop(state);
        self.work.notify_waiters();
    }
}

/// The worker is not registered since the service started.
pub(crate) struct Unknown;

/// A granted lease. If the worker disconnects before it is sent, the frames become free immediately, without a
/// strike.
pub(crate) struct Granted<'d> {
    pub(super) dispatch: &'d Dispatch,
    pub(super) lease: Option<Lease>,
}

impl<'d> Granted<'d> {
    pub(super) fn new(dispatch: &'d Dispatch, grant: Grant, spec_digest: String) -> Self {
        let Grant {
            token,
            job_id,
            frames,
        } = grant;
        let frames = frames.into_iter();
        let frames = frames.map(|(frame, attempt)| FrameClaim { frame, attempt });
        let lease = Some(Lease {
            token,
            job_id,
            spec_digest,
            frames: frames.collect(),
            term_ms: TERM_MS,
        });
        Self { dispatch, lease }
    }

    /// Releases the lease to the worker: from now on only the worker or its expiry ends it.
    pub(crate) fn hand_over(mut self) -> Lease {
        self.lease
            .take()
            .expect("only this method takes it, and it ends this value")
    }
}

impl Drop for Granted<'_> {
    fn drop(&mut self) {
        if let Some(lease) = &self.lease {
            let token = lease.token;
            self.dispatch.free(|table, now| table.release(token, now));
        }
    }
}

#[cfg(test)]
mod tests;
