//! Provenance rules: the frames of one job come from one program on one kind of machine, unless mixing is allowed.
//!
//! If frames are checked, that is the program and machine of the checks: only they can prove a frame, and no unverified
//! frame decides. An upgrade of the service thus continues open jobs. Otherwise the first image of a job decides.

use spec::Provenance;
use wire::messages::RegisterRequest;

use super::LeaseTable;
use super::job::Job;
use super::lease::Lease;
use super::types::{Millis, Rules, Toolchain};

/// The toolchain that a job needs. It borrows its texts: every look of a waiting worker compares it for many jobs while the
/// table is locked.
struct NeededToolchain<'a> {
    code_version: &'a str,
    cpu_features: &'a str,
    onnx_runtime: Option<&'a str>,
}

impl NeededToolchain<'_> {
    /// Whether a worker of this registration produces the same bytes. A job without ONNX Runtime accepts any version.
    fn matches(&self, worker: &RegisterRequest) -> bool {
        self.code_version == worker.code_version
            && self.cpu_features == worker.cpu_features
            && (self.onnx_runtime.is_none() || self.onnx_runtime == worker.onnx_runtime.as_deref())
    }

    fn to_toolchain(&self) -> Toolchain {
        Toolchain {
            code_version: self.code_version.to_owned(),
            cpu_features: self.cpu_features.to_owned(),
            onnx_runtime: self.onnx_runtime.map(str::to_owned),
        }
    }
}

impl Toolchain {
    fn as_needed(&self) -> NeededToolchain<'_> {
        NeededToolchain {
            code_version: &self.code_version,
            cpu_features: &self.cpu_features,
            onnx_runtime: self.onnx_runtime.as_deref(),
        }
    }

    /// From the provenance of a record.
    pub(crate) fn from_provenance(provenance: &Provenance) -> Self {
        Self {
            code_version: provenance.code_version.clone(),
            cpu_features: provenance.cpu_features.clone(),
            onnx_runtime: provenance.onnx_runtime.clone(),
        }
    }

    /// Whether a frame of another provenance can be compared byte by byte with one of this.
    fn can_check(&self, other: &Self) -> bool {
        let runtimes = (&self.onnx_runtime, &other.onnx_runtime);
        self.code_version == other.code_version
            && self.cpu_features == other.cpu_features
            && !matches!(runtimes, (Some(own), Some(other)) if own != other)
    }

    /// Merges the provenance of another frame; returns whether it is compatible.
    fn merge(&mut self, other: &Self) -> bool {
        let is_compatible = self.can_check(other);
        let is_same = self.code_version == other.code_version && self.cpu_features == other.cpu_features;
        if is_same && self.onnx_runtime.is_none() {
            self.onnx_runtime.clone_from(&other.onnx_runtime);
        }
        is_compatible
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
    pub(super) fn fits(&self, job: &Job, worker: &RegisterRequest) -> bool {
        self.needed(job).is_none_or(|needed| needed.matches(worker))
    }

    /// The toolchain that a job needs; `None`: any.
    fn needed<'a>(&'a self, job: &'a Job) -> Option<NeededToolchain<'a>> {
        if self.mixed || job.mixed {
            return None;
        }
        let made = job.made.as_ref();
        let Some(reference) = &self.reference else {
            return made.filter(|_| !job.is_untouched()).map(Toolchain::as_needed);
        };
        let runtime = made.and_then(|made| made.onnx_runtime.as_deref());
        let kind = made.filter(|_| !job.is_untouched()).unwrap_or(reference);
        Some(NeededToolchain {
            code_version: &reference.code_version,
            cpu_features: &kind.cpu_features,
            onnx_runtime: runtime.map(|made| reference.onnx_runtime.as_deref().unwrap_or(made)),
        })
    }

    /// Whether the frame of a lease has exceeded the time limit.
    pub(super) fn is_stalled(&self, lease: &Lease, now: Millis) -> bool {
        !lease.cancelled && lease.since.plus(self.frame_limit_ms) <= now
    }
}

/// Registered workers that get no frames of a job.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Misfits {
    /// The toolchain that the job needs.
    pub needed: Toolchain,
    /// The excluded workers.
    pub workers: Vec<RegisterRequest>,
    /// Whether no worker fits.
    pub is_waiting: bool,
}

impl LeaseTable {
    /// Records the provenance of a frame before it is written; returns whether the job accepts it.
    pub fn record_toolchain(&mut self, job: &str, toolchain: &Toolchain) -> bool {
        let is_being_written = self.is_being_written(job);
        let Some(job) = self.jobs.get_mut(job) else {
            return true;
        };
        let is_mixed = self.rules.mixed || job.mixed;
        let reference = self.rules.reference.as_ref().filter(|_| !is_mixed);
        if let Some(reference) = reference
            && !reference.can_check(toolchain)
        {
            // From now on its runtime excludes workers with another one.
            let made = job.made.get_or_insert_with(|| reference.clone());
            made.onnx_runtime.clone_from(&reference.onnx_runtime);
            return false;
        }
        if job.made.is_none() || (job.is_untouched() && !is_being_written) {
            job.made = Some(toolchain.clone());
            return true;
        }
        let takes = job.made.as_mut().is_some_and(|made| made.merge(toolchain));
        takes || is_mixed || reference.is_some()
    }

    /// Lets workers of any kind render the frames of a job.
    pub fn mix(&mut self, job: &str) {
        if let Some(job) = self.jobs.get_mut(job) {
            job.mixed = true;
        }
    }

    /// The registered workers that get no frames of an open job; `None` without any.
    #[must_use]
    pub fn misfits(&self, job: &str) -> Option<Misfits> {
        let job = self.jobs.get(job)?;
        let needed = self.rules.needed(job)?;
        let workers = self.workers.values().map(|worker| &worker.about);
        let misfits: Vec<_> = workers
            .filter(|about: &&RegisterRequest| !needed.matches(about))
            .cloned()
            .collect();
        (!misfits.is_empty()).then_some(Misfits {
            needed: needed.to_toolchain(),
            is_waiting: misfits.len() == self.workers.len(),
            workers: misfits,
        })
    }

    /// The provenance of a job's first images, if the service has another version now, and the present one.
    #[must_use]
    pub fn upgraded(&self, job: &str) -> Option<(&Toolchain, &Toolchain)> {
        let job = self.jobs.get(job).filter(|job| !job.is_untouched())?;
        let (made, reference) = job.made.as_ref().zip(self.rules.reference.as_ref())?;
        (made.code_version != reference.code_version).then_some((made, reference))
    }
}
