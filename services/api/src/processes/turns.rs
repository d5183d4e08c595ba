//! A place for one request at a time. Callers take turns, independent of their number of requests.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use tokio::sync::oneshot;

/// Callers whose turns are remembered.
const KNOWN_CALLERS: usize = 1024;

/// A place for one request at a time.
#[derive(Clone, Default)]
pub(crate) struct Turns(Arc<Mutex<Queue>>);

#[derive(Default)]
struct Queue {
    is_taken: bool,
    /// In order of arrival.
    waiting: Vec<Waiting>,
    /// Number of the last turn of each caller.
    last: HashMap<String, u64>,
    turns: u64,
}

struct Waiting {
    caller: String,
    start: oneshot::Sender<Turn>,
}

/// The place, until it is dropped.
pub(crate) struct Turn(Turns);

impl Turns {
    /// Waits for the place. The caller that has waited longest since its last turn is next.
    pub(crate) async fn take(&self, caller: &str) -> Option<Turn> {
        let (start, started) = oneshot::channel();
        let caller = caller.to_owned();
        self.queue().waiting.push(Waiting { caller, start });
        self.start_next();
        started.await.ok()
    }

    fn start_next(&self) {
        loop {
            let mut queue = self.queue();
            if queue.is_taken {
                return;
            }
            let Some(next) = queue.pop() else { return };
            queue.is_taken = true;
            drop(queue);
            // If its request was dropped, the turn is dropped, which starts the next.
            let unused = next.start.send(Turn(self.clone()));
            if unused.is_ok() {
                return;
            }
        }
    }

    fn queue(&self) -> MutexGuard<'_, Queue> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Queue {
    fn pop(&mut self) -> Option<Waiting> {
        self.waiting.retain(|waiting| !waiting.start.is_closed());
        let turns = self.waiting.iter().enumerate();
        let next = turns.min_by_key(|(place, waiting)| {
            let last = self.last.get(&waiting.caller).copied().unwrap_or(0);
            (last, *place)
        });
        let place = next.map(|(place, _)| place)?;
        let next = self.waiting.remove(place);
        self.turns += 1;
        if self.last.len() == KNOWN_CALLERS {
            self.last.clear();
        }
        self.last.insert(next.caller.clone(), self.turns);
        Some(next)
    }
}

impl Drop for Turn {
    fn drop(&mut self) {
        self.0.queue().is_taken = false;
        self.0.start_next();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn callers_take_turns_and_dropped_requests_lose_theirs() {
        let turns = Turns::default();
        let first = turns.take("a").await.unwrap();
        let (send, mut order) = tokio::sync::mpsc::unbounded_channel();
        let mut waiting = Vec::new();
        for name in ["a1", "a2", "a3", "b1", "b2", "c1"] {
            let (turns, send) = (turns.clone(), send.clone());
            waiting.push(tokio::spawn(async move {
                let turn = turns.take(&name[..1]).await.unwrap();
                send.send(name).unwrap();
                drop(turn);
            }));
            tokio::task::yield_now().await;
        }
        waiting[1].abort();
        tokio::task::yield_now().await;
        drop(first);
        drop(send);
        let mut served = Vec::new();
        while let Some(name) = order.recv().await {
            served.push(name);
        }
        assert_eq!(served, ["b1", "c1", "a1", "b2", "a3"]);
        assert!(!turns.queue().is_taken);
    }
}
