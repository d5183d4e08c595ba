//! Worker processes.

use std::process::{Child, Command};

use crate::{fathom, root, stop};

/// A `fathom worker` of a service; stops when dropped.
pub struct Worker {
    pub(crate) child: Child,
}

impl Worker {
    /// Starts a worker process.
    ///
    /// # Panics
    /// If the binary cannot be started.
    #[must_use]
    pub fn start(url: &str, name: &str, slots: usize) -> Self {
        Self::start_with(url, name, slots, &[])
    }

    /// As [`Worker::start`], with extra environment variables.
    ///
    /// # Panics
    /// If the binary cannot be started.
    #[must_use]
    pub fn start_with(url: &str, name: &str, slots: usize, environment: &[(&str, &str)]) -> Self {
        let child = Command::new(fathom())
            .args([
                "worker",
                "--server",
                url,
                "--name",
                name,
                "--slots",
                &slots.to_string(),
            ])
            .env_remove("FATHOM_TOKEN")
            .env("FATHOM_LOG", "warn")
            .envs(environment.iter().copied())
            .current_dir(root())
            .spawn()
            .expect("the binary starts");
        Self { child }
    }

    /// SIGSTOP or SIGCONT.
    ///
    /// # Panics
    /// If the process cannot be signaled.
    pub fn signal(&self, name: &str) {
        let arguments = [format!("-{name}"), self.child.id().to_string()];
        let status = Command::new("kill").args(arguments).status();
        assert!(
            status.is_ok_and(|status| status.success()),
            "no {name} for the worker"
        );
    }

    /// SIGKILL, as sent by an out-of-memory killer.
    ///
    /// # Panics
    /// If the process cannot be killed.
    pub fn kill(mut self) {
        self.child.kill().expect("a worker can be killed");
        self.child.wait().expect("a killed worker ends");
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        stop(&mut self.child);
    }
}
