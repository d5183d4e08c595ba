//! A progress bar on a terminal, plain lines elsewhere.

use std::io::IsTerminal;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

/// Plain lines come at most this often, so that a log of a long job stays readable.
const PLAIN_INTERVAL: Duration = Duration::from_secs(2);

/// Progress of a known number of frames.
pub struct Progress {
    bar: ProgressBar,
    plain: bool,
    what: String,
    frames: u64,
    last: Option<(u64, Instant)>,
}

impl Progress {
    /// Starts at 0 of `frames`.
    pub fn new(what: &str, frames: u64) -> Self {
        let plain = !std::io::stderr().is_terminal();
        let bar = if plain {
            ProgressBar::hidden()
        } else {
            ProgressBar::new(frames)
        };
        let style = "{msg} [{bar:40.cyan/blue}] {pos}/{len} frames · {per_sec} · {eta} left";
        if let Ok(style) = ProgressStyle::with_template(style) {
            bar.set_style(style.progress_chars("━╸ "));
        }
        bar.set_message(what.to_owned());
        Self {
            bar,
            plain,
            what: what.to_owned(),
            frames,
            last: None,
        }
    }

    /// Shows that `finished` frames are done or have failed.
    pub fn set(&mut self, finished: u64) {
        self.bar.set_position(finished);
        if !self.plain {
            return;
        }
        let due = self.last.is_none_or(|(shown, at)| {
            shown != finished && (finished == self.frames || at.elapsed() >= PLAIN_INTERVAL)
        });
        if due {
            eprintln!("{}: {finished}/{} frames", self.what, self.frames);
            self.last = Some((finished, Instant::now()));
        }
    }

    /// Takes the bar away.
    pub fn finish(self) {
        self.bar.finish_and_clear();
    }
}
