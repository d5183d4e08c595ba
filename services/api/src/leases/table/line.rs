//! Scheduling order: callers first, then the jobs of each.
//!
//! Start-time fair queuing (Goyal, Vin and Cheng 1996): each caller has an account of its served slot time, and the least
//! served caller goes first. Callers with frames thus share the slots equally, independent of their number of jobs. It is
//! the limit of deficit round robin for small quanta. Within a caller, higher priorities go first, and equal jobs share
//! its time in the same way.
//!
//! A grant is charged with the price of its frames. When a frame ends, the charge is replaced by the time that it took, so a
//! wrong price favors its caller only until then.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};

use super::types::OpenCost;

/// Slot time in microseconds.
pub(crate) type Micros = u64;

/// Slot time that a caller may use before the others if it was served less: small jobs finish soon.
const CREDIT_US: Micros = 30_000_000;
/// A new job queues behind jobs served this much less than the last one: the time of a lease.
const TURN_US: Micros = 1_000_000;

/// Position of a caller: slot time served, number of its last grant, name.
type CallerPlace = (Micros, u64, String);
/// Position of a job within its caller: priority, slot time served, number of its last grant, id.
type JobPlace = (Reverse<i32>, Micros, u64, String);

/// All callers, least served first.
#[derive(Default)]
pub(crate) struct Line {
    callers: BTreeMap<String, CallerAccount>,
    order: BTreeSet<CallerPlace>,
    /// Largest served time of a caller before a grant.
    floor: Micros,
    grants: u64,
}

#[derive(Default)]
struct CallerAccount {
    served: Micros,
    last_grant: u64,
    jobs: BTreeMap<String, JobAccount>,
    order: BTreeSet<JobPlace>,
    /// Largest served time of its jobs before a grant.
    floor: Micros,
    /// Served time of a new job.
    start: Micros,
    /// Price of its unfinished frames.
    open: OpenCost,
}

struct JobAccount {
    priority: i32,
    served: Micros,
    last_grant: u64,
    open: OpenCost,
}

impl JobAccount {
    fn place(&self, id: &str) -> JobPlace {
        (
            Reverse(self.priority),
            self.served,
            self.last_grant,
            id.to_owned(),
        )
    }
}

impl CallerAccount {
    fn place(&self, name: &str) -> CallerPlace {
        (self.served, self.last_grant, name.to_owned())
    }

    /// Changes the account of a job and moves it to its place.
    fn update_job(&mut self, id: &str, change: impl FnOnce(&mut JobAccount)) {
        if let Some(job) = self.jobs.get_mut(id) {
            self.order.remove(&job.place(id));
            change(job);
            self.order.insert(job.place(id));
        }
    }
}

impl Line {
    /// Adds a job behind the waiting ones of its caller.
    pub(crate) fn add_job(&mut self, caller: &str, id: &str, priority: i32) {
        let grants = self.grants;
        self.update(caller, |account| {
            let job = JobAccount {
                priority,
                served: account.start,
                last_grant: grants,
                open: OpenCost::default(),
            };
            account.order.insert(job.place(id));
            account.jobs.insert(id.to_owned(), job);
        });
    }

    /// Removes a job. The time served to its caller still counts.
    pub(crate) fn remove_job(&mut self, caller: &str, id: &str) {
        self.update(caller, |account| {
            if let Some(job) = account.jobs.remove(id) {
                account.order.remove(&job.place(id));
                account.open = account.open.minus(job.open);
            }
        });
        self.forget_idle();
    }

    pub(crate) fn set_priority(&mut self, caller: &str, id: &str, priority: i32) {
        self.update(caller, |account| {
            account.update_job(id, |job| job.priority = priority);
        });
    }

    /// Sets the price of a job's unfinished frames.
    pub(crate) fn set_open(&mut self, caller: &str, id: &str, open: OpenCost) {
        let account = self.callers.get_mut(caller);
        let Some((job, total)) =
            account.and_then(|account| Some((account.jobs.get_mut(id)?, &mut account.open)))
        else {
            return;
        };
        *total = total.plus(open).minus(job.open);
        job.open = open;
    }

    /// Price of a caller's unfinished frames.
    pub(crate) fn open(&self, caller: &str) -> OpenCost {
        let account = self.callers.get(caller);
        account.map(|account| account.open).unwrap_or_default()
    }

    /// Callers and jobs, the next to be served first.
    pub(crate) fn jobs(&self) -> impl Iterator<Item = &str> {
        let callers = self.order.iter().filter_map(|(.., name)| self.callers.get(name));
        callers.flat_map(|account| account.order.iter().map(|(.., id)| id.as_str()))
    }

    /// Charges a granted lease. A caller or job that was idle catches up only in part.
    pub(crate) fn charge_grant(&mut self, caller: &str, id: &str, price: Micros) {
        self.grants += 1;
        let (grants, floor) = (self.grants, self.floor);
        let mut begun = 0;
        self.update(caller, |account| {
            begun = account.served.max(floor.saturating_sub(CREDIT_US));
            account.served = begun.saturating_add(price);
            account.last_grant = grants;
            let account_floor = account.floor;
            let mut job_begun = account_floor;
            account.update_job(id, |job| {
                job_begun = job.served.max(account_floor);
                job.served = job_begun.saturating_add(price);
                job.last_grant = grants;
            });
            account.floor = account.floor.max(job_begun);
            account.start = account.start.max(job_begun.saturating_add(price.min(TURN_US)));
        });
        self.floor = self.floor.max(begun);
    }

    /// Charges the time that a frame took.
    pub(crate) fn charge(&mut self, caller: &str, id: &str, time: Micros) {
        self.update(caller, |account| {
            account.served = account.served.saturating_add(time);
            account.update_job(id, |job| job.served = job.served.saturating_add(time));
        });
    }

    /// Takes back the price of a frame that has left its lease.
    pub(crate) fn refund(&mut self, caller: &str, id: &str, price: Micros) {
        self.update(caller, |account| {
            account.served = account.served.saturating_sub(price);
            account.update_job(id, |job| job.served = job.served.saturating_sub(price));
        });
    }

    fn update(&mut self, caller: &str, change: impl FnOnce(&mut CallerAccount)) {
        let account = self.callers.entry(caller.to_owned()).or_default();
        self.order.remove(&account.place(caller));
        change(account);
        self.order.insert(account.place(caller));
    }

    /// Drops callers without jobs whose served time no longer matters.
    fn forget_idle(&mut self) {
        let forgotten = self.floor.saturating_sub(CREDIT_US);
        let order = &mut self.order;
        self.callers.retain(|name, account| {
            let is_kept = !account.jobs.is_empty() || account.served > forgotten;
            if !is_kept {
                order.remove(&account.place(name));
            }
            is_kept
        });
    }
}
