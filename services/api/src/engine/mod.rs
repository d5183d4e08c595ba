//! Jobs that are rendered into sets by the workers of a broker.
//!
//! What a broker and a store ask for is done by processes: `fathom-cluster jobs`. The store is the truth of these jobs: each is a
//! set `STORE/JOB`, which every service of the store sees, and the catalogue an index over it.

pub(crate) mod orders;
mod watch;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::process::Stdio;

use catalogue::JobRow;
use spec::{Job, SetState};
use style::Library;
use tokio::io::AsyncWriteExt;
use tokio::process::Command;

use crate::http::problem::{Problem, Slug};
use orders::{Accepted, Order};

/// Which broker hands the shards of jobs to workers.
#[derive(Debug, Clone)]
pub struct EngineOptions {
    /// Its addresses, separated by commas; they may hold secrets.
    pub url: String,
    /// Its token.
    pub token: Option<String>,
    /// How long a worker may be silent.
    pub lease_s: f64,
    /// Servers that keep a copy of each message.
    pub replicas: u8,
}

/// A broker and the store below which its workers render.
pub(crate) struct Engine {
    program: PathBuf,
    store: String,
    options: EngineOptions,
    /// The styles that every worker has.
    styles: BTreeSet<String>,
}

impl Engine {
    pub(crate) fn new(program: &Path, store: &str, options: EngineOptions) -> Self {
        let shipped = Library::embedded();
        let styles = shipped
            .iter()
            .flat_map(Library::models)
            .map(|model| model.name.clone());
        Self {
            program: program.to_owned(),
            store: store.to_owned(),
            options,
            styles: styles.collect(),
        }
    }

    /// Whether any worker can render a job: what it needs comes with the program.
    pub(crate) fn takes(&self, job: &Job) -> bool {
        job.uploaded_scene_ids().is_empty() && job.styles().iter().all(|style| self.styles.contains(style))
    }

    /// Begins the set of a job, or finds that of the same submission.
    pub(crate) async fn submit(&self, order: &Order) -> Result<Accepted, Problem> {
        let input = serde_json::to_vec(order).map_err(|error| Problem::internal(&error))?;
        let said = self.call(&["submit", &self.store], &input).await?;
        serde_json::from_slice(&said).map_err(|error| Problem::internal(&error))
    }

    /// Changes the state of a job's set.
    pub(crate) async fn change(&self, job: &JobRow, state: SetState) -> Result<(), Problem> {
        let set = job.set.as_deref().unwrap_or_default();
        let input = serde_json::to_vec(&state).map_err(|error| Problem::internal(&error))?;
        self.call(&["state", set], &input).await.map(drop)
    }

    /// Has the failed frames of a job's set rendered again.
    pub(crate) async fn retry(&self, job: &JobRow) -> Result<(), Problem> {
        let set = job.set.as_deref().unwrap_or_default();
        self.call(&["retry", set], b"").await.map(drop)
    }

    /// Hides a job's set from every service.
    pub(crate) async fn retire(&self, job: &JobRow) -> Result<(), Problem> {
        let set = job.set.as_deref().unwrap_or_default();
        self.call(&["retire", set], b"").await.map(drop)
    }

    fn command(&self, words: &[&str]) -> Command {
        let EngineOptions {
            url,
            token,
            lease_s,
            replicas,
        } = &self.options;
        let mut command = Command::new(&self.program);
        // In the environment, since other users of the machine can see arguments.
        command
            .arg("jobs")
            .args(words)
            .env_remove("FATHOM_TOKEN")
            .env("FATHOM_ENGINE", url);
        if let Some(token) = token {
            command.env("FATHOM_ENGINE_TOKEN", token);
        }
        if words.first() == Some(&"watch") {
            let (lease, replicas) = (lease_s.to_string(), replicas.to_string());
            command.args(["--lease-s", &lease, "--replicas", &replicas]);
        }
        command
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .kill_on_drop(true);
        command
    }

    /// Runs a command to its end; returns what it writes.
    async fn call(&self, words: &[&str], input: &[u8]) -> Result<Vec<u8>, Problem> {
        let child = self.command(words).spawn();
        let mut child = child.map_err(|error| Problem::internal(&error))?;
        if let Some(mut stdin) = child.stdin.take() {
            // Why it does not read stands in its exit status.
            let _ = stdin.write_all(input).await;
        }
        let ended = child.wait_with_output().await;
        let ended = ended.map_err(|error| Problem::internal(&error))?;
        let said = String::from_utf8_lossy(&ended.stderr);
        let said = said.trim().trim_start_matches("fathom: ");
        match ended.status.code() {
            Some(0) => Ok(ended.stdout),
            Some(2) => Err(Problem::new(Slug::JobState, said)),
            Some(5) => Err(Problem::new(Slug::SetUnreachable, said)),
            _ => Err(Problem::internal(&format!(
                "fathom-cluster jobs {}: {said}",
                words.join(" ")
            ))),
        }
    }
}
