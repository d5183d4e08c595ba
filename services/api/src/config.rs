//! The configuration of the service.

use std::net::SocketAddr;
use std::path::PathBuf;
use std::time::Duration;

use style::{Library, Runtime};

use crate::bytes::sets::ReadBucket;
use crate::clock::Clock;
use crate::engine::EngineOptions;
use crate::leases::table::{Rules, Toolchain};
use crate::limits::{self, Limits, PriceLimits};

/// Settings of the user.
pub struct Config {
    /// Folder of the catalogue and the artifact packs; created if missing, locked by one service at a time.
    pub data: PathBuf,
    /// Listen address. Port 0 selects a free port. Any address except loopback requires a token.
    pub listen: SocketAddr,
    /// Worker processes to start and keep running; 0: only remote workers.
    pub workers: usize,
    /// Slots of each worker process.
    pub slots_per_worker: usize,
    /// The program started as `PROGRAM worker …` and `PROGRAM child …`.
    pub program: PathBuf,
    /// `SECRET` (all scopes) or `scope+scope:SECRET`, several separated by commas; scopes are read, submit, work and
    /// admin. Absent: open to every client of the loopback address.
    pub token: Option<String>,
    /// Further host names of a service without tokens.
    pub hosts: Vec<String>,
    /// Folder with more style models, passed to the workers.
    pub styles: Option<PathBuf>,
    /// Explicit ONNX Runtime library, passed to the workers.
    pub onnxruntime: Option<PathBuf>,
    /// The style models that jobs may use, except those added to the data folder.
    pub library: Library,
    /// Folders and `s3://BUCKET/PREFIX` from which clients may import sets; empty: imports are disabled.
    pub stores: Vec<String>,
    /// The broker that distributes jobs. They become sets in the only entry of `stores`.
    pub engine: Option<EngineOptions>,
    /// Reader of sets in buckets.
    pub buckets: ReadBucket,
    /// Time limit for trying an added network.
    pub style_trial: Duration,
    /// Time limit of a frame, enforced by the workers. A worker that exceeds it loses its lease a while later.
    pub frame_limit: Duration,
    /// Limits on the expected cost of jobs.
    pub prices: PriceLimits,
    /// Whether workers of different versions, CPU features or ONNX Runtimes may share a job.
    pub mix_workers: bool,
    /// One of this many frames of each worker is rendered again and compared; 0: none.
    pub spot_check: u64,
}

impl Config {
    /// Lease rules of all jobs.
    pub(crate) fn rules(&self, style_runtime: Option<&String>) -> Rules {
        let limit = self.frame_limit.saturating_add(limits::HAND_IN);
        Rules {
            frame_limit_ms: u64::try_from(limit.as_millis()).unwrap_or(u64::MAX),
            mixed: self.mix_workers,
            reference: (self.spot_check > 0).then(|| Toolchain {
                code_version: renderer::CODE_VERSION.to_owned(),
                cpu_features: renderer::cpu_features(),
                onnx_runtime: style_runtime.cloned(),
            }),
        }
    }

    /// Options that pass styles and their runtime to the child processes.
    pub(crate) fn style_options(&self) -> Vec<(&'static str, PathBuf)> {
        let options = [("--styles", &self.styles), ("--onnxruntime", &self.onnxruntime)];
        let given = options.into_iter();
        given
            .filter_map(|(option, path)| Some((option, path.clone()?)))
            .collect()
    }
}

/// The environment of the service: injected by tests, otherwise read from the machine.
pub struct Surroundings {
    /// Source of time.
    pub clock: Clock,
    /// Version of the ONNX Runtime available to this machine's workers, or why there is none.
    pub style_runtime: Result<String, String>,
    /// Limits on sizes and numbers.
    pub limits: Limits,
}

impl Surroundings {
    /// The machine's clock and style runtime, and the default limits.
    #[must_use]
    pub fn of_this_machine(config: &Config) -> Self {
        let runtime = Runtime::load(config.onnxruntime.as_deref());
        Self {
            clock: Clock::system(),
            style_runtime: runtime
                .map(|r| r.version().to_string())
                .map_err(|missing| missing.to_string()),
            limits: Limits::default(),
        }
    }
}
