//! Supervises `fathom child jobs watch`, the process that watches the store and fills the broker.

use std::time::Duration;

use tokio::io::{AsyncBufReadExt, BufReader};
use tokio::process::Child;
use tokio::sync::mpsc::Sender;

use super::Engine;
use super::orders::Event;

/// Pause before restarting the process.
const PAUSE: Duration = Duration::from_secs(1);

impl Engine {
    /// Watches until the receiver is dropped.
    pub(crate) async fn watch(&self, seen: &Sender<Event>) {
        while !seen.is_closed() {
            match self.command(&["watch", &self.store]).spawn() {
                Ok(child) => self.follow(child, seen).await,
                Err(error) => tracing::error!(%error, "the process that watches the store cannot be started"),
            }
            tokio::time::sleep(PAUSE).await;
        }
    }

    /// Forwards the events of a child until it exits. Its standard input stays open, so that it ends with the
    /// service.
    async fn follow(&self, mut child: Child, seen: &Sender<Event>) {
        let _stdin = child.stdin.take();
        if let Some(stderr) = child.stderr.take() {
            tokio::spawn(async move {
                let mut lines = BufReader::new(stderr).lines();
                while let Ok(Some(line)) = lines.next_line().await {
                    tracing::warn!("store and broker: {line}");
                }
            });
        }
        let Some(stdout) = child.stdout.take() else { return };
        let mut lines = BufReader::new(stdout).lines();
        while let Ok(Some(line)) = lines.next_line().await {
            match serde_json::from_str::<Event>(&line) {
                Ok(event) => {
                    if seen.send(event).await.is_err() {
                        return;
                    }
                }
                Err(error) => {
                    tracing::error!(%error, "unreadable line of the process that watches the store")
                }
            }
        }
        let _ = seen.send(Event::Workers(Vec::new())).await;
        let status = child.wait().await;
        tracing::warn!(
            ?status,
            "the process that watches the store ended and is restarted"
        );
    }
}
