//! The lease table and everything that moves it: the clock, the tokens, the workers that wait.
//!
//! The table itself is a pure state machine. It is held for microseconds at a time and never across an await.

use std::collections::{HashMap, HashSet};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use crate::leases::table::{Beat, JobEntry, LeaseTable, Stale, StrikeEvent};
use proto::message::{Claim, Register};
use tokio::sync::Notify;
use tokio::time::{Instant, timeout_at};
use uuid::Uuid;

use crate::clock::Clock;
use crate::leases::granted::Granted;
use crate::leases::routes::workers::Worker;
use crate::telemetry;

/// A waiting worker looks again after this time: frames become free when a pause after a failure ends, which rings
/// no bell.
const LOOK_AGAIN: Duration = Duration::from_millis(250);

struct State {
    table: LeaseTable,
    about: HashMap<String, Register>,
    /// When open jobs were submitted, Unix milliseconds.
    submitted: HashMap<String, u64>,
}

/// The lease table behind a lock.
pub(crate) struct Dispatch {
    state: Mutex<State>,
    work: Notify,
    next_token: AtomicU64,
    clock: Clock,
}

impl Dispatch {
    /// An empty table. `first_token` must be larger than every token of an earlier life of the service.
    pub(crate) fn new(clock: Clock, first_token: u64) -> Self {
        let state = State {
            table: LeaseTable::new(),
            about: HashMap::new(),
            submitted: HashMap::new(),
        };
        Self {
            state: Mutex::new(state),
            work: Notify::new(),
            next_token: AtomicU64::new(first_token),
            clock,
        }
    }

    /// Offers a job's open frames to workers. `submitted_ms`: when it was submitted, since 1970.
    pub(crate) fn add_job(&self, entry: JobEntry, submitted_ms: u64) {
        let mut state = self.state();
        state.submitted.insert(entry.id.clone(), submitted_ms);
        state.table.add_job(entry);
        drop(state);
        self.work.notify_waiters();
    }

    /// Offers nothing more of a job; beats tell its workers.
    pub(crate) fn cancel(&self, job: &str) {
        self.state().table.cancel(job);
    }

    /// Offers nothing of a job for now; leases that are out go on.
    pub(crate) fn pause(&self, job: &str) {
        self.state().table.pause(job);
    }

    /// Offers a paused job again.
    pub(crate) fn resume(&self, job: &str) {
        self.state().table.resume(job);
        self.work.notify_waiters();
    }

    /// Offers frames again that were given up; answers whether the table knows the job.
    pub(crate) fn retry(&self, job: &str, frames: &[u64]) -> bool {
        let known = self.state().table.retry(job, frames);
        self.work.notify_waiters();
        known
    }

    /// Takes a worker on and answers its id.
    pub(crate) fn register(&self, about: Register) -> String {
        let id = format!("wrk_{}", Uuid::now_v7().simple());
        let mut state = self.state();
        state
            .table
            .register(&id, &about.name, about.slots, self.clock.now());
        state.about.insert(id.clone(), about);
        id
    }

    /// Waits for frames to render. `None`: none came in time. `Err`: the worker is not registered.
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
                if !state.about.contains_key(worker) {
                    return Err(Unknown);
                }
                let token = self.next_token.fetch_add(1, Ordering::Relaxed);
                if let Some(grant) = state.table.grant(worker, self.clock.now(), token, frame_ms) {
                    telemetry::granted(grant.frames.len());
                    return Ok(Some(Granted::new(self, grant)));
                }
            }
            let now = Instant::now();
            if now >= deadline {
                return Ok(None);
            }
            // Woken or not: the table decides.
            let _ = timeout_at(deadline.min(now + LOOK_AGAIN), bell).await;
        }
    }

    /// Prolongs a worker's leases.
    pub(crate) fn beat(&self, worker: &str, tokens: &[u64]) -> Result<Beat, Unknown> {
        let mut state = self.state();
        if !state.about.contains_key(worker) {
            return Err(Unknown);
        }
        Ok(state.table.beat(worker, tokens, self.clock.now()))
    }

    /// Whether the claim is current.
    pub(crate) fn check(&self, claim: &Claim) -> Result<(), Stale> {
        self.state()
            .table
            .check(&claim.job_id, claim.frame, claim.token, claim.attempt)
    }

    /// Holds the frame for the writer: it does not expire until the commit is finished or aborted.
    pub(crate) fn begin_commit(&self, claim: &Claim) -> Result<(), Stale> {
        let now = self.clock.now();
        self.state()
            .table
            .begin_commit(&claim.job_id, claim.frame, claim.token, claim.attempt, now)
    }

    pub(crate) fn finish_commit(&self, claim: &Claim) {
        self.state().table.finish_commit(&claim.job_id, claim.frame);
    }

    pub(crate) fn abort_commit(&self, claim: &Claim) {
        self.state().table.abort_commit(&claim.job_id, claim.frame);
        self.work.notify_waiters();
    }

    /// Counts a failed attempt.
    pub(crate) fn fail(&self, claim: &Claim, retryable: bool, error: &str) -> Result<StrikeEvent, Stale> {
        let now = self.clock.now();
        self.state().table.fail(
            &claim.job_id,
            claim.frame,
            claim.token,
            claim.attempt,
            retryable,
            error,
            now,
        )
    }

    /// Takes a lease back without burning an attempt.
    pub(crate) fn release(&self, token: u64) {
        self.state().table.release(token, self.clock.now());
        self.work.notify_waiters();
    }

    /// Takes back the leases that have ended.
    pub(crate) fn expire(&self) -> Vec<StrikeEvent> {
        let mut state = self.state();
        let now = self.clock.now();
        telemetry::expired(state.table.ended(now));
        let events = state.table.expire(now);
        drop(state);
        self.after_loss(events)
    }

    /// Takes back all leases of the workers of this name, at once: their process has ended. Answers also whether one was
    /// registered.
    pub(crate) fn drop_workers_named(&self, name: &str) -> (bool, Vec<StrikeEvent>) {
        let mut state = self.state();
        let ids: Vec<_> = state
            .about
            .iter()
            .filter(|(_, about)| about.name == name)
            .map(|(id, _)| id.clone())
            .collect();
        let registered = !ids.is_empty();
        let mut events = Vec::new();
        for id in ids {
            state.about.remove(&id);
            events.append(&mut state.table.drop_worker(&id, self.clock.now()));
        }
        drop(state);
        (registered, self.after_loss(events))
    }

    /// Whether a registered worker has the runtime of the style models.
    pub(crate) fn has_style_runtime(&self) -> bool {
        self.state()
            .about
            .values()
            .any(|about| about.onnx_runtime.is_some())
    }

    /// The registered workers.
    pub(crate) fn workers(&self) -> Vec<Worker> {
        let state = self.state();
        let now = self.clock.now().0;
        let view = |row: crate::leases::table::WorkerRow| {
            let about = state.about.get(&row.id)?.clone();
            Some(Worker {
                id: row.id,
                name: about.name,
                slots: about.slots,
                leased_frames: row.leased_frames,
                silent_ms: now.saturating_sub(row.last_seen.0),
                code_version: about.code_version,
                onnx_runtime: about.onnx_runtime,
                cpu_features: about.cpu_features,
            })
        };
        state.table.workers().into_iter().filter_map(view).collect()
    }

    /// Forgets workers that the table has forgotten.
    pub(crate) fn forget_workers(&self) {
        let mut state = self.state();
        let known: HashSet<String> = state.table.workers().into_iter().map(|row| row.id).collect();
        state.about.retain(|id, _| known.contains(id));
    }

    /// Updates the gauges.
    pub(crate) fn measure(&self) {
        let mut state = self.state();
        let totals = state.table.totals();
        let State { table, submitted, .. } = &mut *state;
        submitted.retain(|job, _| table.has_job(job));
        let oldest = submitted.values().min().copied();
        drop(state);
        let now = self.clock.unix_ms();
        let age_ms = oldest.map_or(0, |submitted| now.saturating_sub(submitted));
        telemetry::queue(totals.queued, totals.leased, age_ms);
    }

    fn after_loss(&self, events: Vec<StrikeEvent>) -> Vec<StrikeEvent> {
        telemetry::strikes(events.len());
        self.work.notify_waiters();
        events
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The worker is not registered with this life of the service.
pub(crate) struct Unknown;

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;

    /// A dispatch with a job of one frame, the worker's id, and the hand of the clock.
    fn one_frame() -> (Dispatch, String, Arc<AtomicU64>) {
        let hand = Arc::new(AtomicU64::new(0));
        let read = Arc::clone(&hand);
        let clock = Clock::from_functions(move || read.load(Ordering::SeqCst), || 0);
        let dispatch = Dispatch::new(clock, 1);
        dispatch.add_job(
            JobEntry {
                id: "job_a".to_owned(),
                frames: 1,
                ..JobEntry::default()
            },
            0,
        );
        let worker = dispatch.register(about());
        (dispatch, worker, hand)
    }

    fn about() -> Register {
        Register {
            name: "local-1".to_owned(),
            slots: 1,
            code_version: String::new(),
            onnx_runtime: None,
            cpu_features: String::new(),
        }
    }

    async fn token(dispatch: &Dispatch, worker: &str) -> Option<u64> {
        let granted = dispatch.lease(worker, Duration::ZERO, 0.0).await;
        granted.ok().flatten().map(|granted| granted.hand_over().token)
    }

    #[tokio::test]
    async fn a_lease_that_nobody_received_is_free_again_without_a_strike() {
        let (dispatch, worker, _) = one_frame();
        drop(
            dispatch
                .lease(&worker, Duration::ZERO, 0.0)
                .await
                .ok()
                .flatten()
                .unwrap(),
        );
        let granted = dispatch
            .lease(&worker, Duration::ZERO, 0.0)
            .await
            .ok()
            .flatten()
            .unwrap();
        assert_eq!(granted.lease().frames, [(0, 1)]);
    }

    #[tokio::test]
    async fn a_silent_workers_frame_comes_back_after_its_term_under_a_larger_token() {
        let (dispatch, worker, hand) = one_frame();
        let first = token(&dispatch, &worker).await.unwrap();
        hand.store(u64::from(crate::leases::table::TERM_MS) - 1, Ordering::SeqCst);
        assert!(dispatch.expire().is_empty());
        assert_eq!(token(&dispatch, &worker).await, None);
        hand.store(u64::from(crate::leases::table::TERM_MS), Ordering::SeqCst);
        assert_eq!(dispatch.expire().len(), 1);
        hand.store(60_000, Ordering::SeqCst);
        assert!(token(&dispatch, &worker).await.unwrap() > first);
    }

    #[tokio::test]
    async fn a_dead_childs_frame_comes_back_at_once_and_its_id_is_forgotten() {
        let (dispatch, worker, hand) = one_frame();
        token(&dispatch, &worker).await.unwrap();
        let (registered, events) = dispatch.drop_workers_named("remote");
        assert!(!registered && events.is_empty());
        let (registered, events) = dispatch.drop_workers_named("local-1");
        assert!(registered && events.len() == 1);
        assert!(dispatch.lease(&worker, Duration::ZERO, 0.0).await.is_err());
        assert!(dispatch.workers().is_empty());
        hand.store(1_000, Ordering::SeqCst);
        let next = dispatch.register(about());
        assert!(token(&dispatch, &next).await.is_some());
    }

    #[tokio::test(start_paused = true)]
    async fn a_waiting_worker_is_woken_by_a_new_job() {
        let (dispatch, worker, _) = one_frame();
        token(&dispatch, &worker).await.unwrap();
        let dispatch = Arc::new(dispatch);
        let waiting = {
            let (dispatch, worker) = (Arc::clone(&dispatch), worker.clone());
            tokio::spawn(async move {
                let granted = dispatch.lease(&worker, Duration::from_secs(60), 0.0).await;
                granted.ok().flatten().map(|granted| granted.hand_over().job_id)
            })
        };
        tokio::task::yield_now().await;
        let begun = Instant::now();
        dispatch.add_job(
            JobEntry {
                id: "job_b".to_owned(),
                frames: 1,
                ..JobEntry::default()
            },
            0,
        );
        assert_eq!(waiting.await.unwrap().as_deref(), Some("job_b"));
        assert_eq!(begun.elapsed(), Duration::ZERO);
    }
}
