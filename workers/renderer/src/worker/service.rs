//! The service as the worker's threads see it: plain messages, and a membership that is renewed when it is forgotten.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::Duration;

use super::client::{Client, ClientError};
use proto::message::{Beat, BeatOf, Lease, Register, Registered, Release, Style, WantLease};
use proto::wire;
use spec::SceneFiles;

use super::patience::pause_after;

/// How long the service may hold a request for a lease. Short, so that a stop does not wait for it.
const LEASE_WAIT_MS: u32 = 2000;

type Answer<T> = Result<T, ClientError>;

/// A service that this worker has joined.
pub(crate) struct Service {
    client: Client,
    about: Register,
    membership: Mutex<Registered>,
}

impl Service {
    /// Joins; waits for a service that is away. `None`: told to stop before that.
    pub(crate) fn join(client: Client, about: Register, stop: &AtomicBool) -> Answer<Option<Self>> {
        let mut tries = 0;
        while !stop.load(Ordering::SeqCst) {
            match register(&client, &about) {
                Ok(membership) => {
                    return Ok(Some(Self {
                        client,
                        about,
                        membership: Mutex::new(membership),
                    }));
                }
                Err(ClientError::Unavailable { reason }) => {
                    if tries == 0 {
                        tracing::warn!(reason, "waiting for the service");
                    }
                    tries += 1;
                    thread::sleep(pause_after(tries));
                }
                Err(error) => return Err(error),
            }
        }
        Ok(None)
    }

    /// `wrk_…`.
    pub(crate) fn worker_id(&self) -> String {
        self.membership().worker_id.clone()
    }

    /// How often to beat.
    pub(crate) fn beat_interval(&self) -> Duration {
        Duration::from_millis(self.membership().beat_ms.into())
    }

    /// Joins again under a new id, unless another thread has done so since `forgotten` was the id.
    pub(crate) fn rejoin(&self, forgotten: &str) -> Answer<()> {
        let mut membership = self.membership();
        if membership.worker_id == forgotten {
            *membership = register(&self.client, &self.about)?;
            tracing::info!(
                worker = membership.worker_id,
                was = forgotten,
                "joined the service again"
            );
        }
        Ok(())
    }

    /// Asks for frames; waits a moment for them.
    pub(crate) fn lease(&self, worker_id: &str, frame_ms: f64) -> Answer<Option<Lease>> {
        let want = WantLease {
            worker_id: worker_id.to_owned(),
            wait_ms: LEASE_WAIT_MS,
            frame_ms,
        };
        let answer = self.client.lease(&want.into())?;
        answer
            .lease
            .map(|lease| checked(Lease::try_from(lease)))
            .transpose()
    }

    /// Says that these leases are still worked on.
    pub(crate) fn beat(&self, worker_id: &str, tokens: Vec<u64>) -> Answer<Beat> {
        let beat = BeatOf {
            worker_id: worker_id.to_owned(),
            tokens,
        };
        Ok(self.client.beat(&beat.into())?.into())
    }

    /// Stores files.
    pub(crate) fn put(&self, files: &wire::PutArtifactsRequest) -> Answer<()> {
        self.client.put_artifacts(files).map(drop)
    }

    /// Makes an image visible; returns whether it was there already.
    pub(crate) fn commit(&self, commit: &wire::CommitRequest) -> Answer<bool> {
        Ok(self.client.commit(commit)?.already_there)
    }

    /// Reports a failure.
    pub(crate) fn fail(&self, fail: &wire::FailRequest) -> Answer<()> {
        self.client.fail(fail).map(drop)
    }

    /// Hands a lease back.
    pub(crate) fn release(&self, token: u64, reason: &str) -> Answer<()> {
        let release = Release {
            token,
            reason: reason.to_owned(),
        };
        self.client.release(&release.into()).map(drop)
    }

    /// The canonical description of a job.
    pub(crate) fn description(&self, job: &str) -> Answer<Vec<u8>> {
        self.client.description(job)
    }

    /// What an uploaded scene is made of.
    pub(crate) fn scene(&self, id: &str) -> Answer<SceneFiles<String>> {
        checked(SceneFiles::try_from(self.client.scene(id)?))
    }

    /// The style models that jobs may name.
    pub(crate) fn styles(&self) -> Answer<Vec<Style>> {
        checked(Vec::<Style>::try_from(self.client.styles()?))
    }

    /// The ONNX file of a style model.
    pub(crate) fn style(&self, name: &str) -> Answer<Vec<u8>> {
        self.client.style(name)
    }

    /// Stored bytes.
    pub(crate) fn blob(&self, digest: &str) -> Answer<Vec<u8>> {
        self.client.blob(digest)
    }

    fn membership(&self) -> MutexGuard<'_, Registered> {
        self.membership.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

fn register(client: &Client, about: &Register) -> Answer<Registered> {
    checked(Registered::try_from(client.register(&about.clone().into())?))
}

/// An answer that makes no sense is as good as a refusal: it would be the same next time.
fn checked<T>(message: Result<T, proto::MessageError>) -> Answer<T> {
    message.map_err(|error| ClientError::Refused {
        status: 200,
        problem: error.to_string(),
    })
}
