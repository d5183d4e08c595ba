//! A message being processed by a worker, until its verdict.

use std::sync::Arc;
use std::time::Duration;

use async_nats::jetstream::{AckKind, Message};
use tokio::runtime::Runtime;
use tokio::task::JoinHandle;

use super::error::BrokerError;
use super::task::Task;

/// Progress signals per acknowledgment timeout.
const BEATS: u32 = 4;

/// The verdict on a task.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Verdict {
    /// Its shard has a marker or is no longer needed.
    Done,
    /// Any worker may retry after this time.
    Again(Duration),
    /// A retry is useless.
    Hopeless,
}

/// A message that a worker processes; it signals progress to the broker until the verdict.
pub(crate) struct Delivery {
    runtime: Arc<Runtime>,
    message: Arc<Message>,
    beat: JoinHandle<()>,
}

impl Delivery {
    pub(super) fn new(runtime: Arc<Runtime>, message: Message, ack_wait: Duration) -> Self {
        let message = Arc::new(message);
        let alive = Arc::clone(&message);
        let beat = runtime.spawn(async move {
            loop {
                tokio::time::sleep(ack_wait / BEATS).await;
                // If the broker is unavailable, the marker still counts; the redelivered message finds it.
                let _ = alive.ack_with(AckKind::Progress).await;
            }
        });
        Self {
            runtime,
            message,
            beat,
        }
    }

    /// The task of the message; `None` for a foreign message.
    pub(crate) fn task(&self) -> Option<Task> {
        serde_json::from_slice(&self.message.payload).ok()
    }

    /// Sends the verdict to the broker and waits for its confirmation.
    pub(crate) fn settle(self, verdict: Verdict) -> Result<(), BrokerError> {
        self.beat.abort();
        let kind = match verdict {
            Verdict::Done => AckKind::Ack,
            Verdict::Again(delay) => AckKind::Nak(Some(delay).filter(|delay| !delay.is_zero())),
            Verdict::Hopeless => AckKind::Term,
        };
        let told = self.runtime.block_on(self.message.double_ack_with(kind));
        told.map_err(BrokerError::new)
    }
}

impl Drop for Delivery {
    fn drop(&mut self) {
        self.beat.abort();
    }
}
