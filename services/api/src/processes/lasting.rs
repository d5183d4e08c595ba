//! A process that replies to one request after another and ends after a while without requests.
//!
//! A reply is a line of JSON with `bytes`, the number of bytes that follow it.

use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::sync::Arc;
use std::time::Duration;

use serde::Deserialize;
use tokio::io::{AsyncBufReadExt, AsyncReadExt, AsyncWriteExt, BufReader};
use tokio::process::{Child, ChildStdin, ChildStdout, Command};
use tokio::sync::{Mutex, OwnedMutexGuard};

use super::child::{Allowance, exceeded};

/// The process ends after this time without requests.
const IDLE: Duration = Duration::from_secs(60);

/// The process, started with the first request.
pub(crate) struct Lasting {
    program: PathBuf,
    arguments: Vec<PathBuf>,
    running: Arc<Mutex<Option<Running>>>,
}

/// Limits of a request.
#[derive(Clone, Copy)]
pub(crate) struct Bounds {
    pub(crate) allowance: Allowance,
    /// Maximum length of the line.
    pub(crate) head_bytes: u64,
    /// Maximum of the bytes after it.
    pub(crate) body_bytes: u64,
}

/// A line, and the bytes after it.
pub(crate) struct Reply {
    pub(crate) head: Vec<u8>,
    pub(crate) body: Vec<u8>,
}

struct Running {
    child: Child,
    requests: ChildStdin,
    replies: BufReader<ChildStdout>,
    /// Replies so far.
    served: u64,
}

/// The part of a line that every protocol has.
#[derive(Deserialize)]
struct Head {
    bytes: u64,
}

impl Lasting {
    /// A process of this program, `child TASK`, on this data folder with options for styles.
    pub(crate) fn new(
        program: &Path,
        task: &str,
        data: &Path,
        options: Vec<(&'static str, PathBuf)>,
    ) -> Self {
        let given = options
            .into_iter()
            .flat_map(|(option, path)| [PathBuf::from(option), path]);
        let arguments = ["child".into(), task.into(), "--data".into(), data.to_owned()];
        Self::with_arguments(program, arguments.into_iter().chain(given).collect())
    }

    /// A process of this program with these arguments.
    pub(crate) fn with_arguments(program: &Path, arguments: Vec<PathBuf>) -> Self {
        Self {
            program: program.to_owned(),
            arguments,
            running: Arc::default(),
        }
    }

    /// Sends a request and returns the reply, or why there is none. The process is kept after a reply.
    pub(crate) async fn exchange(&self, request: Vec<u8>, bounds: Bounds) -> Result<Reply, String> {
        let held = Arc::clone(&self.running).lock_owned().await;
        let (program, arguments) = (self.program.clone(), self.arguments.clone());
        // Completes even if the caller is dropped: otherwise the next reply would belong to this request.
        let exchanging =
            tokio::spawn(async move { exchange(held, &program, &arguments, &request, bounds).await });
        let (reply, number) = exchanging.await.map_err(|error| error.to_string())??;
        self.end_if_idle(number);
        Ok(reply)
    }

    /// Whether the process is kept for the next request.
    #[cfg(test)]
    pub(crate) async fn is_running(&self) -> bool {
        self.running.lock().await.is_some()
    }

    fn end_if_idle(&self, number: u64) {
        let running = Arc::clone(&self.running);
        tokio::spawn(async move {
            tokio::time::sleep(IDLE).await;
            let mut running = running.lock().await;
            if running.as_ref().is_some_and(|running| running.served == number) {
                *running = None;
            }
        });
    }
}

async fn exchange(
    mut held: OwnedMutexGuard<Option<Running>>,
    program: &Path,
    arguments: &[PathBuf],
    request: &[u8],
    bounds: Bounds,
) -> Result<(Reply, u64), String> {
    let mut running = match held.take() {
        Some(running) => running,
        None => start(program, arguments)?,
    };
    let id = running.child.id();
    let reply = tokio::select! {
        reply = running.exchange(request, bounds) => reply.ok_or_else(|| "it ended without a reply".to_owned()),
        reason = exceeded(id, bounds.allowance) => Err(reason),
    };
    let reply = reply.inspect_err(|reason| tracing::warn!(reason, "a lasting process failed"))?;
    running.served += 1;
    let number = running.served;
    *held = Some(running);
    Ok((reply, number))
}

fn start(program: &Path, arguments: &[PathBuf]) -> Result<Running, String> {
    let mut child = Command::new(program)
        .args(arguments)
        .env_remove("FATHOM_TOKEN")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .kill_on_drop(true)
        .spawn()
        .inspect_err(|error| tracing::error!(%error, "cannot start a lasting process"))
        .map_err(|error| error.to_string())?;
    let pipes = child.stdin.take().zip(child.stdout.take());
    let (requests, replies) = pipes.ok_or("it has no pipes")?;
    Ok(Running {
        child,
        requests,
        replies: BufReader::new(replies),
        served: 0,
    })
}

impl Running {
    /// `None` after a malformed reply.
    async fn exchange(&mut self, request: &[u8], bounds: Bounds) -> Option<Reply> {
        self.requests.write_all(request).await.ok()?;
        let mut head = Vec::new();
        let mut line = (&mut self.replies).take(bounds.head_bytes);
        line.read_until(b'\n', &mut head).await.ok()?;
        let Head { bytes } = serde_json::from_slice(&head).ok()?;
        let length = (bytes <= bounds.body_bytes).then_some(bytes as usize)?;
        let mut body = vec![0; length];
        self.replies.read_exact(&mut body).await.ok()?;
        Some(Reply { head, body })
    }
}
