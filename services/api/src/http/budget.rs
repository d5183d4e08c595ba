//! Concurrency budgets: how many requests of a kind may run at the same time, in total and per caller.

use std::collections::HashMap;
use std::net::IpAddr;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use axum::extract::Request;
use tokio::sync::{AcquireError, OwnedSemaphorePermit, Semaphore};
use tokio::time::{Instant, timeout_at};

use crate::http::auth::Caller;
use crate::http::problem::Problem;
use crate::telemetry;

/// One of this many permits is for callers that have no other.
const RESERVED: usize = 8;
/// Callers tracked before idle ones are removed.
const KNOWN_CALLERS: usize = 64;

/// The remote address of a connection.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Peer(pub(crate) IpAddr);

/// Returns the caller that a request counts for: the token, or without tokens the remote address.
pub(crate) fn identify_caller(request: &Request) -> String {
    let caller = request.extensions().get::<Caller>();
    let token = caller.filter(|caller| !caller.is_anonymous());
    match (token, request.extensions().get::<Peer>()) {
        (Some(caller), _) => caller.owner.clone(),
        (None, Some(Peer(address))) => address.to_string(),
        (None, None) => String::new(),
    }
}

/// Concurrency limit for a kind of request. Clones share the permits: a layer is cloned for each route, and the limit
/// must hold over all of them.
#[derive(Clone)]
pub(crate) struct Budget(Arc<Permits>);

struct Permits {
    name: &'static str,
    all: Arc<Semaphore>,
    /// Permits for callers that have no other.
    reserved: Arc<Semaphore>,
    /// Permits of each caller.
    per_caller: usize,
    callers: Mutex<HashMap<String, Arc<Semaphore>>>,
    patience: Duration,
}

/// One or more permits of a budget, released on drop.
pub(crate) struct Permit {
    _own: OwnedSemaphorePermit,
    _all: OwnedSemaphorePermit,
}

/// The share of a budget that one caller may use.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Share {
    pub(crate) percent: usize,
}

impl Budget {
    /// `patience`: how long a request waits for a permit before it is shed.
    pub(crate) fn new(name: &'static str, permits: usize, share: Share, patience: Duration) -> Self {
        let per_caller = (permits * share.percent).div_ceil(100).max(1);
        // Without a place beyond the callers' shares, two callers could fill a small budget.
        let is_shared = (2..permits).contains(&per_caller);
        let reserved = (permits / RESERVED).max(usize::from(is_shared));
        Self(Arc::new(Permits {
            name,
            all: Arc::new(Semaphore::new(permits - reserved)),
            reserved: Arc::new(Semaphore::new(reserved)),
            per_caller,
            callers: Mutex::default(),
            patience,
        }))
    }

    /// Acquires a permit for a caller.
    pub(crate) async fn acquire(&self, caller: &str) -> Result<Permit, Problem> {
        self.acquire_many(caller, 1).await
    }

    /// Acquires several permits together.
    pub(crate) async fn acquire_many(&self, caller: &str, count: u32) -> Result<Permit, Problem> {
        let permits = &*self.0;
        let deadline = Instant::now() + permits.patience;
        let places = permits.find_caller(caller);
        let own = timeout_at(deadline, Arc::clone(&places).acquire_many_owned(count)).await;
        let Ok(Ok(own)) = own else {
            return Err(self.shed(format!(
                "this caller already has {} concurrent {}; retry later",
                permits.per_caller, permits.name
            )));
        };
        let has_no_other = places.available_permits() + count as usize == permits.per_caller;
        let all = timeout_at(deadline, permits.acquire_place(count, has_no_other)).await;
        let Ok(Ok(all)) = all else {
            return Err(self.shed(format!(
                "the limit of concurrent {} is reached; retry later",
                permits.name
            )));
        };
        Ok(Permit { _own: own, _all: all })
    }

    fn shed(&self, detail: String) -> Problem {
        telemetry::shed(self.0.name);
        Problem::overloaded(detail)
    }
}

impl Permits {
    /// Waits for permits of all callers, or for reserved ones.
    async fn acquire_place(
        &self,
        count: u32,
        may_be_reserved: bool,
    ) -> Result<OwnedSemaphorePermit, AcquireError> {
        let common = Arc::clone(&self.all).acquire_many_owned(count);
        if !may_be_reserved {
            return common.await;
        }
        let reserved = Arc::clone(&self.reserved).acquire_many_owned(count);
        tokio::select! {
            biased;
            permit = common => permit,
            permit = reserved => permit,
        }
    }

    /// The permits of a caller.
    fn find_caller(&self, caller: &str) -> Arc<Semaphore> {
        let mut callers = self.callers.lock().unwrap_or_else(PoisonError::into_inner);
        if callers.len() >= KNOWN_CALLERS {
            // A running request keeps a reference.
            callers.retain(|_, permits| Arc::strong_count(permits) > 1);
        }
        let permits = callers.entry(caller.to_owned());
        let permits = permits.or_insert_with(|| Arc::new(Semaphore::new(self.per_caller)));
        Arc::clone(permits)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HALF: Share = Share { percent: 50 };

    async fn is_free(budget: &Budget, caller: &str) -> bool {
        budget.acquire(caller).await.is_ok()
    }

    #[tokio::test(start_paused = true)]
    async fn a_caller_has_its_share_and_leaves_the_rest_to_others() {
        let budget = Budget::new("tests", 4, HALF, Duration::ZERO);
        let held = [budget.acquire("a").await.ok(), budget.acquire("a").await.ok()];
        assert!(held.iter().all(Option::is_some) && !is_free(&budget, "a").await);
        let others = [budget.acquire("b").await.ok(), budget.acquire("c").await.ok()];
        assert!(others.iter().all(Option::is_some) && !is_free(&budget, "d").await);
        drop(held);
        assert!(is_free(&budget, "a").await);
    }

    #[tokio::test(start_paused = true)]
    async fn callers_that_fill_a_budget_leave_a_place_for_others() {
        let budget = Budget::new("tests", 16, HALF, Duration::ZERO);
        let mut held = Vec::new();
        for caller in ["a", "b"] {
            while let Ok(permit) = budget.acquire(caller).await {
                held.push(permit);
            }
        }
        assert_eq!(held.len(), 14, "two of sixteen are reserved");
        let third = budget.acquire("c").await;
        assert!(third.is_ok() && !is_free(&budget, "c").await);
        assert!(budget.acquire("d").await.is_ok());
    }

    #[tokio::test(start_paused = true)]
    async fn two_callers_cannot_fill_a_small_budget() {
        for permits in [4, 6] {
            let budget = Budget::new("tests", permits, HALF, Duration::ZERO);
            let mut held = Vec::new();
            for caller in ["a", "b"] {
                while let Ok(permit) = budget.acquire(caller).await {
                    held.push(permit);
                }
            }
            assert!(is_free(&budget, "c").await, "{} of {permits}", held.len());
        }
    }

    #[tokio::test(start_paused = true)]
    async fn a_request_waits_as_long_as_its_budget_is_patient() {
        let budget = Budget::new("tests", 1, HALF, Duration::from_secs(2));
        let held = budget.acquire("a").await.ok();
        let begun = Instant::now();
        assert!(!is_free(&budget, "a").await);
        assert_eq!(begun.elapsed(), Duration::from_secs(2));
        let waiting = {
            let budget = budget.clone();
            tokio::spawn(async move { is_free(&budget, "a").await })
        };
        tokio::time::sleep(Duration::from_secs(1)).await;
        drop(held);
        assert!(waiting.await.unwrap());
    }

    #[tokio::test]
    async fn idle_callers_are_dropped() {
        let budget = Budget::new("tests", 1000, HALF, Duration::ZERO);
        let kept = budget.acquire("kept").await.ok();
        for caller in 0..10 * KNOWN_CALLERS {
            assert!(is_free(&budget, &caller.to_string()).await);
        }
        let callers = budget.0.callers.lock().unwrap();
        assert!(callers.len() <= KNOWN_CALLERS + 1 && callers.contains_key("kept"));
        assert!(kept.is_some());
    }
}
