//! Runs the real `fathom` binary for end-to-end tests: services, workers and single commands.

mod audit;
mod commands;
mod dice;
pub mod ending;
pub mod forms;
pub mod memory;
pub mod onnx;
mod points;
pub mod scripted;
mod worker;

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc;
use std::time::{Duration, Instant};

pub use audit::{audit, audit_answers, compile};
pub use dice::Dice;
pub use points::{SERVICE_POINTS, SMALL_JOB_FRAMES, small_job};
pub use worker::Worker;

pub use commands::{digest_by_render, fathom, muddy_photo, root, run, run_in_columns, run_lab};

use client::{Http, HttpError, Reply};
use serde_json::Value;

/// Startup limit of a service: migrations and worker start on a loaded machine.
const START_LIMIT: Duration = Duration::from_secs(60);
/// Limit for one request.
const REQUEST_LIMIT: Duration = Duration::from_secs(120);
/// Limit for a job of a few dozen small frames on a loaded machine.
const JOB_LIMIT: Duration = Duration::from_secs(300);

/// A running `fathom serve` on a free port; stops when dropped.
pub struct Service {
    pub(crate) child: Child,
    /// `http://127.0.0.1:…`
    pub url: String,
}

impl Service {
    /// Starts a service over a data folder and waits until it listens.
    ///
    /// # Panics
    /// If it does not listen in time; the message contains its output.
    #[must_use]
    pub fn start(data: &Path, arguments: &[&str]) -> Self {
        Self::start_with(data, arguments, &[])
    }

    /// As [`Service::start`], with extra environment variables for the service and its workers.
    ///
    /// # Panics
    /// If it does not listen in time; the message contains its output.
    #[must_use]
    pub fn start_with(data: &Path, arguments: &[&str], environment: &[(&str, &str)]) -> Self {
        Self::launch(data, arguments, environment).unwrap_or_else(|printed| {
            panic!("the service does not listen; it printed:\n{printed}");
        })
    }

    /// As [`Service::start`], but returns an error if the service refuses to start.
    ///
    /// # Errors
    /// The output of the service.
    ///
    /// # Panics
    /// If the binary cannot be started.
    pub fn launch(data: &Path, arguments: &[&str], environment: &[(&str, &str)]) -> Result<Self, String> {
        let mut child = Command::new(fathom())
            .args(["serve", "--listen", "127.0.0.1:0", "--data"])
            .arg(data)
            .args(arguments)
            .env_remove("FATHOM_TOKEN")
            .env("FATHOM_LOG", "warn")
            .envs(environment.iter().copied())
            .current_dir(root())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the binary starts");
        let (sender, receiver) = mpsc::channel();
        let lines = BufReader::new(child.stderr.take().expect("stderr is piped")).lines();
        std::thread::spawn(move || {
            lines
                .map_while(Result::ok)
                .for_each(|line| drop(sender.send(line)))
        });
        let mut printed = Vec::new();
        let begun = Instant::now();
        while begun.elapsed() < START_LIMIT {
            match receiver.recv_timeout(Duration::from_millis(100)) {
                Ok(line) => {
                    if let Some(url) = line.strip_prefix("fathom listens on ") {
                        let url = url.to_owned();
                        std::thread::spawn(move || {
                            receiver.iter().for_each(|line| eprintln!("service: {line}"))
                        });
                        return Ok(Self { child, url });
                    }
                    printed.push(line);
                }
                Err(mpsc::RecvTimeoutError::Timeout) => {}
                Err(mpsc::RecvTimeoutError::Disconnected) => break,
            }
        }
        let _ = child.kill();
        let _ = child.wait();
        Err(printed.join("\n"))
    }

    /// Sends SIGKILL and waits for the end.
    ///
    /// # Panics
    /// If the process cannot be killed.
    pub fn kill(mut self) {
        // It may have ended already.
        let _ = self.child.kill();
        self.child.wait().expect("a killed service ends");
    }

    /// Whether the process is still running.
    #[must_use]
    pub fn is_alive(&mut self) -> bool {
        matches!(self.child.try_wait(), Ok(None))
    }

    /// Submits a job under an idempotency key; returns its id, or `None` if the service died before its response.
    #[must_use]
    pub fn try_submit(&self, job: &Value, key: &str) -> Option<String> {
        let headers = [("content-type", "application/json"), ("idempotency-key", key)];
        let reply = self.http().post("/v1/jobs?again=true", &headers, job.to_string());
        let body: Value = serde_json::from_slice(&reply.ok()?.bytes).ok()?;
        body["id"].as_str().map(str::to_owned)
    }

    /// GET of an existing resource; `None` if the service dies meanwhile.
    #[must_use]
    pub fn try_get(&self, path: &str) -> Option<Value> {
        serde_json::from_slice(&self.http().get(path).ok()?.bytes).ok()
    }

    /// POST of any bytes; returns the status, or `None` if the service dies meanwhile.
    #[must_use]
    pub fn try_post_bytes(&self, path: &str, body: &[u8]) -> Option<u16> {
        match self.http().post(path, &[], body) {
            Ok(reply) => Some(reply.status.as_u16()),
            Err(HttpError::Problem(problem)) => Some(problem.status.as_u16()),
            Err(HttpError::Unreachable(_)) => None,
        }
    }

    /// GET, as JSON with its status.
    ///
    /// # Panics
    /// If the service does not respond.
    #[must_use]
    pub fn get(&self, path: &str) -> (u16, Value) {
        read_json(self.http().get(path))
    }

    /// GET, as bytes with the status; of a problem, its document.
    ///
    /// # Panics
    /// If the service does not respond.
    #[must_use]
    pub fn get_bytes(&self, path: &str) -> (u16, Vec<u8>) {
        match self.http().get(path) {
            Ok(reply) => (reply.status.as_u16(), reply.bytes),
            Err(HttpError::Problem(problem)) => (
                problem.status.as_u16(),
                problem.document().to_string().into_bytes(),
            ),
            Err(HttpError::Unreachable(error)) => panic!("GET {path}: {error}"),
        }
    }

    /// POST of JSON.
    ///
    /// # Panics
    /// If the service does not respond.
    #[must_use]
    pub fn post(&self, path: &str, body: &Value) -> (u16, Value) {
        let headers = [("content-type", "application/json")];
        read_json(self.http().post(path, &headers, body.to_string()))
    }

    /// DELETE, as JSON with its status.
    ///
    /// # Panics
    /// If the service does not respond.
    #[must_use]
    pub fn delete(&self, path: &str) -> (u16, Value) {
        read_json(self.http().delete(path))
    }

    pub(crate) fn http(&self) -> Http {
        Http::new(&self.url, None, REQUEST_LIMIT)
    }

    /// Submits a job that must be accepted.
    ///
    /// # Panics
    /// If it is not accepted.
    #[must_use]
    pub fn submit(&self, job: &Value) -> String {
        let (status, body) = self.post("/v1/jobs", job);
        assert_eq!(status, 202, "{body}");
        body["id"].as_str().expect("a job has an id").to_owned()
    }

    /// Waits for a job to end and returns it.
    ///
    /// # Panics
    /// If it does not end in time.
    #[must_use]
    pub fn finished(&self, job: &str) -> Value {
        let begun = Instant::now();
        let mut since = 0;
        while begun.elapsed() < JOB_LIMIT {
            let (status, body) = self.get(&format!("/v1/jobs/{job}?wait=10&since={since}"));
            assert_eq!(status, 200, "{body}");
            since = body["version"].as_u64().unwrap_or_default();
            if matches!(
                body["state"].as_str(),
                Some("done" | "done_with_failures" | "cancelled")
            ) {
                return body;
            }
        }
        panic!("job {job} did not end within {JOB_LIMIT:?}");
    }
}

impl Drop for Service {
    fn drop(&mut self) {
        stop(&mut self.child);
    }
}

/// SIGTERM, then SIGKILL after 15 s.
pub(crate) fn stop(child: &mut Child) {
    if matches!(child.try_wait(), Ok(Some(_))) {
        return;
    }
    let _ = Command::new("kill")
        .args(["-TERM", &child.id().to_string()])
        .status();
    let begun = Instant::now();
    while begun.elapsed() < Duration::from_secs(15) {
        if matches!(child.try_wait(), Ok(Some(_))) {
            return;
        }
        std::thread::sleep(Duration::from_millis(20));
    }
    let _ = child.kill();
    let _ = child.wait();
}

/// The status and the document of a response; null if it is not JSON.
///
/// # Panics
/// If there is no response.
pub(crate) fn read_json(response: Result<Reply, HttpError>) -> (u16, Value) {
    match response {
        Ok(reply) => {
            let document = serde_json::from_slice(&reply.bytes).unwrap_or_default();
            (reply.status.as_u16(), document)
        }
        Err(HttpError::Problem(problem)) => (problem.status.as_u16(), problem.document().clone()),
        Err(HttpError::Unreachable(error)) => panic!("the service does not respond: {error}"),
    }
}
