//! Provenance rules: the frames of one job come from one program on one kind of machine, unless mixing is allowed.

use spec::Provenance;
use wire::messages::RegisterRequest;

use super::LeaseTable;
use super::job::Job;
use super::lease::Lease;
use super::types::{Millis, Rules, Toolchain};

impl Toolchain {
    /// From the provenance of a record.
    pub(crate) fn from_provenance(provenance: &Provenance) -> Self {
        Self {
            code_version: provenance.code_version.clone(),
            cpu_features: provenance.cpu_features.clone(),
            onnx_runtime: provenance.onnx_runtime.clone(),
        }
    }

    /// Whether a worker of this registration produces the same bytes. A job without ONNX Runtime accepts any version.
    fn matches(&self, worker: &RegisterRequest) -> bool {
        self.code_version == worker.code_version
            && self.cpu_features == worker.cpu_features
            && (self.onnx_runtime.is_none() || self.onnx_runtime == worker.onnx_runtime)
    }

    /// Merges the provenance of another frame; returns whether it is compatible.
    fn merge(&mut self, other: &Self) -> bool {
        let is_same = self.code_version == other.code_version && self.cpu_features == other.cpu_features;
        let runtimes = (&self.onnx_runtime, &other.onnx_runtime);
        let differ = matches!(runtimes, (Some(one), Some(other)) if one != other);
        if is_same && self.onnx_runtime.is_none() {
            self.onnx_runtime.clone_from(&other.onnx_runtime);
        }
        is_same && !differ
    }
}

impl std::fmt::Display for Toolchain {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "version {}, CPU features {}",
            self.code_version, self.cpu_features
        )?;
        match &self.onnx_runtime {
            Some(runtime) => write!(f, ", ONNX Runtime {runtime}"),
            None => Ok(()),
        }
    }
}

impl Rules {
    /// Whether a worker may render frames of a job.
    pub(super) fn fits(self, job: &Job, worker: &RegisterRequest) -> bool {
        let is_open = self.mixed || job.is_untouched();
        is_open || job.made.as_ref().is_none_or(|made| made.matches(worker))
    }

    /// Whether the frame of a lease has exceeded the time limit.
    pub(super) fn is_stalled(self, lease: &Lease, now: Millis) -> bool {
        !lease.cancelled && lease.since.plus(self.frame_limit_ms) <= now
    }
}

impl LeaseTable {
    /// Records the provenance of a frame before it is written; returns whether the job accepts it.
    pub fn record_toolchain(&mut self, job: &str, toolchain: &Toolchain) -> bool {
        let is_being_written = self.pinned.keys().any(|(other, _)| other == job);
        let Some(job) = self.jobs.get_mut(job) else {
            return true;
        };
        if job.made.is_none() || (job.is_untouched() && !is_being_written) {
            job.made = Some(toolchain.clone());
            return true;
        }
        let takes = job.made.as_mut().is_some_and(|made| made.merge(toolchain));
        takes || self.rules.mixed
    }

    /// The provenance that a job waits for, if there are workers but none is compatible.
    #[must_use]
    pub fn waits_for(&self, job: &str) -> Option<&Toolchain> {
        let job = self.jobs.get(job).filter(|job| !job.is_untouched())?;
        let made = job.made.as_ref()?;
        let mut workers = self.workers.values();
        let is_unfit =
            !self.rules.mixed && workers.len() > 0 && workers.all(|worker| !made.matches(&worker.about));
        is_unfit.then_some(made)
    }
}
