//! A progress bar on a terminal, plain lines elsewhere.

use std::io::IsTerminal;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::print::visible;

/// Shortest time between plain lines, so that the log of a long job stays readable.
const PLAIN_INTERVAL: Duration = Duration::from_secs(2);
const STYLE: &str = "{prefix} [{bar:40.cyan/blue}] {pos}/{len} {msg} · {per_sec} · {eta} left";

/// Progress through a known number of units.
pub struct Progress {
    bar: ProgressBar,
    total: u64,
    /// Set where plain lines are written instead: the last line's number and time.
    plain: Option<Option<(u64, Instant)>>,
}

impl Progress {
    /// Starts at 0 of `total` units, such as frames.
    pub fn new(what: &str, unit: &str, total: u64) -> Self {
        let bar = ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::stderr());
        if let Ok(style) = ProgressStyle::with_template(STYLE) {
            bar.set_style(style.progress_chars("━╸ "));
        }
        bar.set_prefix(visible(what).into_owned());
        bar.set_message(unit.to_owned());
        let plain = (!std::io::stderr().is_terminal()).then_some(None);
        Self { bar, total, plain }
    }

    /// Sets the number of finished units.
    pub fn set(&mut self, done: u64) {
        self.bar.set_position(done);
        let Some(last) = &mut self.plain else { return };
        let is_due = last.is_none_or(|(shown, at)| {
            shown != done && (done == self.total || at.elapsed() >= PLAIN_INTERVAL)
        });
        if is_due {
            let (what, unit) = (self.bar.prefix(), self.bar.message());
            eprintln!("{what}: {done}/{} {unit}", self.total);
            *last = Some((done, Instant::now()));
        }
    }

    /// Sets the number of finished units and a message in place of the unit.
    pub fn set_with(&mut self, done: u64, message: String) {
        self.bar.set_message(visible(&message).into_owned());
        self.set(done);
    }

    /// Writes a line to standard error above the bar.
    pub fn print(&self, line: &str) {
        self.bar.suspend(|| eprintln!("{line}"));
    }

    /// Removes the bar.
    pub fn finish(self) {
        self.bar.finish_and_clear();
    }
}
