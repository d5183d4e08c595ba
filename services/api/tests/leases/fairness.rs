//! Shares of callers: the state machine with slots that take time.
//!
//! Failures: a caller with frames waits while others are served more than its share; a job of a caller is served before
//! one of higher priority; a slot is idle although frames are offered; the open cost differs from the unfinished frames.

use std::collections::BTreeMap;

use api::lease_table::{Grant, JobEntry, LeaseTable, Millis, OpenCost};
use imaging::random::Stream;

use super::claim;

/// A job with its true time of a frame.
#[derive(Clone, Copy)]
struct Work {
    caller: usize,
    frames: u64,
    priced_ms: u64,
    true_ms: u64,
    priority: i32,
}

/// A slot of the only worker.
#[derive(Default)]
struct Slot {
    grant: Option<Grant>,
    free_at: u64,
}

/// Slots that render jobs; their time is simulated.
struct Fleet {
    table: LeaseTable,
    slots: Vec<Slot>,
    jobs: BTreeMap<String, Work>,
    now: u64,
    token: u64,
    /// Slot time and frames of each caller so far.
    used_ms: BTreeMap<usize, u64>,
    finished: BTreeMap<String, u64>,
    /// Jobs in the order of their grants.
    granted: Vec<String>,
}

fn caller_name(caller: usize) -> String {
    format!("caller-{caller}")
}

impl Fleet {
    fn new(slots: usize) -> Self {
        let mut table = LeaseTable::new();
        table.register("w", crate::about("w", slots as u32), Millis(0));
        Self {
            table,
            slots: (0..slots).map(|_| Slot::default()).collect(),
            jobs: BTreeMap::new(),
            now: 0,
            token: 0,
            used_ms: BTreeMap::new(),
            finished: BTreeMap::new(),
            granted: Vec::new(),
        }
    }

    fn submit(&mut self, work: Work) -> String {
        let id = format!("job-{:05}", self.jobs.len());
        self.table.add_job(JobEntry {
            id: id.clone(),
            caller: caller_name(work.caller),
            frames: work.frames,
            frame_cost: OpenCost {
                us: work.priced_ms * 1000,
                bytes: 10,
            },
            priority: work.priority,
            ..JobEntry::default()
        });
        self.jobs.insert(id.clone(), work);
        id
    }

    /// Runs until a time, or until no frame is left. Returns whether frames are left.
    fn run(&mut self, until: u64) -> bool {
        loop {
            self.fill();
            let busy = self.slots.iter().filter(|slot| slot.grant.is_some());
            let Some(next) = busy.map(|slot| slot.free_at).min() else {
                assert_eq!(self.table.totals().queued, 0, "slots are idle");
                return false;
            };
            if next > until {
                self.now = until;
                return true;
            }
            self.now = next;
            self.finish();
        }
    }

    fn fill(&mut self) {
        for slot in self.slots.iter_mut().filter(|slot| slot.grant.is_none()) {
            self.token += 1;
            // The mean of the worker over all jobs.
            let Some(grant) = self.table.grant("w", Millis(self.now), self.token, 100.0) else {
                return;
            };
            slot.free_at = self.now + self.jobs[&grant.job_id].true_ms;
            self.granted.push(grant.job_id.clone());
            slot.grant = Some(grant);
        }
    }

    /// Commits the frames that end now.
    fn finish(&mut self) {
        let now = Millis(self.now);
        for slot in &mut self.slots {
            let Some(mut grant) = slot.grant.take_if(|_| slot.free_at == self.now) else {
                continue;
            };
            let (frame, attempt) = grant.frames.remove(0);
            let claim = claim(&grant.job_id, frame, grant.token, attempt);
            self.table.begin_commit(&claim, now).unwrap();
            self.table.finish_commit(&claim);
            let work = self.jobs[&grant.job_id];
            *self.used_ms.entry(work.caller).or_default() += work.true_ms;
            *self.finished.entry(grant.job_id.clone()).or_default() += 1;
            if !grant.frames.is_empty() {
                slot.free_at = self.now + work.true_ms;
                slot.grant = Some(grant);
            }
        }
        let tokens: Vec<u64> = self
            .slots
            .iter()
            .flat_map(|slot| &slot.grant)
            .map(|grant| grant.token)
            .collect();
        self.table.beat("w", &tokens, now);
    }

    fn used(&self, caller: usize) -> u64 {
        self.used_ms.get(&caller).copied().unwrap_or(0)
    }
}

fn work(caller: usize, frames: u64, ms: u64) -> Work {
    Work {
        caller,
        frames,
        priced_ms: ms,
        true_ms: ms,
        priority: 0,
    }
}

/// Milliseconds until the first job of this fleet has ended.
fn time_of(fleet: &mut Fleet, job: &str) -> u64 {
    let begun = fleet.now;
    while fleet.finished.get(job) != Some(&fleet.jobs[job].frames) {
        let next = fleet.now + 10;
        fleet.run(next);
    }
    fleet.now - begun
}

#[test]
fn with_400_jobs_of_one_caller_40_frames_of_another_take_at_most_twice_their_time_alone() {
    for (slots, ms) in [(1, 100), (2, 100), (2, 300), (4, 250), (8, 500)] {
        let mut alone = Fleet::new(slots);
        let small = alone.submit(work(2, 40, ms));
        let alone_ms = time_of(&mut alone, &small);
        let mut shared = Fleet::new(slots);
        for _ in 0..400 {
            shared.submit(work(1, 1000, ms));
        }
        shared.run(60_000);
        let small = shared.submit(work(2, 40, ms));
        let shared_ms = time_of(&mut shared, &small);
        println!(
            "{slots} slots, {ms} ms: {alone_ms} ms alone, {shared_ms} ms with 400 jobs of another caller"
        );
        assert!(shared_ms <= 2 * alone_ms, "{shared_ms} ms instead of {alone_ms}");
    }
}

#[test]
fn a_wrong_price_gives_no_more_than_a_share() {
    let mut fleet = Fleet::new(2);
    // One caller's frames take a hundred times their price.
    fleet.submit(Work {
        priced_ms: 10,
        true_ms: 1000,
        ..work(1, 100_000, 0)
    });
    fleet.submit(work(2, 100_000, 1000));
    fleet.run(1_000_000);
    let (cheap, honest) = (fleet.used(1), fleet.used(2));
    assert!(cheap.abs_diff(honest) < 60_000, "{cheap} ms and {honest} ms");
}

#[test]
fn a_caller_that_was_away_catches_up_only_in_part() {
    let mut fleet = Fleet::new(2);
    fleet.submit(work(1, 1_000_000, 100));
    fleet.run(3_600_000);
    fleet.submit(work(2, 1_000_000, 100));
    let (before, begun) = (fleet.used(1), fleet.now);
    fleet.run(begun + 120_000);
    let (long, new) = (fleet.used(1) - before, fleet.used(2));
    assert!(new > long && new - long < 45_000, "{long} ms and {new} ms");
}

#[test]
fn priorities_order_the_jobs_of_a_caller_and_give_it_no_larger_share() {
    let mut fleet = Fleet::new(1);
    let ordinary = fleet.submit(work(1, 10_000, 100));
    fleet.submit(work(2, 10_000, 100));
    fleet.run(30_000);
    let urgent: Vec<String> = (0..60)
        .map(|_| {
            fleet.submit(Work {
                priority: 100,
                ..work(1, 20, 100)
            })
        })
        .collect();
    let (before, done) = (fleet.used(2), fleet.finished[&ordinary]);
    fleet.run(130_000);
    let other = fleet.used(2) - before;
    assert!((45_000..=55_000).contains(&other), "{other} ms of 100 000");
    assert!(fleet.finished[&ordinary] <= done + 10, "urgent jobs go first");
    // Without their priority they take turns with the ordinary job.
    urgent.iter().for_each(|job| fleet.table.set_priority(job, 0));
    let granted = fleet.granted.len();
    fleet.run(260_000);
    assert!(fleet.granted[granted..].contains(&ordinary));
}

/// Random choices of a history.
struct Dice {
    number: u64,
    drawn: u64,
}

impl Dice {
    fn pick(&mut self, choices: u64) -> u64 {
        self.drawn += 1;
        Stream::stage(11, "fairness").bits(self.number, self.drawn) % choices
    }
}

#[test]
fn in_random_histories_callers_with_frames_share_the_slots() {
    for number in 0..100 {
        let mut dice = Dice { number, drawn: 0 };
        let slots = 1 + dice.pick(8) as usize;
        let mut fleet = Fleet::new(slots);
        // Two callers never run out of frames; others come and go.
        for caller in 1..=2 {
            for _ in 0..=dice.pick(40) {
                let true_ms = 20 + dice.pick(1500);
                fleet.submit(Work {
                    priced_ms: true_ms * (1 + dice.pick(3)) / (1 + dice.pick(3)),
                    true_ms,
                    priority: dice.pick(2) as i32,
                    ..work(caller, 1_000_000, 0)
                });
            }
        }
        for step in 0..40 {
            if dice.pick(3) == 0 {
                let caller = 3 + dice.pick(5) as usize;
                fleet.submit(work(caller, 1 + dice.pick(50), 20 + dice.pick(500)));
            }
            fleet.run(5000 * (step + 1));
        }
        let (first, second) = (fleet.used(1), fleet.used(2));
        let longest = 1520 * slots as u64;
        assert!(
            first.abs_diff(second) <= 2 * longest + 3000,
            "history {number}, {slots} slots: {first} ms and {second} ms"
        );
    }
}

#[test]
fn the_open_cost_of_a_caller_is_that_of_its_unfinished_frames() {
    let mut fleet = Fleet::new(2);
    let job = fleet.submit(work(1, 10, 100));
    fleet.submit(work(2, 5, 100));
    let caller = caller_name(1);
    let open = fleet.table.open_cost(&caller);
    assert_eq!((open.us, open.bytes), (1_000_000, 100));
    fleet.run(400);
    let finished = fleet.finished[&job];
    assert!(finished > 0);
    assert_eq!(fleet.table.open_cost(&caller).us, (10 - finished) * 100_000);
    fleet.table.cancel(&job);
    assert_eq!(fleet.table.open_cost(&caller), OpenCost::default());
}
