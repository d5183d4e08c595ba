//! Spot checks: frames rendered a second time by a process of the service and compared with a worker's commit. A
//! worker with a different frame is dismissed. Its frames lose their images and are rendered by others: for a worker of
//! the service those since its last good check, for another one all that were not checked themselves.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::time::Duration;

use catalogue::{CatalogueError, DueCheck};
use tokio_util::sync::CancellationToken;

use super::Jobs;
use super::verdict::Verdict;
use crate::leases::probes::Probe;
use crate::telemetry;

/// Interval of looking for frames to check.
const LOOK: Duration = Duration::from_millis(200);

/// Checks frames until the service stops.
pub(crate) async fn run(jobs: Arc<Jobs>, end: CancellationToken) {
    let work = async {
        loop {
            jobs.settle_ending().await;
            let own = jobs.leases.probes.next_batch();
            let outside = jobs.leases.proofs.next_batch();
            if own.is_empty() && outside.is_empty() {
                // Own probes and missed notifications wait for the interval.
                let _ = tokio::time::timeout(LOOK, jobs.leases.proofs.work.notified()).await;
                continue;
            }
            jobs.check_own(own).await;
            jobs.check_outside(outside).await;
        }
    };
    end.run_until_cancelled(work).await;
}

impl Jobs {
    /// Renders frames of a job again and compares them. Frames that were not rendered have no verdict.
    async fn judge_all(&self, job: &str, frames: &[u64]) -> BTreeMap<u64, Verdict> {
        let mut verdicts = BTreeMap::new();
        let mut stored = BTreeMap::new();
        for &frame in frames {
            match self.read_checkable(job, frame).await {
                Ok(record) => drop(stored.insert(frame, record)),
                Err(verdict) => drop(verdicts.insert(frame, verdict)),
            }
        }
        let frames: Vec<u64> = stored.keys().copied().collect();
        let again = match self.images.rerender_all(job, &frames).await {
            Ok(again) => again,
            Err(problem) => {
                let open = Verdict::Open(problem.to_string());
                verdicts.extend(frames.into_iter().map(|frame| (frame, open.clone())));
                return verdicts;
            }
        };
        for (frame, again) in again {
            let judged = match (again, stored.get(&frame)) {
                (Ok(again), Some(record)) => self.judge(job, record, again).await,
                (Err(problem), _) => Err(problem),
                (_, None) => continue,
            };
            let verdict = judged.unwrap_or_else(|problem| Verdict::Open(problem.to_string()));
            verdicts.insert(frame, verdict);
        }
        for (frame, verdict) in &verdicts {
            match verdict {
                Verdict::Good => telemetry::checked("good"),
                Verdict::Open(why) => {
                    telemetry::checked("open");
                    tracing::info!(job, frame, why, "a frame could not be checked");
                }
                Verdict::Differs(what) => {
                    telemetry::checked("differs");
                    tracing::error!(job, frame, what, "a committed frame is wrong");
                }
            }
        }
        verdicts
    }

    /// Checks frames of the service's workers, all of one job.
    async fn check_own(self: &Arc<Self>, batch: Vec<Probe>) {
        let Some(first) = batch.first() else { return };
        let frames: Vec<u64> = batch.iter().map(|probe| probe.frame).collect();
        let verdicts = self.judge_all(&first.job, &frames).await;
        for probe in batch {
            match verdicts.get(&probe.frame) {
                Some(Verdict::Good) => self.leases.probes.mark_good(&probe),
                None | Some(Verdict::Open(_)) => self.leases.probes.mark_inconclusive(&probe),
                Some(Verdict::Differs(_)) => {
                    self.leases.dispatch.dismiss(&probe.worker);
                    for (job, frames) in self.leases.probes.take(&probe.worker) {
                        self.take_back(&probe.worker, &job, frames).await;
                    }
                }
            }
        }
    }

    /// Checks frames of other workers, all of one job.
    async fn check_outside(self: &Arc<Self>, batch: Vec<DueCheck>) {
        let Some(job) = batch.first().map(|check| check.job.clone()) else {
            return;
        };
        let frames: Vec<u64> = batch.iter().map(|check| check.frame).collect();
        let verdicts = self.judge_all(&job, &frames).await;
        for check in batch {
            let recorded = match verdicts.get(&check.frame) {
                Some(Verdict::Good) => self.catalogue.record_good_check(check).await,
                None | Some(Verdict::Open(_)) => self.catalogue.record_open_check(check).await,
                Some(Verdict::Differs(_)) => self.reject_worker(&check).await,
            };
            if let Err(error) = recorded {
                tracing::error!(%error, job, "cannot store a check; it is repeated after a restart");
            }
        }
        self.leases.changes.notify(&job);
        self.leases.end_if_complete(&job);
    }

    /// Renders all frames of a worker again that were not checked themselves, and has every other delivery of the job
    /// checked: the worker may have been there under other names.
    async fn reject_worker(self: &Arc<Self>, check: &DueCheck) -> Result<(), CatalogueError> {
        self.leases.dispatch.dismiss(&check.worker);
        let mut by_job: BTreeMap<String, Vec<u64>> = BTreeMap::new();
        for (job, frame) in self.catalogue.unchecked_frames(&check.worker).await? {
            by_job.entry(job).or_default().push(frame);
        }
        for (job, frames) in by_job {
            self.take_back(&check.worker, &job, frames).await;
        }
        self.leases.proofs.distrust(&check.job);
        let checks = self.catalogue.distrust(&check.job).await?;
        self.leases.proofs.push(checks);
        Ok(())
    }

    async fn take_back(self: &Arc<Self>, worker: &str, job: &str, frames: Vec<u64>) {
        let count = frames.len();
        match self.reopen(job.to_owned(), frames).await {
            Ok(row) => {
                tracing::warn!(job, worker, frames = count, state = %row.state, "rendering images again")
            }
            Err(problem) => {
                tracing::error!(job, worker, frames = count, %problem, "cannot render images again")
            }
        }
    }

    /// Ends the jobs whose frames have all ended and are proven, and draws further checks for the others.
    async fn settle_ending(&self) {
        let proofs = &self.leases.proofs;
        for (job, gives_up) in proofs.take_ending() {
            let settled = match self.catalogue.settle(&job, gives_up, self.clock.wall().0).await {
                Ok(settled) => settled,
                Err(error) => {
                    tracing::error!(%error, job, "cannot end a job; it is repeated");
                    proofs.keep_ending(&job);
                    continue;
                }
            };
            if !settled.checks.is_empty() {
                proofs.count_round(&job);
                proofs.push(settled.checks);
            }
            if settled.has_ended {
                proofs.forget_job(&job);
                self.leases.changes.notify(&job);
                self.forget_deliveries(&job).await;
            }
        }
    }

    async fn forget_deliveries(&self, job: &str) {
        loop {
            match self.catalogue.forget_deliveries(job).await {
                Ok(true) => {}
                Ok(false) => return,
                Err(error) => return tracing::warn!(%error, job, "rows of proven frames stay"),
            }
        }
    }
}
