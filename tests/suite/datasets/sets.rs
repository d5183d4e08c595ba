//! A job and the set rendered from it by `fathom`.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};

use fathom_tests::{fathom, root};
use serde_json::Value;

/// A folder with a job and, below it, the set.
pub(crate) struct Work(tempfile::TempDir);

impl Work {
    pub(crate) fn new(job: &Value) -> Self {
        let work = Self(tempfile::tempdir().expect("a temporary folder"));
        work.describe(job);
        work
    }

    pub(crate) fn folder(&self) -> &Path {
        self.0.path()
    }

    pub(crate) fn set(&self) -> PathBuf {
        self.folder().join("set")
    }

    /// Replaces the job.
    pub(crate) fn describe(&self, job: &Value) {
        fs::write(self.folder().join("spec.json"), job.to_string()).expect("a writable folder");
    }

    /// Starts `fathom render` into the set.
    pub(crate) fn start(&self, arguments: &[&str], environment: &[(&str, &str)]) -> Child {
        let mut command = Command::new(fathom());
        command.arg("render").arg(self.folder().join("spec.json"));
        command
            .arg("--out")
            .arg(format!("file://{}", self.set().display()));
        command
            .args(["--slots", "2"])
            .args(arguments)
            .envs(environment.iter().copied());
        let piped = command.stdout(Stdio::piped()).stderr(Stdio::piped());
        piped.current_dir(root()).spawn().expect("the binary starts")
    }

    /// Renders into the set, to the end.
    pub(crate) fn render(&self, arguments: &[&str]) -> Output {
        self.start(arguments, &[])
            .wait_with_output()
            .expect("a child ends")
    }

    /// Runs a command on the set.
    pub(crate) fn command(&self, name: &str, arguments: &[&str]) -> Output {
        let mut command = Command::new(fathom());
        command.arg(name).arg(self.set()).args(arguments);
        command.output().expect("the binary starts")
    }
}

pub(crate) fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten();
    let mut files: Vec<PathBuf> = entries
        .map(|entry| entry.expect("a readable folder").path())
        .collect();
    files.sort();
    files
}

pub(crate) fn marker(set: &Path, shard: u64) -> Value {
    let text = fs::read(set.join(format!("done/{shard:06}.json"))).expect("a marker");
    serde_json::from_slice(&text).expect("JSON")
}

pub(crate) fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}
