//! The process that reads a set: `fathom child shards`.

use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::sync::Arc;
use std::time::{Duration, Instant};

use catalogue::{Catalogue, NewImage, NewShard};
use futures::stream::{self, Stream, StreamExt};
use tokio::io::{AsyncBufReadExt, AsyncReadExt, AsyncWriteExt, BufReader};
use tokio::process::{Child, ChildStdout, Command};
use tokio::sync::{Semaphore, SemaphorePermit};
use tokio::task::JoinHandle;

use super::conformity::SetJob;
use super::feed::{Known, Line, SetHead, SetPart};
use super::intake::{Intake, prepare};
use super::look_error::LookError;
use crate::processes::child::{Allowance, beginning, exceeded};

/// The command of the process.
const COMMAND: [&str; 2] = ["child", "shards"];
/// Maximum sets read concurrently: each uses all cores of the machine and a few hundred megabytes.
const READERS: usize = 2;
/// Maximum length of a line: some hundred images with records of some tens of kilobytes.
const LINE_BYTES: u64 = 64 << 20;
/// Longest wait for a line: a shard of a hundred megabytes over a slow connection.
const LINE: Duration = Duration::from_secs(120);
/// Longest reading; the next one continues after the stored shards.
const READING: Duration = Duration::from_secs(3600);
/// Most memory of a reader, several times that of a machine with many cores and large shards.
const MEMORY_BYTES: u64 = 2 << 30;
/// Lines prepared in parallel while one is stored.
const PREPARED: usize = 2;

/// Starts processes that read sets.
pub(crate) struct Reader {
    program: PathBuf,
    /// Sets outside these locations are rejected.
    stores: Vec<String>,
    places: Semaphore,
}

/// A set being read. The process is killed when this is dropped.
pub(crate) struct Reading<'r> {
    child: Child,
    lines: BufReader<ChildStdout>,
    said: Option<JoinHandle<String>>,
    begun: Instant,
    _place: SemaphorePermit<'r>,
}

/// Images ready to store.
pub(crate) struct Prepared {
    pub(crate) images: Vec<NewImage>,
    pub(crate) shard: NewShard,
}

impl Reader {
    pub(crate) fn new(program: &Path, stores: &[String]) -> Self {
        Self {
            program: program.to_owned(),
            stores: stores.to_vec(),
            places: Semaphore::new(READERS),
        }
    }

    /// Opens a set and reads its head.
    pub(crate) async fn open(&self, set: &str) -> Result<(SetHead, Reading<'_>), LookError> {
        let place = self.places.acquire().await;
        let place = place.map_err(|error| LookError::Later(error.to_string()))?;
        let mut command = Command::new(&self.program);
        command.args(COMMAND);
        for store in &self.stores {
            command.args(["--below", store]);
        }
        let mut child = command
            .args(["--", set])
            .env_remove("FATHOM_TOKEN")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .kill_on_drop(true)
            .spawn()
            .map_err(|error| LookError::Later(format!("cannot start {}: {error}", self.program.display())))?;
        let said = tokio::spawn(beginning(child.stderr.take()));
        let lines = child
            .stdout
            .take()
            .ok_or_else(|| LookError::Later("the reader has no output".to_owned()))?;
        let mut reading = Reading {
            lines: BufReader::new(lines),
            child,
            said: Some(said),
            begun: Instant::now(),
            _place: place,
        };
        let first = reading.line().await?.unwrap_or_default();
        match serde_json::from_slice(&first) {
            Ok(Line::Set(head)) => Ok((head, reading)),
            _ => Err(LookError::Damaged(
                "the reader sent no head of the set".to_owned(),
            )),
        }
    }
}

impl Reading<'_> {
    /// Requests the unknown shards; returns them in order.
    pub(crate) async fn ask(
        &mut self,
        known: &Known,
        catalogue: &Arc<Catalogue>,
        intake: &Intake<'_>,
    ) -> Result<impl Stream<Item = Result<Prepared, LookError>>, LookError> {
        let mut line = serde_json::to_vec(known).map_err(|error| LookError::Damaged(error.to_string()))?;
        line.push(b'\n');
        if let Some(mut stdin) = self.child.stdin.take() {
            // The exit status of an ended reader reports the reason.
            let _ = stdin.write_all(&line).await;
        }
        let lines = stream::unfold(Some(self), async |reading| {
            let reading = reading?;
            match reading.line().await {
                Ok(Some(line)) => Some((Ok(line), Some(reading))),
                Ok(None) => None,
                Err(error) => Some((Err(error), None)),
            }
        });
        let (catalogue, id, job) = (Arc::clone(catalogue), intake.id().to_owned(), intake.job());
        let prepared = lines.map(move |line| {
            let (catalogue, id, job) = (Arc::clone(&catalogue), id.clone(), Arc::clone(&job));
            async move {
                let line = line?;
                let prepared = tokio::task::spawn_blocking(move || part(&catalogue, &id, &job, &line));
                prepared
                    .await
                    .unwrap_or_else(|error| Err(LookError::Damaged(error.to_string())))
            }
        });
        Ok(prepared.buffered(PREPARED))
    }

    /// The next line; `None` when the reader has ended successfully. A reader beyond its limits is killed when this
    /// reading is dropped.
    async fn line(&mut self) -> Result<Option<Vec<u8>>, LookError> {
        let left = READING.saturating_sub(self.begun.elapsed());
        let allowance = Allowance {
            time: LINE,
            memory_bytes: MEMORY_BYTES,
        };
        let id = self.child.id();
        tokio::select! {
            // A line that arrived in time counts, even if storing the previous one took longer.
            biased;
            line = self.next_line() => line,
            _ = tokio::time::sleep(left) => Err(LookError::Later(format!(
                "reading is stopped after {} min and continues later", READING.as_secs() / 60
            ))),
            reason = exceeded(id, allowance) => {
                Err(LookError::Damaged(format!("the reader of the set was stopped: {reason}")))
            }
        }
    }

    async fn next_line(&mut self) -> Result<Option<Vec<u8>>, LookError> {
        let mut line = Vec::new();
        let mut limited = (&mut self.lines).take(LINE_BYTES);
        let read = limited.read_until(b'\n', &mut line).await;
        let read = read.map_err(|error| LookError::Later(error.to_string()))?;
        if line.ends_with(b"\n") {
            return Ok(Some(line));
        }
        if read as u64 == LINE_BYTES {
            let reason = format!("a line of the reader is longer than {LINE_BYTES} bytes");
            return Err(LookError::Damaged(reason));
        }
        self.ended().await.map(|()| None)
    }

    async fn ended(&mut self) -> Result<(), LookError> {
        let status = self.child.wait().await;
        let status = status.map_err(|error| LookError::Later(error.to_string()))?;
        let said = match self.said.take() {
            Some(said) => said.await.unwrap_or_default(),
            None => String::new(),
        };
        let said = said.trim().trim_start_matches("fathom: ").to_owned();
        match status.code() {
            Some(0) => Ok(()),
            Some(2) => Err(LookError::Refused(said)),
            Some(5) => Err(LookError::Later(said)),
            Some(1) => Err(LookError::Damaged(said)),
            _ => Err(LookError::Later(format!(
                "the reader ended with {status}: {said}"
            ))),
        }
    }
}

fn part(catalogue: &Catalogue, id: &str, job: &SetJob, line: &[u8]) -> Result<Prepared, LookError> {
    match serde_json::from_slice(line) {
        Ok(Line::Part(SetPart { images, shard })) => Ok(Prepared {
            images: prepare(catalogue, id, job, images)?,
            shard,
        }),
        Ok(Line::Set(_)) => Err(LookError::Damaged(
            "the reader sent two heads of the set".to_owned(),
        )),
        Err(error) => Err(LookError::Damaged(format!("a line of the reader: {error}"))),
    }
}
