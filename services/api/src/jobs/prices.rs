//! Limits on the price of frames and of the open jobs of a caller.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use catalogue::Price;
use spec::Frame;

use crate::http::problem::{Problem, Slug};
use crate::leases::costs::Cost;
use crate::leases::table::OpenCost;
use crate::limits::PriceLimits;

/// Sampled descriptions kept for repeated submissions.
const KEPT_SAMPLES: usize = 64;

/// A sampled frame and its number of pixels.
pub(super) struct SampledFrame {
    pub(super) frame: Frame,
    pub(super) pixels: f64,
}

/// The limits, the sampled descriptions, and submissions that are not yet in the lease table.
pub(crate) struct Prices {
    pub(super) limits: PriceLimits,
    samples: Mutex<HashMap<String, Arc<Vec<SampledFrame>>>>,
    pending: Mutex<HashMap<String, OpenCost>>,
}

impl Prices {
    pub(crate) fn new(limits: PriceLimits) -> Self {
        Self {
            limits,
            samples: Mutex::default(),
            pending: Mutex::default(),
        }
    }

    pub(super) fn sample(&self, digest: &str) -> Option<Arc<Vec<SampledFrame>>> {
        self.samples().get(digest).cloned()
    }

    pub(super) fn keep_sample(&self, digest: &str, sample: Arc<Vec<SampledFrame>>) {
        let mut samples = self.samples();
        if samples.len() == KEPT_SAMPLES {
            samples.clear();
        }
        samples.insert(digest.to_owned(), sample);
    }

    /// Rejects frames that are too expensive.
    pub(super) fn check_frames(&self, cost: &Cost) -> Result<(), Problem> {
        let limit = self.limits.frame.as_secs_f64();
        if cost.most_seconds <= limit {
            return Ok(());
        }
        let seconds = cost.most_seconds;
        let detail = format!(
            "a frame is expected to take {} of a slot; the limit is {} (`--max-frame-s`): reduce `camera.width` and \
             `camera.height`, the `paths_max` of `truth`, or render it without a service (`fathom render`)",
            describe_seconds(seconds),
            describe_seconds(limit)
        );
        let problem = Problem::new(Slug::TooExpensive, detail).with_member("frame_seconds", seconds);
        Err(problem.with_member("limit_seconds", limit))
    }

    /// Why a caller with these unfinished frames may not add a job of this price; `None` if it may.
    pub(super) fn refuse_caller(&self, open: OpenCost, price: Price) -> Option<Problem> {
        let PriceLimits {
            caller, caller_bytes, ..
        } = self.limits;
        let (open_s, limit_s) = (open.us as f64 / 1e6, caller.as_secs_f64());
        let total_bytes = open.bytes.saturating_add(price.bytes);
        let mut excess = Vec::new();
        if open_s + price.slot_seconds > limit_s {
            excess.push(format!(
                "the job is expected to take {} of a slot, and {} of your other jobs are open; the limit is {} in total \
                 (`--max-caller-h`)",
                describe_seconds(price.slot_seconds),
                describe_seconds(open_s),
                describe_seconds(limit_s)
            ));
        }
        if total_bytes > caller_bytes {
            excess.push(format!(
                "the job is expected to store {:.1} GB, and {:.1} GB of your other jobs are open; the limit is {:.1} GB in \
                 total (`--max-caller-gb`)",
                price.bytes as f64 / 1e9,
                open.bytes as f64 / 1e9,
                caller_bytes as f64 / 1e9
            ));
        }
        if excess.is_empty() {
            return None;
        }
        let remedy = "wait for your jobs, cancel one, or submit fewer frames";
        let detail = format!("{}; {remedy}", excess.join("; "));
        let problem = Problem::new(Slug::CallerLimit, detail)
            .with_member("slot_seconds", price.slot_seconds)
            .with_member("bytes", price.bytes);
        Some(problem.with_member("open_slot_seconds", open_s))
    }

    /// Counts a submission for its caller until the lease table has the job.
    pub(super) fn reserve(&self, caller: &str, added: OpenCost) -> Reservation<'_> {
        let mut pending = self.pending();
        let known = pending.entry(caller.to_owned()).or_default();
        let before = *known;
        *known = known.plus(added);
        Reservation {
            prices: self,
            caller: caller.to_owned(),
            added,
            before,
        }
    }

    fn samples(&self) -> MutexGuard<'_, HashMap<String, Arc<Vec<SampledFrame>>>> {
        self.samples.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn pending(&self) -> MutexGuard<'_, HashMap<String, OpenCost>> {
        self.pending.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// A submission that is not yet in the lease table.
pub(super) struct Reservation<'p> {
    prices: &'p Prices,
    caller: String,
    added: OpenCost,
    /// Pending submissions of the caller before this one.
    pub(super) before: OpenCost,
}

impl Drop for Reservation<'_> {
    fn drop(&mut self) {
        let mut pending = self.prices.pending();
        if let Some(known) = pending.get_mut(&self.caller) {
            *known = known.minus(self.added);
            if *known == OpenCost::default() {
                pending.remove(&self.caller);
            }
        }
    }
}

/// `0.35 s`, `12 min`, `2.7 h`.
fn describe_seconds(seconds: f64) -> String {
    match seconds {
        ..10.0 => format!("{seconds:.2} s"),
        ..600.0 => format!("{seconds:.0} s"),
        ..7200.0 => format!("{:.0} min", seconds / 60.0),
        ..36_000.0 => format!("{:.1} h", seconds / 3600.0),
        _ => format!("{:.0} h", seconds / 3600.0),
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;

    fn cost(us: u64, bytes: u64) -> OpenCost {
        OpenCost { us, bytes }
    }

    #[test]
    fn concurrent_submissions_of_a_caller_count_together() {
        let prices = Prices::new(PriceLimits::default());
        let first = prices.reserve("a", cost(5, 50));
        let second = prices.reserve("a", cost(7, 70));
        assert_eq!((first.before, second.before), (cost(0, 0), cost(5, 50)));
        assert_eq!(prices.reserve("b", cost(1, 1)).before, cost(0, 0));
        drop(first);
        assert_eq!(prices.reserve("a", cost(1, 1)).before, cost(7, 70));
        drop(second);
        assert!(prices.pending().is_empty());
    }

    #[test]
    fn a_refusal_names_every_figure_and_the_remedy() {
        let prices = Prices::new(PriceLimits {
            caller: Duration::from_secs(3600),
            caller_bytes: 1_000_000_000,
            ..PriceLimits::default()
        });
        let price = Price {
            slot_seconds: 3000.0,
            bytes: 900_000_000,
        };
        assert!(
            prices
                .refuse_caller(cost(600_000_000, 100_000_000), price)
                .is_none()
        );
        let refused = prices.refuse_caller(cost(601_000_000, 100_000_001), price);
        let detail = refused.map(|problem| problem.to_string()).unwrap_or_default();
        for part in [
            "50 min",
            "10 min",
            "60 min",
            "0.9 GB",
            "--max-caller-h",
            "--max-caller-gb",
            "cancel one",
        ] {
            assert!(detail.contains(part), "{part}: {detail}");
        }
    }
}
