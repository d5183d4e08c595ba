//! Progress of a training: a bar with the losses on a terminal, plain lines elsewhere.

use std::io::IsTerminal;
use std::path::PathBuf;
use std::time::{Duration, Instant};

use cli::exit::Failure;
use cli::files;
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::json;
use training::loss::Losses;

/// Plain lines come at most this often.
const PLAIN_INTERVAL: Duration = Duration::from_secs(2);
/// A file is written at most this often.
const FILE_INTERVAL: Duration = Duration::from_millis(250);
/// Share of the newest losses in those that are shown: single steps jump about.
const NEWEST: f64 = 0.1;

pub(super) struct TrainingProgress {
    bar: ProgressBar,
    plain: bool,
    steps: usize,
    shown: Option<[f64; 3]>,
    last: Option<Instant>,
    file: Option<PathBuf>,
    told: Option<Instant>,
}

impl TrainingProgress {
    pub(super) fn new(steps: usize, file: Option<PathBuf>) -> Self {
        let plain = !std::io::stderr().is_terminal();
        let bar = if plain {
            ProgressBar::hidden()
        } else {
            ProgressBar::new(steps as u64)
        };
        let style = "train [{bar:30.cyan/blue}] {pos}/{len} steps · {msg} · {eta} left";
        if let Ok(style) = ProgressStyle::with_template(style) {
            bar.set_style(style.progress_chars("━╸ "));
        }
        Self {
            bar,
            plain,
            steps,
            shown: None,
            last: None,
            file,
            told: None,
        }
    }

    pub(super) fn set(&mut self, done: usize, losses: &Losses) -> Result<(), Failure> {
        let now = [losses.texture, losses.colour, losses.content];
        let shown = self.shown.map_or(now, |shown| {
            [0, 1, 2].map(|part| shown[part] * (1.0 - NEWEST) + now[part] * NEWEST)
        });
        self.shown = Some(shown);
        let [texture, colour, content] = shown;
        let message = format!("texture {texture:.3} colour {colour:.3} content {content:.3}");
        let due = done == self.steps || self.last.is_none_or(|last| last.elapsed() >= PLAIN_INTERVAL);
        if self.plain && due {
            eprintln!("train: {done}/{} steps · {message}", self.steps);
            self.last = Some(Instant::now());
        }
        self.bar.set_position(done as u64);
        self.bar.set_message(message);
        if self.told.is_none_or(|told| told.elapsed() >= FILE_INTERVAL) {
            self.tell(done)?;
        }
        Ok(())
    }

    /// Writes the file that was asked for.
    pub(super) fn tell(&mut self, done: usize) -> Result<(), Failure> {
        let Some(file) = &self.file else {
            return Ok(());
        };
        let losses = self.shown.map(
            |[texture, colour, content]| json!({"texture": texture, "colour": colour, "content": content}),
        );
        self.told = Some(Instant::now());
        files::write(
            file,
            json!({"done": done, "losses": losses}).to_string().as_bytes(),
        )
    }

    pub(super) fn finish(self) {
        self.bar.finish_and_clear();
    }
}
