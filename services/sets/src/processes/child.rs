//! A child process that renders frames, as its supervisor sees it.

use std::collections::BTreeMap;
use std::ffi::OsString;
use std::io::{BufReader, Write};
use std::path::PathBuf;
use std::process::{Child as Process, ChildStdin, Command, Stdio};
use std::sync::mpsc::{self, Receiver, RecvTimeoutError};
use std::thread;
use std::time::{Duration, Instant};

use crate::error::SetError;
use crate::processes::message::Message;

/// How often the limits are looked at.
const LOOK: Duration = Duration::from_millis(100);
/// Messages read ahead of the supervisor: one holds the pictures of a frame.
const MESSAGES_AHEAD: usize = 1;

/// Program, arguments and limits of children.
#[derive(Debug, Clone)]
pub struct Recipe {
    /// The program that renders.
    pub program: PathBuf,
    /// Its arguments; the number of slots follows them.
    pub arguments: Vec<OsString>,
    /// Frames rendered side by side.
    pub slots: usize,
    /// Longest time of one frame.
    pub frame_limit: Duration,
    /// Most resident memory of a child, bytes.
    pub memory_limit_bytes: u64,
}

/// An event of a child.
pub(crate) enum News {
    /// A message.
    Message(Message),
    /// No message within the time limit.
    Quiet,
    /// The process has ended or was ended, for this reason.
    Gone(String),
}

/// A running child. Dropped, it is killed.
pub(crate) struct Child {
    process: Process,
    orders: ChildStdin,
    messages: Receiver<Message>,
    /// Frames that it was given, with the time since it renders them.
    frames: BTreeMap<u64, Option<Instant>>,
    looked: Instant,
    recipe: Recipe,
}

impl Child {
    /// Starts a child for a job.
    pub(crate) fn start(recipe: &Recipe, slots: usize, job: &str) -> Result<Self, SetError> {
        let failed = |error| SetError::Machine(format!("cannot start {}: {error}", recipe.program.display()));
        let mut process = Command::new(&recipe.program)
            .args(&recipe.arguments)
            .args(["--slots", &slots.to_string()])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .map_err(failed)?;
        let (Some(mut orders), Some(output)) = (process.stdin.take(), process.stdout.take()) else {
            return Err(failed(std::io::ErrorKind::BrokenPipe.into()));
        };
        // A child that is gone already is noticed by its silence.
        let _ = writeln!(orders, "{job}");
        let (send, messages) = mpsc::sync_channel(MESSAGES_AHEAD);
        thread::spawn(move || {
            let mut output = BufReader::new(output);
            while let Some(message) = Message::read(&mut output) {
                if send.send(message).is_err() {
                    return;
                }
            }
        });
        Ok(Self {
            process,
            orders,
            messages,
            frames: BTreeMap::new(),
            looked: Instant::now(),
            recipe: recipe.clone(),
        })
    }

    /// Frames that it has and did not finish.
    pub(crate) fn load(&self) -> usize {
        self.frames.len()
    }

    /// Gives it a frame.
    pub(crate) fn give(&mut self, frame: u64) {
        self.frames.insert(frame, None);
        let _ = writeln!(self.orders, "{frame}");
    }

    /// Waits a moment for the next message. Ends a child that exceeds a limit.
    pub(crate) fn next(&mut self) -> News {
        if self.looked.elapsed() > LOOK {
            self.looked = Instant::now();
            if let Some(verdict) = self.verdict() {
                self.end();
                return News::Gone(verdict);
            }
        }
        match self.messages.recv_timeout(LOOK) {
            Ok(message) => {
                match message {
                    Message::Begun { frame } => drop(self.frames.insert(frame, Some(Instant::now()))),
                    Message::Image { frame, .. } | Message::Failed { frame, .. } => {
                        self.frames.remove(&frame);
                    }
                }
                News::Message(message)
            }
            Err(RecvTimeoutError::Timeout) => News::Quiet,
            Err(RecvTimeoutError::Disconnected) => News::Gone(self.end()),
        }
    }

    /// Ends the process, if it runs, and describes its exit.
    fn end(&mut self) -> String {
        // A child that closed its output but lives is as good as dead.
        let _ = self
            .process
            .try_wait()
            .map(|ended| ended.is_none().then(|| self.process.kill()));
        match self.process.wait() {
            Ok(status) => format!("the process that rendered it ended with {status}"),
            Err(error) => error.to_string(),
        }
    }

    /// Frames that it was rendering, and those that it had not begun.
    pub(crate) fn split(&self) -> (Vec<u64>, Vec<u64>) {
        let frames = self.frames.keys().copied();
        frames.partition(|frame| self.frames[frame].is_some())
    }

    /// Why the child must end, if it must.
    fn verdict(&self) -> Option<String> {
        let limit = self.recipe.frame_limit;
        if self
            .frames
            .values()
            .flatten()
            .any(|since: &Instant| since.elapsed() > limit)
        {
            return Some(format!(
                "took more than {} s (--frame-limit-s)",
                limit.as_secs_f64()
            ));
        }
        let taken = resident_bytes(self.process.id())?;
        (taken > self.recipe.memory_limit_bytes).then(|| {
            format!(
                "uses {} MiB of memory; must be at most {} (--memory-limit-mib)",
                taken >> 20,
                self.recipe.memory_limit_bytes >> 20
            )
        })
    }
}

impl Drop for Child {
    fn drop(&mut self) {
        self.end();
    }
}

/// Resident memory of a process; `None` if the system does not report it.
fn resident_bytes(process: u32) -> Option<u64> {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    let kib: u64 = line.split_whitespace().next()?.parse().ok()?;
    Some(kib << 10)
}
