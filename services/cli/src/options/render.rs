//! The options of `fathom render`, for a plain folder and for a sharded dataset.

use std::ops::Range;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use renderer::Engine;
use renderer::worker::{Limits, available_bytes};
use spec::Job;

use crate::engine::EngineArguments;
use crate::exit::Failure;
use crate::job;
use crate::styles::StyleArguments;

/// Options of `fathom render`.
#[derive(clap::Args)]
pub struct Arguments {
    /// The job: a frame description as JSON, with random distributions
    pub spec: PathBuf,
    /// Folder for the frames and records.jsonl; s3://BUCKET/PREFIX or file:///FOLDER for a sharded dataset
    #[arg(long, value_name = "DIR|URL")]
    pub out: PathBuf,
    /// Frames rendered in parallel, one thread each [default: the number of cores]
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    slots: Option<u16>,
    #[command(flatten)]
    pub style: StyleArguments,
    #[command(flatten)]
    pub set: SetArguments,
}

/// Options of sharded datasets only.
#[derive(clap::Args)]
pub struct SetArguments {
    /// Write a sharded dataset, and of it only the shards K with K % N = I
    #[arg(long, value_name = "I/N")]
    pub shard: Option<String>,
    /// Only these frames, from A up to and without B; of a sharded dataset whole shards
    #[arg(long, value_name = "A..B")]
    pub frames: Option<String>,
    /// Write a sharded dataset with this many frames in a shard [default: 500, or as it was begun]
    #[arg(long, value_name = "FRAMES")]
    pub frames_per_shard: Option<u64>,
    #[command(flatten)]
    pub limits: LimitArguments,
    /// Interval between checks whether the sharded dataset was cancelled
    #[arg(long, default_value_t = 15.0, value_parser = seconds)]
    pub state_interval_s: f64,
    #[command(flatten)]
    pub engine: EngineArguments,
    /// With a broker: most shards that wait for workers [default: four for each slot of the fleet]
    #[arg(long, value_name = "SHARDS", requires = "engine", value_parser = clap::value_parser!(u64).range(1..=100_000))]
    pub window: Option<u64>,
}

/// Limits of a frame, beyond which the rendering process is ended.
#[derive(clap::Args)]
pub struct LimitArguments {
    /// Longest time of one frame, after which its process is ended and the frame is tried again
    #[arg(long, env = "FATHOM_FRAME_LIMIT_S", default_value_t = 600.0, value_parser = seconds)]
    frame_limit_s: f64,
    /// Most memory of the rendering process, beyond which it is ended [default: three quarters of the machine's, or of its container's limit]
    #[arg(long, env = "FATHOM_MEMORY_LIMIT_MIB", value_parser = clap::value_parser!(u64).range(64..))]
    memory_limit_mib: Option<u64>,
}

impl LimitArguments {
    pub fn limits(&self) -> Limits {
        let usual = || available_bytes().map_or(u64::MAX, |bytes| bytes / 4 * 3);
        Limits::new(
            Duration::from_secs_f64(self.frame_limit_s),
            self.memory_limit_mib.map_or_else(usual, |mib| mib << 20),
        )
    }
}

/// Reads a length of time.
pub fn seconds(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| format!("`{text}` is not a number"))?;
    // A year: a duration needs some end.
    if value > 0.0 && value <= 31_536_000.0 {
        Ok(value)
    } else {
        Err("must be above 0, at most 31536000 s".to_owned())
    }
}

impl Arguments {
    /// Whether the output is a sharded dataset.
    pub fn wants_set(&self) -> bool {
        let SetArguments {
            shard,
            frames_per_shard,
            engine,
            ..
        } = &self.set;
        let is_url = self.out.to_str().is_some_and(|out| out.contains("://"));
        let is_asked = is_url || shard.is_some() || frames_per_shard.is_some() || engine.engine.is_some();
        is_asked || self.continues_set()
    }

    /// Whether the folder holds a sharded dataset, whose `job.json` names the version of its layout.
    fn continues_set(&self) -> bool {
        let card = std::fs::read(self.out.join("job.json")).unwrap_or_default();
        let card: serde_json::Value = serde_json::from_slice(&card).unwrap_or_default();
        card["format"].is_u64()
    }

    /// The frames of a plain folder: those of `--frames`, or else all.
    pub fn range(&self, job: &Job) -> Result<Range<u64>, Failure> {
        let Some(text) = &self.set.frames else {
            return Ok(0..job.frames());
        };
        let frames =
            sets::parse_frames(text).map_err(|reason| Failure::BadInput(format!("--frames: {reason}")))?;
        if frames.end > job.frames() {
            return Err(Failure::BadInput(format!(
                "--frames is {}..{}, but the job has {} frames",
                frames.start,
                frames.end,
                job.frames()
            )));
        }
        Ok(frames)
    }

    /// Reads the job and checks its requirements.
    pub fn prepare(&self) -> Result<(Job, Arc<Engine>), Failure> {
        let library = self.style.library()?;
        let job = job::read(&self.spec, &library)?;
        for warning in job.warnings() {
            eprintln!("warning: {warning}");
        }
        let engine = Arc::new(Engine::new(library, self.style.onnxruntime.as_deref()));
        let models = job.models();
        if models.iter().any(|name| engine.library().needs_runtime(name))
            && let Err(missing) = engine.runtime()
        {
            return Err(Failure::RuntimeMissing(missing.to_string()));
        }
        Ok((job, engine))
    }

    /// Frames rendered side by side.
    pub fn slots(&self) -> usize {
        self.slots.map_or_else(cores, usize::from)
    }
}

/// Number of cores.
pub fn cores() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}
