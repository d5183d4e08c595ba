//! The configuration of the service.

use std::net::SocketAddr;
use std::path::PathBuf;
use std::time::Duration;

use style::{Library, Runtime};

use crate::bytes::sets::ReadBucket;
use crate::clock::Clock;
use crate::engine::EngineOptions;
use crate::leases::table::Rules;
use crate::limits::{self, Limits};

/// What the user configures.
pub struct Config {
    /// Folder of the catalogue and the artifact packs; created if missing, held by one service at a time.
    pub data: PathBuf,
    /// Where to listen. Port 0 takes a free one. Anything but loopback needs a token.
    pub listen: SocketAddr,
    /// Worker processes to start and to keep running; 0: only remote workers.
    pub workers: usize,
    /// Slots of each worker process.
    pub slots_per_worker: usize,
    /// The program that is started as `PROGRAM worker …`.
    pub worker_program: PathBuf,
    /// `SECRET` (may do everything) or `scope+scope:SECRET`, several separated by commas; scopes are read, submit,
    /// work and admin. Absent: open to everybody who reaches the loopback address.
    pub token: Option<String>,
    /// Names beside those of the loopback interface to which a service without tokens responds.
    pub hosts: Vec<String>,
    /// Folder with more style models, passed on to the workers.
    pub styles: Option<PathBuf>,
    /// Explicit ONNX Runtime library, passed on to the workers.
    pub onnxruntime: Option<PathBuf>,
    /// The style models that jobs may name, beside those that were added to the data folder.
    pub library: Library,
    /// The program that reads sets, `fathom-cluster`.
    pub cluster_program: PathBuf,
    /// Folders and `s3://BUCKET/PREFIX` below which a client may have sets imported; none: it may not.
    pub stores: Vec<String>,
    /// The broker that hands out jobs; they become sets in the only one of `stores`.
    pub engine: Option<EngineOptions>,
    /// What reads sets in buckets; without it a data folder with images of such a set is refused.
    pub buckets: Option<ReadBucket>,
    /// How long a network that a user adds may take to be tried.
    pub style_trial: Duration,
    /// Longest time of one frame, which the workers keep themselves; one that does not loses its lease a while later.
    pub frame_limit: Duration,
    /// Whether workers of different versions, CPU features or ONNX Runtimes may share a job.
    pub mix_workers: bool,
    /// One in so many frames of each worker is rendered again and compared; 0: none.
    pub spot_check: u64,
}

impl Config {
    /// What holds for the leases of all jobs.
    pub(crate) fn rules(&self) -> Rules {
        let limit = self.frame_limit.saturating_add(limits::HAND_IN);
        Rules {
            frame_limit_ms: u64::try_from(limit.as_millis()).unwrap_or(u64::MAX),
            mixed: self.mix_workers,
        }
    }

    /// Options that tell the service's processes where to find styles and their runtime.
    pub(crate) fn style_options(&self) -> Vec<(&'static str, PathBuf)> {
        let options = [("--styles", &self.styles), ("--onnxruntime", &self.onnxruntime)];
        let given = options.into_iter();
        given
            .filter_map(|(option, path)| Some((option, path.clone()?)))
            .collect()
    }
}

/// The environment of the service: passed in by tests, read from the machine otherwise.
pub struct Surroundings {
    /// Where the time comes from.
    pub clock: Clock,
    /// Version of the ONNX Runtime that this machine's workers will find, or why there is none.
    pub style_runtime: Result<String, String>,
    /// Limits on sizes and numbers.
    pub limits: Limits,
}

impl Surroundings {
    /// The machine's own clock and style runtime, and the usual limits.
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
