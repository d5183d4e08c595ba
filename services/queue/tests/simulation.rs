//! Ten thousand random histories of workers that crash, stall, repeat themselves and answer late.
//!
//! Failure is: a frame that gets two images or none; a commit that is accepted under a token that is not the frame's
//! current one; a frame that is given up although it never failed while it was alone; a history that does not end.

use std::collections::BTreeMap;

use fathom_queue::{Grant, JobEntry, LeaseTable, Millis};
use imaging::random::Stream;

const HISTORIES: u64 = 10_000;
const STEPS: u64 = 4_000;

struct History {
    stream: Stream,
    number: u64,
    drawn: u64,
    table: LeaseTable,
    now: u64,
    token: u64,
    /// Leases as the workers believe to hold them, including ones that are lost already.
    held: Vec<(String, Grant)>,
    /// The token that last was given for a frame: no other may commit it.
    current: BTreeMap<(String, u64), u64>,
    images: BTreeMap<(String, u64), u32>,
    given_up: BTreeMap<(String, u64), u32>,
}

impl History {
    fn pick(&mut self, choices: u64) -> u64 {
        self.drawn += 1;
        self.stream.bits(self.number, self.drawn) % choices
    }

    fn step(&mut self) {
        self.now += [0, 5, 300, 4_000, 16_000][self.pick(5) as usize];
        match self.pick(10) {
            0..=3 => self.lease(),
            4..=6 => self.commit(),
            7 => self.fail(),
            8 => self.crash_or_release(),
            _ => {
                let lost = self.table.expire(Millis(self.now));
                self.note(lost);
            }
        }
    }

    fn lease(&mut self) {
        self.token += 1;
        let worker = format!("w{}", self.pick(3));
        let cost = [0.0, 300.0, 1000.0][self.pick(3) as usize];
        if let Some(grant) = self.table.grant(&worker, Millis(self.now), self.token, cost) {
            for &(frame, _) in &grant.frames {
                let key = (grant.job_id.clone(), frame);
                assert!(
                    !self.images.contains_key(&key),
                    "frame {frame} is offered although it has its image"
                );
                assert!(
                    !self.given_up.contains_key(&key),
                    "frame {frame} is offered although it was given up"
                );
                self.current.insert(key, grant.token);
            }
            self.held.push((worker, grant));
        }
    }

    /// A worker commits some frame of some lease it believes to hold, perhaps not for the first time.
    fn commit(&mut self) {
        if self.held.is_empty() {
            return;
        }
        let at = self.pick(self.held.len() as u64) as usize;
        let (_, grant) = self.held[at].clone();
        let (frame, attempt) = grant.frames[self.pick(grant.frames.len() as u64) as usize];
        let key = (grant.job_id.clone(), frame);
        if self
            .table
            .begin_commit(&grant.job_id, frame, grant.token, attempt, Millis(self.now))
            .is_err()
        {
            return;
        }
        assert_eq!(self.current[&key], grant.token, "a stale token was accepted");
        if self.pick(8) == 0 {
            self.table.abort_commit(&grant.job_id, frame);
            return;
        }
        if self.pick(4) == 0 {
            // The writer is slow; leases run out meanwhile.
            let lost = self.table.expire(Millis(self.now + 100_000));
            self.note(lost);
        }
        self.table.finish_commit(&grant.job_id, frame);
        *self.images.entry(key).or_default() += 1;
    }

    fn fail(&mut self) {
        if self.held.is_empty() {
            return;
        }
        let at = self.pick(self.held.len() as u64) as usize;
        let (_, grant) = self.held[at].clone();
        let (frame, attempt) = grant.frames[0];
        let retryable = self.pick(10) > 0;
        let result = self.table.fail(
            &grant.job_id,
            frame,
            grant.token,
            attempt,
            retryable,
            "fault",
            Millis(self.now),
        );
        if let Ok(event) = result {
            assert_eq!(
                self.current[&(grant.job_id.clone(), frame)],
                grant.token,
                "a stale token was accepted"
            );
            assert!(event.quarantined == (!retryable || event.strikes >= 3));
            self.note(vec![event]);
        }
    }

    fn crash_or_release(&mut self) {
        if self.held.is_empty() {
            return;
        }
        let at = self.pick(self.held.len() as u64) as usize;
        let (worker, grant) = self.held.swap_remove(at);
        if self.pick(2) == 0 {
            self.table.release(grant.token, Millis(self.now));
        } else {
            let lost = self.table.drop_worker(&worker, Millis(self.now));
            self.note(lost);
        }
    }

    fn note(&mut self, events: Vec<fathom_queue::StrikeEvent>) {
        for event in events.into_iter().filter(|event| event.quarantined) {
            *self.given_up.entry((event.job, event.frame)).or_default() += 1;
        }
    }
}

#[test]
fn in_no_history_is_a_frame_lost_doubled_or_written_under_a_stale_token() {
    for number in 0..HISTORIES {
        let mut history = History {
            stream: Stream::stage(1, "leases"),
            number,
            drawn: 0,
            table: LeaseTable::new(),
            now: 0,
            token: 0,
            held: Vec::new(),
            current: BTreeMap::new(),
            images: BTreeMap::new(),
            given_up: BTreeMap::new(),
        };
        let frames = 1 + number % 17;
        for (id, priority) in [("a", 0), ("b", 1)] {
            history.table.add_job(JobEntry {
                id: id.to_owned(),
                frames,
                priority,
                ..JobEntry::default()
            });
        }
        let mut steps = 0;
        while history.images.len() + history.given_up.len() < 2 * frames as usize {
            history.step();
            steps += 1;
            assert!(steps < STEPS, "history {number} does not end");
        }
        assert!(
            history
                .images
                .values()
                .chain(history.given_up.values())
                .all(|&count| count == 1)
        );
        assert!(
            history
                .images
                .keys()
                .all(|key| !history.given_up.contains_key(key))
        );
        assert_eq!(history.table.totals(), Default::default(), "history {number}");
    }
}
