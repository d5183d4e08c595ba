//! Frames that kill their worker, among healthy ones.
//!
//! Failures: a healthy frame is quarantined; a frame that kills its worker is not; a healthy frame without exactly
//! one image; a history without an end. Workers render several frames at a time, so a killed worker always loses
//! healthy frames as well.

use std::collections::{BTreeMap, BTreeSet};

use super::claim;
use api::lease_table::{Grant, JobEntry, LeaseTable, Millis, StrikeEvent};
use imaging::random::Stream;

const HISTORIES: u64 = 2_000;
const STEPS: u64 = 20_000;

struct Worker {
    id: String,
    /// Remaining lease of each slot.
    slots: Vec<Option<Grant>>,
}

struct History {
    chance: Stream,
    number: u64,
    drawn: u64,
    table: LeaseTable,
    now: u64,
    token: u64,
    workers: Vec<Worker>,
    lives: u64,
    /// Whether the service is notified of a death, or detects it by silence.
    children: bool,
    poison: BTreeSet<u64>,
    images: BTreeMap<u64, u32>,
    given_up: BTreeMap<u64, u32>,
}

impl History {
    fn pick(&mut self, choices: u64) -> u64 {
        self.drawn += 1;
        self.chance.bits(self.number, self.drawn) % choices
    }

    /// One step of one slot.
    fn step(&mut self) {
        self.now += 1 + self.pick(400);
        self.beat();
        let worker_index = self.pick(self.workers.len() as u64) as usize;
        let slot = self.pick(self.workers[worker_index].slots.len() as u64) as usize;
        match self.workers[worker_index].slots[slot].take() {
            None => {
                self.token += 1;
                let cost = [0.0, 400.0][self.pick(2) as usize];
                let worker = &mut self.workers[worker_index];
                worker.slots[slot] = self.table.grant(&worker.id, Millis(self.now), self.token, cost);
            }
            Some(grant) => self.render(worker_index, slot, grant),
        }
        let lost = self.table.expire(Millis(self.now));
        self.note(lost);
    }

    fn render(&mut self, at: usize, slot: usize, mut grant: Grant) {
        let (frame, attempt) = grant.frames.remove(0);
        if self.poison.contains(&frame) {
            self.kill(at);
            return;
        }
        let now = Millis(self.now);
        if self
            .table
            .begin_commit(&claim("j", frame, grant.token, attempt), now)
            .is_ok()
        {
            self.table.finish_commit(&claim("j", frame, 0, 0));
            *self.images.entry(frame).or_default() += 1;
        }
        if !grant.frames.is_empty() {
            self.workers[at].slots[slot] = Some(grant);
        }
    }

    fn kill(&mut self, at: usize) {
        let now = self.now;
        self.lives += 1;
        let worker = &mut self.workers[at];
        let dead = std::mem::replace(&mut worker.id, format!("w{}", self.lives));
        worker.slots.fill(None);
        if self.children {
            let lost = self.table.drop_worker(&dead, Millis(now));
            self.note(lost);
        }
    }

    fn beat(&mut self) {
        for worker in &self.workers {
            let tokens: Vec<u64> = worker.slots.iter().flatten().map(|grant| grant.token).collect();
            self.table.beat(&worker.id, &tokens, Millis(self.now));
        }
    }

    fn note(&mut self, events: Vec<StrikeEvent>) {
        for event in events {
            assert!(
                self.poison.contains(&event.frame),
                "frame {} is innocent: {}",
                event.frame,
                event.error
            );
            if event.quarantined {
                *self.given_up.entry(event.frame).or_default() += 1;
            }
        }
    }
}

#[test]
fn a_frame_that_kills_its_worker_is_given_up_and_its_neighbors_finish() {
    for number in 0..HISTORIES {
        let frames = 5 + number % 60;
        let mut history = History {
            chance: Stream::stage(2, "poison"),
            number,
            drawn: 0,
            table: LeaseTable::new(),
            now: 0,
            token: 0,
            workers: Vec::new(),
            lives: 100,
            children: number % 2 == 0,
            poison: BTreeSet::new(),
            images: BTreeMap::new(),
            given_up: BTreeMap::new(),
        };
        history.table.add_job(JobEntry {
            id: "j".to_owned(),
            frames,
            ..JobEntry::default()
        });
        for worker in 0..=history.pick(3) {
            let slots = 1 + history.pick(4);
            let id = format!("w{worker}");
            history
                .table
                .register(&id, crate::about(&id, slots as u32), Millis(0));
            history.workers.push(Worker {
                id,
                slots: vec![None; slots as usize],
            });
        }
        for _ in 0..history.pick(4) {
            let frame = history.pick(frames);
            history.poison.insert(frame);
        }
        let mut steps = 0;
        while ((history.images.len() + history.given_up.len()) as u64) < frames {
            history.step();
            steps += 1;
            assert!(steps < STEPS, "history {number} does not end");
        }
        assert!(history.given_up.keys().eq(&history.poison), "history {number}");
        assert!(
            history
                .images
                .values()
                .chain(history.given_up.values())
                .all(|&times| times == 1)
        );
        assert_eq!(history.table.totals(), Default::default(), "history {number}");
    }
}
