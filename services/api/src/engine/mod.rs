//! Jobs rendered into sets by the workers of a broker.
//!
//! `fathom child jobs` processes talk to broker and store. The store is authoritative for these jobs: each is a set
//! `STORE/JOB` visible to every service of the store, and the catalogue indexes it.

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

/// The broker that distributes shards to workers.
#[derive(Debug, Clone)]
pub struct EngineOptions {
    /// Addresses, separated by commas; they may contain secrets.
    pub url: String,
    /// Authentication token.
    pub token: Option<String>,
    /// Seconds without a heartbeat before a shard is reassigned.
    pub lease_s: f64,
    /// Number of servers that store each message.
    pub replicas: u8,
}

/// A broker, and the store that its workers render into.
pub(crate) struct Engine {
    program: PathBuf,
    store: String,
    options: EngineOptions,
    /// The styles available to every worker.
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

    /// Whether any worker can render a job: only built-in resources are used.
    pub(crate) fn takes(&self, job: &Job) -> bool {
        job.uploaded_scene_ids().is_empty() && job.models().iter().all(|style| self.styles.contains(style))
    }

    /// Creates the set of a job, or finds the set of an earlier submission with the same key.
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

    /// Renders the failed frames of a job's set again.
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
        // Passed by environment, because other users can see arguments.
        command
            .args(["child", "jobs"])
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

    /// Runs a command and returns its output.
    async fn call(&self, words: &[&str], input: &[u8]) -> Result<Vec<u8>, Problem> {
        let child = self.command(words).spawn();
        let mut child = child.map_err(|error| Problem::internal(&error))?;
        if let Some(mut stdin) = child.stdin.take() {
            // The exit status reports why the child did not read.
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
                "fathom child jobs {}: {said}",
                words.join(" ")
            ))),
        }
    }
}
