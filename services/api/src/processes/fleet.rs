//! The service's worker processes, restarted when they end.
//!
//! A child is an ordinary worker over loopback. It stops when its standard input closes: on request of the service,
//! and also if the service is killed, because the kernel then closes the pipe. No process is left behind.

use std::collections::VecDeque;
use std::path::PathBuf;
use std::process::{ExitStatus, Stdio};
use std::sync::Arc;
use std::time::Duration;

use futures::future::BoxFuture;
use tokio::io::{AsyncBufReadExt, BufReader};
use tokio::process::{Child, ChildStderr, Command};
use tokio::task::JoinHandle;
use tokio_util::sync::CancellationToken;

use crate::limits;

/// First pause before a child is restarted; it doubles while children end before they register.
const FIRST_PAUSE: Duration = Duration::from_millis(200);
/// Maximum pause: a program that cannot start is tried a few times a minute.
const LONGEST_PAUSE: Duration = Duration::from_secs(10);

/// Time to wait for the last lines of an ended child.
const LAST_LINES: Duration = Duration::from_millis(500);
/// Maximum kept lines of a child's output.
const TAIL_LINES: usize = 12;

/// Prefix of the names of the service's workers, before a number.
pub(crate) const OWN_WORKER: &str = "local-";

/// How to start the children.
pub(crate) struct Recipe {
    /// The program.
    pub(crate) program: PathBuf,
    /// Its arguments, without the name.
    pub(crate) arguments: Vec<String>,
    /// The token in the children's environment.
    pub(crate) token: Option<String>,
}

/// Called with the name of an ended worker and its last output, before the next one starts under that name. Returns
/// whether it had registered, so that it may restart immediately.
pub(crate) type OnExit = Arc<dyn Fn(String, String) -> BoxFuture<'static, bool> + Send + Sync>;

/// Running children.
pub(crate) struct Fleet {
    keepers: Vec<JoinHandle<()>>,
    stop: CancellationToken,
}

impl Fleet {
    /// Starts this many children, named `local-1`, `local-2`, …
    pub(crate) fn start(recipe: Recipe, workers: usize, on_exit: &OnExit) -> Self {
        let (recipe, stop) = (Arc::new(recipe), CancellationToken::new());
        Self {
            keepers: (1..=workers)
                .map(|number: usize| {
                    let name = format!("{OWN_WORKER}{number}");
                    tokio::spawn(keep(Arc::clone(&recipe), name, Arc::clone(on_exit), stop.clone()))
                })
                .collect(),
            stop,
        }
    }

    /// Stops all children, and kills those that do not stop in time.
    pub(crate) async fn stop(self) {
        self.stop.cancel();
        for keeper in self.keepers {
            if let Err(error) = keeper.await {
                tracing::error!(%error, "the supervisor of a worker failed");
            }
        }
    }
}

async fn keep(recipe: Arc<Recipe>, name: String, on_exit: OnExit, stop: CancellationToken) {
    let mut pause = FIRST_PAUSE;
    while !stop.is_cancelled() {
        match spawn(&recipe, &name) {
            Ok(child) => {
                let (status, tail) = live(child, &name, &stop).await;
                if !stop.is_cancelled() {
                    tracing::warn!(worker = name, ?status, "a worker process ended and is restarted");
                }
                if on_exit(name.clone(), tail).await {
                    pause = FIRST_PAUSE;
                }
            }
            Err(error) => {
                tracing::error!(worker = name, program = %recipe.program.display(), %error, "cannot start a worker");
            }
        }
        tokio::select! {
            () = stop.cancelled() => {}
            () = tokio::time::sleep(pause) => {}
        }
        pause = (pause * 2).min(LONGEST_PAUSE);
    }
}

fn spawn(recipe: &Recipe, name: &str) -> std::io::Result<Child> {
    let mut command = Command::new(&recipe.program);
    command
        .args(&recipe.arguments)
        .args(["--name", name])
        .env("NO_COLOR", "1")
        .env_remove("FATHOM_TOKEN");
    if let Some(token) = &recipe.token {
        command.env("FATHOM_TOKEN", token);
    }
    command
        .stdin(Stdio::piped())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .kill_on_drop(true)
        .spawn()
}

/// Waits for the end of a child; returns its status and its last output.
async fn live(mut child: Child, name: &str, stop: &CancellationToken) -> (Option<ExitStatus>, String) {
    let printed = child
        .stderr
        .take()
        .map(|stderr| tokio::spawn(pass_on(stderr, name.to_owned())));
    let status = ended(&mut child, name, stop).await;
    let tail = match printed {
        // A grandchild may hold the pipe open.
        Some(task) => tokio::time::timeout(LAST_LINES, task)
            .await
            .ok()
            .and_then(Result::ok),
        None => None,
    };
    (status, tail.unwrap_or_default())
}

async fn ended(child: &mut Child, name: &str, stop: &CancellationToken) -> Option<ExitStatus> {
    let stdin = child.stdin.take();
    tokio::select! {
        status = child.wait() => return status.ok(),
        () = stop.cancelled() => drop(stdin),
    }
    if let Ok(status) = tokio::time::timeout(limits::WORKER_STOP, child.wait()).await {
        return status.ok();
    }
    tracing::warn!(worker = name, "a worker did not stop in time and is killed");
    if let Err(error) = child.kill().await {
        tracing::error!(worker = name, %error, "cannot kill a worker");
    }
    None
}

/// Logs a child's output; returns its last lines.
async fn pass_on(stderr: ChildStderr, worker: String) -> String {
    let mut lines = BufReader::new(stderr).split(b'\n');
    let mut tail = VecDeque::new();
    while let Ok(Some(line)) = lines.next_segment().await {
        let line = String::from_utf8_lossy(&line).into_owned();
        tracing::info!(worker, "{line}");
        if tail.len() == TAIL_LINES {
            tail.pop_front();
        }
        tail.push_back(line);
    }
    Vec::from(tail).join("\n")
}

#[cfg(test)]
mod tests {
    use tokio::sync::mpsc;

    use tokio::time::Instant;

    use super::*;

    fn fleet(script: &str) -> (Fleet, mpsc::UnboundedReceiver<(String, String)>) {
        let (send, receive) = mpsc::unbounded_channel();
        let on_exit: OnExit = Arc::new(move |name, tail| {
            let send = send.clone();
            Box::pin(async move { send.send((name, tail)).is_err() })
        });
        let arguments = vec!["-c".to_owned(), script.to_owned()];
        let recipe = Recipe {
            program: "/bin/sh".into(),
            arguments,
            token: None,
        };
        (Fleet::start(recipe, 1, &on_exit), receive)
    }

    #[tokio::test]
    async fn a_child_that_dies_is_reported_and_started_again() {
        let (fleet, mut exits) = fleet("echo cannot go on >&2; exit 3");
        let told = ("local-1".to_owned(), "cannot go on".to_owned());
        assert_eq!(exits.recv().await.unwrap(), told);
        assert_eq!(exits.recv().await.unwrap(), told);
        fleet.stop().await;
    }

    #[tokio::test]
    async fn a_child_stops_when_its_standard_input_closes() {
        let dir = tempfile::tempdir().unwrap();
        let started = dir.path().join("started");
        let (fleet, mut exits) = fleet(&format!("touch {}; cat > /dev/null", started.display()));
        while !started.exists() {
            tokio::time::sleep(Duration::from_millis(5)).await;
        }
        let asked = Instant::now();
        fleet.stop().await;
        assert!(asked.elapsed() < limits::WORKER_STOP);
        assert_eq!(exits.recv().await.unwrap().0, "local-1");
        assert!(exits.recv().await.is_none());
    }
}
