//! Progress of a training: a bar with the losses, and a file for the service.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use cli::exit::Failure;
use cli::files;
use cli::progress::Progress;
use serde_json::json;
use training::loss::Losses;

/// Shortest time between writes of the file.
const FILE_INTERVAL: Duration = Duration::from_millis(250);
/// Weight of the newest losses in the displayed running mean; single steps vary strongly.
const NEWEST: f64 = 0.1;

pub(super) struct TrainingProgress {
    bar: Progress,
    shown: Option<[f64; 3]>,
    file: Option<PathBuf>,
    written: Option<Instant>,
}

impl TrainingProgress {
    pub(super) fn new(steps: usize, file: Option<PathBuf>) -> Result<Self, Failure> {
        let mut progress = Self {
            bar: Progress::new("train", "steps", steps as u64),
            shown: None,
            file,
            written: None,
        };
        progress.write(0)?;
        Ok(progress)
    }

    pub(super) fn set(&mut self, done: usize, losses: &Losses) -> Result<(), Failure> {
        let now = [losses.texture, losses.color, losses.content];
        let shown = self.shown.map_or(now, |shown| {
            [0, 1, 2].map(|part| shown[part] * (1.0 - NEWEST) + now[part] * NEWEST)
        });
        self.shown = Some(shown);
        let [texture, color, content] = shown;
        let message = format!("steps · texture {texture:.3} color {color:.3} content {content:.3}");
        self.bar.set_with(done as u64, message);
        if self
            .written
            .is_none_or(|written| written.elapsed() >= FILE_INTERVAL)
        {
            self.write(done)?;
        }
        Ok(())
    }

    fn write(&mut self, done: usize) -> Result<(), Failure> {
        let Some(file) = &self.file else { return Ok(()) };
        let losses = self.shown.map(|[texture, color, content]: [f64; 3]| json!({"texture": texture, "colour": color, "content": content}));
        self.written = Some(Instant::now());
        files::write(
            file,
            json!({"done": done, "losses": losses}).to_string().as_bytes(),
        )
    }

    pub(super) fn finish(self) {
        self.bar.finish();
    }
}
