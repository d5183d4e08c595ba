//! Events of the simulation: workers, network, clocks, users.

use std::collections::BTreeMap;

use api::lease_table::Grant;
use imaging::random::Stream;

use super::service::{Claim, Service, Variant, Violation};

/// Events of a history with faults; afterwards there are none and the history must end.
const ROUGH: u32 = 150;
/// Events after which a history counts as endless.
const MOST: u32 = 20_000;

/// A future event.
enum Event {
    /// A worker takes its next step.
    Act(u64),
    /// A message reaches the service.
    Lease(u64),
    Commit(Claim),
    Fail(Claim, bool),
    Release(u64),
    Beat(u64, Vec<u64>),
    Died(u64),
    /// A grant reaches its worker.
    Granted(u64, Grant),
    /// The disk has stored an image that arrived in this life of the service.
    Written(Claim, u64),
    /// The service looks for expired leases.
    Expire,
}

#[derive(Default)]
struct Worker {
    slots: u64,
    /// Its presumed claims.
    held: Vec<Claim>,
}

pub(crate) struct World {
    stream: Stream,
    number: u64,
    drawn: u64,
    service: Service,
    now: u64,
    /// Offset of the service's clock.
    ahead: u64,
    events: BTreeMap<(u64, u64), Event>,
    scheduled: u64,
    workers: BTreeMap<u64, Worker>,
    lives: u64,
    rough: bool,
}

impl World {
    pub(crate) fn new(number: u64, variant: Variant) -> Self {
        let frames = 1 + number % 13;
        let mut world = Self {
            stream: Stream::stage(7, "leases"),
            number,
            drawn: 0,
            service: Service::new(variant, &[("a", frames), ("b", 1 + number % 5)]),
            now: 0,
            ahead: 0,
            events: BTreeMap::new(),
            scheduled: 0,
            workers: BTreeMap::new(),
            lives: 0,
            rough: true,
        };
        for _ in 0..=world.pick(3) {
            world.hire();
        }
        world.soon(Event::Expire, 200);
        world
    }

    pub(crate) fn play(mut self) -> Result<(), Violation> {
        for step in 0..MOST {
            if step == ROUGH {
                self.calm();
            }
            let Some(((time, _), event)) = self.events.pop_first() else {
                break;
            };
            self.now = self.now.max(time);
            if self.rough {
                self.meddle();
            }
            self.happen(event)?;
            if !self.rough && self.service.is_done() && !self.is_written() {
                return self.service.check_end();
            }
        }
        Err(Violation::Endless)
    }

    /// Ends the faults.
    fn calm(&mut self) {
        self.rough = false;
        for job in ["a", "b"] {
            self.service.resume(job);
        }
    }

    /// Whether an image is being written.
    fn is_written(&self) -> bool {
        let life = self.service.life;
        self.events
            .values()
            .any(|event| matches!(event, Event::Written(_, of) if *of == life))
    }

    /// Events at any time: restarts, clocks, users.
    fn meddle(&mut self) {
        let job = ["a", "b"][self.pick(2) as usize];
        match self.pick(200) {
            0 | 1 => self.service.restart(),
            2 => self.ahead += [1, 10_000, 20_000, 3_600_000][self.pick(4) as usize],
            // Back again, but not before the beginning.
            3 => self.ahead -= self.ahead.min([1, 4_000, 16_000][self.pick(3) as usize]),
            4 | 5 => self.service.pause(job),
            6..=9 => self.service.resume(job),
            10..=12 => self.service.retry(job),
            13 if self.pick(4) == 0 => self.service.cancel(job),
            _ => {}
        }
    }

    fn happen(&mut self, event: Event) -> Result<(), Violation> {
        let clock = self.now + self.ahead;
        match event {
            Event::Act(worker) => self.act(worker),
            Event::Lease(worker) => {
                let cost = [0.0, 500.0, 1500.0][self.pick(3) as usize];
                if let Some(grant) = self.service.grant(&name(worker), clock, cost)? {
                    self.send(Event::Granted(worker, grant));
                }
            }
            Event::Granted(worker, grant) => {
                if let Some(worker) = self.workers.get_mut(&worker) {
                    worker
                        .held
                        .extend(grant.frames.iter().map(|&(frame, attempt)| Claim {
                            frame: (grant.job_id.clone(), frame),
                            token: grant.token,
                            attempt,
                        }));
                }
            }
            Event::Commit(claim) => {
                if self.service.begin_commit(&claim, clock)? {
                    let delay = if self.rough {
                        [0, 3, 20_000][self.pick(3) as usize]
                    } else {
                        3
                    };
                    let life = self.service.life;
                    self.soon(Event::Written(claim, life), delay);
                }
            }
            Event::Written(claim, life) if life == self.service.life => {
                if self.rough && self.pick(10) == 0 {
                    // The disk was full.
                    self.service.table.abort_commit(&claim.current());
                    return Ok(());
                }
                self.service.write(&claim.frame)?;
                if self.rough && self.pick(20) == 0 {
                    self.service.restart();
                } else {
                    self.service.table.finish_commit(&claim.current());
                }
            }
            Event::Written(..) => {}
            Event::Fail(claim, retryable) => self.service.fail(&claim, retryable, clock)?,
            Event::Release(token) => self.service.table.release(token, api::lease_table::Millis(clock)),
            Event::Beat(worker, tokens) => {
                let beat = self.service.beat(&name(worker), &tokens, clock);
                if let Some(worker) = self.workers.get_mut(&worker) {
                    worker.held.retain(|claim| {
                        !beat.lost.contains(&claim.token) && !beat.cancelled.contains(&claim.token)
                    });
                }
            }
            Event::Died(worker) => self.service.worker_died(&name(worker), clock)?,
            Event::Expire => {
                self.service.expire(clock)?;
                self.soon(Event::Expire, 200);
            }
        }
        Ok(())
    }

    fn act(&mut self, worker: u64) {
        let Some(Worker { slots, held }) = self.workers.get_mut(&worker) else {
            return;
        };
        let tokens: Vec<u64> = held.iter().map(|claim| claim.token).collect();
        let (slots, busy, last) = (*slots, held.len() as u64, held.last().map(|claim| claim.token));
        let mut next = 300;
        self.send(Event::Beat(worker, tokens));
        match self.pick(if self.rough { 24 } else { 10 }) {
            choice if busy == 0 || (busy < slots && choice % 2 == 0) => self.send(Event::Lease(worker)),
            // Reports a failure and then commits the frame anyway.
            10 => {
                let claim = self.take(worker);
                self.send(Event::Fail(claim.clone(), false));
                self.soon(Event::Commit(claim), 2_000);
            }
            11 | 12 => {
                let claim = self.take(worker);
                let retryable = self.pick(8) > 0;
                self.send(Event::Fail(claim, retryable));
            }
            13 => return self.crash(worker),
            14 => last
                .into_iter()
                .for_each(|token| self.send(Event::Release(token))),
            // Stalls and resumes with expired leases.
            15 | 16 => next = [8_000, 16_000, 90_000][self.pick(3) as usize],
            // Repeats earlier messages without a heartbeat.
            17 => {
                let claim = self.take(worker);
                self.send(Event::Commit(claim.clone()));
                self.soon(Event::Commit(claim), 14_990);
            }
            _ => {
                let claim = self.take(worker);
                self.send(Event::Commit(claim));
            }
        }
        let next = next + self.pick(700);
        self.soon(Event::Act(worker), next);
    }

    fn take(&mut self, worker: u64) -> Claim {
        let choice = self.pick(1 << 20) as usize;
        let held = &mut self.workers.get_mut(&worker).unwrap().held;
        held.remove(choice % held.len())
    }

    /// A worker dies, with or without notifying the service. Another replaces it.
    fn crash(&mut self, worker: u64) {
        self.workers.remove(&worker);
        if self.pick(2) == 0 {
            self.soon(Event::Died(worker), 50);
        }
        self.hire();
    }

    fn hire(&mut self) {
        self.lives += 1;
        let (id, slots) = (self.lives, 1 + self.pick(3));
        self.workers.insert(
            id,
            Worker {
                slots,
                held: Vec::new(),
            },
        );
        let start = api::lease_table::Millis(self.now + self.ahead);
        self.service
            .table
            .register(&name(id), crate::about(&name(id), slots as u32), start);
        self.soon(Event::Act(id), 10);
    }

    /// Over the network: late, twice, or not at all.
    fn send(&mut self, event: Event) {
        let fate = if self.rough { self.pick(20) } else { 19 };
        let copy = match &event {
            Event::Commit(claim) => Some(Event::Commit(claim.clone())),
            Event::Fail(claim, retryable) => Some(Event::Fail(claim.clone(), *retryable)),
            Event::Beat(worker, tokens) => Some(Event::Beat(*worker, tokens.clone())),
            Event::Release(token) => Some(Event::Release(*token)),
            _ => None,
        };
        let delay = if self.rough {
            [1, 2, 2, 30, 800, 14_900, 40_000][self.pick(7) as usize]
        } else {
            2
        };
        match (fate, copy) {
            (0, _) => {}
            (1 | 2, Some(copy)) => {
                let later = [1, 900, 15_100][self.pick(3) as usize];
                self.soon(event, delay);
                self.soon(copy, delay + later);
            }
            _ => self.soon(event, delay),
        }
    }

    fn soon(&mut self, event: Event, delay: u64) {
        self.scheduled += 1;
        self.events.insert((self.now + delay, self.scheduled), event);
    }

    fn pick(&mut self, choices: u64) -> u64 {
        self.drawn += 1;
        self.stream.bits(self.number, self.drawn) % choices
    }
}

fn name(worker: u64) -> String {
    format!("w{worker}")
}
