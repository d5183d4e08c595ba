//! Slot time charged to callers and jobs.

use super::LeaseTable;
use super::line::Micros;
use super::types::Millis;

impl LeaseTable {
    /// Charges the time since the grant of a lease or its latest frame, and returns it.
    pub(super) fn charge_time(&mut self, token: u64, now: Millis) -> Micros {
        let limit = self.rules.frame_limit_ms;
        let Some(lease) = self.leases.get_mut(token) else {
            return 0;
        };
        let held_ms = now.0.saturating_sub(lease.since.0).min(limit);
        lease.since = now;
        let held = held_ms.saturating_mul(1000);
        self.line.charge(&lease.caller, &lease.job, held);
        held
    }

    /// Takes back the price of a frame that leaves its lease.
    pub(super) fn refund(&mut self, token: u64) {
        if let Some(lease) = self.leases.get(token) {
            self.line.refund(&lease.caller, &lease.job, lease.frame_us);
        }
    }

    /// Updates the price of a job's unfinished frames.
    pub(super) fn recount(&mut self, id: &str) {
        if let Some(job) = self.jobs.get(id) {
            self.line.set_open(&job.caller, id, job.open_cost());
        }
    }
}
