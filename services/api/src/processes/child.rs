//! Work that may hang, exhaust memory or abort, in a separate process.

use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::Duration;

use tokio::io::{AsyncRead, AsyncReadExt};
use tokio::process::{Child, Command};
use tokio::sync::Semaphore;

use crate::http::problem::Problem;

/// Interval of measuring a child's memory.
const LOOK: Duration = Duration::from_millis(50);
/// Maximum kept bytes of a child's standard error.
const TAIL_BYTES: usize = 4096;
/// Exit status for unusable input.
const BAD_INPUT: i32 = 2;
/// Exit status for a missing runtime.
const RUNTIME_MISSING: i32 = 4;

/// Resource limits of a child.
#[derive(Clone, Copy)]
pub(crate) struct Allowance {
    pub(crate) time: Duration,
    pub(crate) memory_bytes: u64,
}

/// How a child ended.
pub(crate) enum Ended {
    Well,
    /// It rejected its input, with this message.
    Refused(String),
    /// A runtime is missing; how to install it.
    Lacking(String),
    /// It was killed for exceeding its limits, or died; description.
    Badly(String),
}

/// Starts children, a few at a time.
pub(crate) struct Children {
    program: PathBuf,
    /// Options for ONNX Runtime and styles.
    options: Vec<(&'static str, PathBuf)>,
    places: Semaphore,
}

impl Children {
    pub(crate) fn new(program: &Path, options: Vec<(&'static str, PathBuf)>, places: usize) -> Self {
        Self {
            program: program.to_owned(),
            options,
            places: Semaphore::new(places),
        }
    }

    /// Runs `PROGRAM COMMAND ARGUMENTS` to its end. It is killed when this future is dropped.
    pub(crate) async fn run(
        &self,
        command: &str,
        arguments: &[&OsStr],
        allowance: Allowance,
    ) -> Result<Ended, Problem> {
        let place = self.places.acquire().await;
        let _place = place.map_err(|error| Problem::internal(&error))?;
        let mut process = Command::new(&self.program);
        process.arg(command).args(arguments);
        for (option, path) in &self.options {
            process.arg(option).arg(path);
        }
        // Its input stays open as long as this service lives, so that it does not outlive it.
        process.arg("--end-with-stdin").stdin(Stdio::piped());
        let child = process
            .env_remove("FATHOM_TOKEN")
            .env("NO_COLOR", "1")
            .stdout(Stdio::null())
            .stderr(Stdio::piped())
            .kill_on_drop(true)
            .spawn();
        let child = child.map_err(|error| Problem::internal(&error))?;
        Ok(watched(child, allowance).await)
    }
}

async fn watched(mut child: Child, allowance: Allowance) -> Ended {
    let said = tokio::spawn(beginning(child.stderr.take()));
    // Waiting would close it.
    let _input = child.stdin.take();
    let id = child.id();
    let verdict = tokio::select! {
        status = child.wait() => status.map_err(|error| error.to_string()),
        verdict = exceeded(id, allowance) => Err(verdict),
    };
    match verdict {
        Ok(status) => {
            let said = said.await.unwrap_or_default();
            let said = said.trim().trim_start_matches("fathom: ").to_owned();
            match status.code() {
                Some(0) => Ended::Well,
                Some(BAD_INPUT) => Ended::Refused(said),
                Some(RUNTIME_MISSING) => Ended::Lacking(said),
                _ => Ended::Badly(format!("it ended with {status}: {said}")),
            }
        }
        Err(reason) => {
            let _ = child.kill().await;
            Ended::Badly(reason)
        }
    }
}

/// Waits until a child exceeds its limits; returns which one.
pub(crate) async fn exceeded(id: Option<u32>, allowance: Allowance) -> String {
    let looking = async {
        loop {
            tokio::time::sleep(LOOK).await;
            let taken = id.and_then(resident_bytes).unwrap_or(0);
            if taken > allowance.memory_bytes {
                return format!("it took more than {} MiB of memory", allowance.memory_bytes >> 20);
            }
        }
    };
    tokio::time::timeout(allowance.time, looking)
        .await
        .unwrap_or_else(|_| format!("it took longer than {} s", allowance.time.as_secs()))
}

fn resident_bytes(id: u32) -> Option<u64> {
    let status = std::fs::read_to_string(format!("/proc/{id}/status")).ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmRSS:"))?;
    let kib: u64 = line.trim().trim_end_matches("kB").trim().parse().ok()?;
    Some(kib << 10)
}

/// The beginning of a pipe's data. The rest is read and dropped, so that the child never blocks on it.
pub(crate) async fn beginning(pipe: Option<impl AsyncRead + Unpin>) -> String {
    let Some(mut pipe) = pipe else {
        return String::new();
    };
    let mut kept = Vec::new();
    let mut buffer = [0; 1024];
    while let Ok(length @ 1..) = pipe.read(&mut buffer).await {
        let room = TAIL_BYTES.saturating_sub(kept.len()).min(length);
        kept.extend_from_slice(&buffer[..room]);
    }
    String::from_utf8_lossy(&kept).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    async fn run(script: &str, time: Duration, memory_bytes: u64) -> Ended {
        let children = Children::new(Path::new("/bin/sh"), Vec::new(), 1);
        let allowance = Allowance { time, memory_bytes };
        let ended = children.run("-c", &[OsStr::new(script)], allowance).await;
        ended.unwrap_or_else(|problem| panic!("{problem}"))
    }

    const LONG: Duration = Duration::from_secs(60);

    #[tokio::test]
    async fn a_child_ends_well_refuses_dies_or_is_ended() {
        assert!(matches!(run("exit 0", LONG, 1 << 30).await, Ended::Well));
        let refused = run("echo 'fathom: no' >&2; exit 2", LONG, 1 << 30).await;
        assert!(matches!(refused, Ended::Refused(text) if text == "no"));
        let lacking = run("echo no runtime >&2; exit 4", LONG, 1 << 30).await;
        assert!(matches!(lacking, Ended::Lacking(text) if text == "no runtime"));
        let died = run("kill -ABRT $$", LONG, 1 << 30).await;
        assert!(matches!(died, Ended::Badly(text) if text.contains("signal: 6")));
        let late = run("sleep 60", Duration::from_millis(300), 1 << 30).await;
        assert!(matches!(late, Ended::Badly(text) if text.contains("longer than")));
        let greedy = run("exec tail /dev/zero", LONG, 64 << 20).await;
        assert!(matches!(greedy, Ended::Badly(text) if text.contains("64 MiB")));
    }
}
