//! Guarantees of the lease table, in short histories.

use std::collections::BTreeMap;

use super::claim;
use api::lease_table::{JobEntry, LeaseTable, Millis, Stale};

pub(super) fn job(id: &str, frames: u64) -> JobEntry {
    JobEntry {
        id: id.to_owned(),
        frames,
        ..JobEntry::default()
    }
}

fn table(frames: u64) -> LeaseTable {
    let mut table = LeaseTable::new();
    table.add_job(job("j", frames));
    table
}

const QUICK_MS: f64 = 100.0;

#[test]
fn an_unknown_cost_grants_one_frame_and_a_known_one_a_second_of_work() {
    let mut table = table(100);
    assert_eq!(table.grant("w", Millis(0), 1, 0.0).unwrap().frames, [(0, 1)]);
    assert_eq!(table.grant("w", Millis(0), 2, QUICK_MS).unwrap().frames.len(), 10);
}

#[test]
fn a_stale_token_a_wrong_attempt_and_a_foreign_frame_change_nothing() {
    let mut table = table(3);
    table.grant("w", Millis(0), 7, 0.0).unwrap();
    for (frame, token, attempt) in [(0, 8, 1), (0, 7, 2), (1, 7, 1)] {
        assert_eq!(
            table.begin_commit(&claim("j", frame, token, attempt), Millis(1)),
            Err(Stale)
        );
        assert_eq!(
            table.fail(&claim("j", frame, token, attempt), true, "", Millis(1)),
            Err(Stale)
        );
    }
    assert_eq!(
        table.begin_commit(&claim("j", 0, 7, 1), Millis(20_000)),
        Err(Stale),
        "after its term"
    );
    assert_eq!(table.begin_commit(&claim("j", 0, 7, 1), Millis(1)), Ok(()));
}

#[test]
fn a_frame_that_is_being_written_cannot_be_lost() {
    let mut table = table(1);
    table.grant("w", Millis(0), 1, 0.0).unwrap();
    table.begin_commit(&claim("j", 0, 1, 1), Millis(14_999)).unwrap();
    assert_eq!(table.expire(Millis(60_000)), []);
    assert_eq!(table.grant("v", Millis(60_000), 2, 0.0), None);
    table.finish_commit(&claim("j", 0, 0, 0));
    assert_eq!(table.totals(), Default::default());
}

#[test]
fn the_rest_of_a_lost_lease_is_tried_one_at_a_time_and_only_then_strikes() {
    let mut table = table(10);
    assert_eq!(table.grant("w", Millis(0), 1, QUICK_MS).unwrap().frames.len(), 10);
    table.begin_commit(&claim("j", 0, 1, 1), Millis(1)).unwrap();
    table.finish_commit(&claim("j", 0, 0, 0));
    assert_eq!(
        table.drop_worker("w", Millis(2)),
        [],
        "several frames were lost: none is to blame yet"
    );
    assert_eq!(table.grant("v", Millis(3), 2, QUICK_MS).unwrap().frames, [(1, 1)]);
    let lost = table.expire(Millis(20_000));
    assert_eq!(
        (lost.len(), lost[0].frame, lost[0].strikes, lost[0].quarantined),
        (1, 1, 1, false)
    );
}

#[test]
fn three_strikes_and_the_frame_is_given_up_with_growing_pauses_before() {
    let mut table = table(1);
    let mut now = 0;
    for (strike, pause) in [(1, 1000), (2, 2000), (3, 0)] {
        let grant = table.grant("w", Millis(now), strike, 0.0).unwrap();
        assert_eq!(grant.frames, [(0, strike as u32)]);
        let event = table
            .fail(&claim("j", 0, strike, strike as u32), true, "boom", Millis(now))
            .unwrap();
        assert_eq!(
            (event.strikes, event.quarantined, event.error.as_str()),
            (strike as u32, strike == 3, "boom")
        );
        assert_eq!(
            table.grant("w", Millis(now + pause - u64::from(pause > 0)), 99, 0.0),
            None
        );
        now += pause;
    }
}

#[test]
fn a_permanent_failure_is_final_immediately() {
    let mut table = table(1);
    table.grant("w", Millis(0), 1, 0.0).unwrap();
    let event = table
        .fail(&claim("j", 0, 1, 1), false, "no such style", Millis(0))
        .unwrap();
    assert!(event.quarantined && event.strikes == 1);
}

#[test]
fn handing_back_burns_no_attempt_and_keeps_ranges_together() {
    let mut table = table(10);
    table.grant("w", Millis(0), 1, QUICK_MS).unwrap();
    table.release(1, Millis(1));
    let again = table.grant("w", Millis(2), 2, QUICK_MS).unwrap();
    assert_eq!(again.frames, (0..10).map(|frame| (frame, 1)).collect::<Vec<_>>());
}

#[test]
fn a_cancelled_job_grants_no_frames_and_its_workers_are_notified() {
    let mut table = table(10);
    table.grant("w", Millis(0), 1, QUICK_MS).unwrap();
    table.cancel("j");
    assert_eq!(table.begin_commit(&claim("j", 0, 1, 1), Millis(1)), Err(Stale));
    assert_eq!(table.grant("v", Millis(1), 2, QUICK_MS), None);
    let beat = table.beat("w", &[1, 5], Millis(2));
    assert_eq!((beat.cancelled, beat.lost), (vec![1], vec![5]));
}

#[test]
fn priority_goes_first_and_equals_take_turns() {
    let mut table = LeaseTable::new();
    table.add_job(job("a", 1000));
    table.add_job(job("b", 1000));
    table.add_job(JobEntry {
        priority: 1,
        ..job("urgent", 1)
    });
    let order: Vec<String> = (0..5)
        .map(|token| table.grant("w", Millis(0), token, QUICK_MS).unwrap().job_id)
        .collect();
    assert_eq!(order, ["urgent", "a", "b", "a", "b"]);
}

#[test]
fn after_a_restart_only_open_frames_are_offered() {
    let mut table = LeaseTable::new();
    let strikes = BTreeMap::from([(4, 2)]);
    table.add_job(JobEntry {
        done: vec![0..3, 6..8],
        failed: vec![3],
        strikes,
        ..job("j", 10)
    });
    let mut offered = Vec::new();
    for token in 0.. {
        let Some(grant) = table.grant("w", Millis(0), token, QUICK_MS) else {
            break;
        };
        offered.extend(grant.frames);
    }
    assert_eq!(offered, [(4, 3), (5, 1), (8, 1), (9, 1)]);
}

#[test]
fn ten_million_frames_are_taken_up_without_a_list_of_them() {
    let mut table = table(10_000_000);
    assert_eq!(table.totals().queued, 10_000_000);
    assert_eq!(table.grant("w", Millis(0), 1, 0.001).unwrap().frames.len(), 256);
}

#[test]
fn the_remainder_of_a_job_is_shared_among_all_slots() {
    let mut table = table(24);
    table.register("w", crate::about("one", 3), Millis(0));
    table.register("v", crate::about("two", 1), Millis(0));
    let sizes: Vec<usize> = (1..)
        .map_while(|token| Some(table.grant("w", Millis(0), token, QUICK_MS)?.frames.len()))
        .collect();
    assert_eq!(sizes, [6, 5, 4, 3, 2, 1, 1, 1, 1]);
}

#[test]
fn a_new_job_queues_behind_waiting_ones_and_starves_none() {
    let mut table = table(1000);
    let mut turns = Vec::new();
    for token in 1..=7 {
        turns.push(table.grant("w", Millis(0), token, 0.0).unwrap().job_id);
        table.add_job(job(&format!("small-{token}"), 1));
    }
    assert_eq!(turns, ["j", "j", "small-1", "j", "small-2", "small-3", "j"]);
}

#[test]
fn after_a_crash_of_several_slots_a_suspect_has_a_worker_to_itself() {
    let mut table = table(3);
    table.register("w", crate::about("w", 2), Millis(0));
    for token in [1, 2] {
        assert_eq!(table.grant("w", Millis(0), token, 0.0).unwrap().frames.len(), 1);
    }
    assert_eq!(
        table.drop_worker("w", Millis(1)),
        [],
        "either frame may have done it"
    );
    table.register("v", crate::about("v", 2), Millis(2));
    assert_eq!(table.grant("v", Millis(2), 3, 0.0).unwrap().frames, [(0, 1)]);
    assert_eq!(
        table.grant("v", Millis(2), 4, 0.0),
        None,
        "nothing beside a suspect"
    );
    let lost = table.drop_worker("v", Millis(3));
    assert_eq!((lost.len(), lost[0].frame, lost[0].strikes), (1, 0, 1));
    assert!(lost[0].error.contains("worker `v` was lost"), "{}", lost[0].error);
}

#[test]
fn one_busy_worker_is_emptied_for_a_suspect_and_the_others_go_on() {
    let mut table = table(100);
    for (worker, token) in [("dead", 1), ("dead", 2), ("v", 3), ("u", 4)] {
        table.register(worker, crate::about(worker, 2), Millis(0));
        table.grant(worker, Millis(0), token, 0.0).unwrap();
    }
    table.drop_worker("dead", Millis(1));
    assert_eq!(table.grant("v", Millis(2), 5, 0.0), None, "it is to become empty");
    assert_eq!(table.grant("u", Millis(2), 6, 0.0).unwrap().frames, [(4, 1)]);
    table.begin_commit(&claim("j", 2, 3, 1), Millis(3)).unwrap();
    table.finish_commit(&claim("j", 2, 0, 0));
    assert_eq!(table.grant("v", Millis(4), 7, 0.0).unwrap().frames, [(0, 1)]);
}

#[test]
fn old_leases_do_not_affect_a_job_resubmitted_after_a_cancel() {
    let mut table = table(2);
    table.grant("w", Millis(0), 1, 0.0).unwrap();
    table.begin_commit(&claim("j", 0, 1, 1), Millis(1)).unwrap();
    table.cancel("j");
    assert_eq!(table.totals(), Default::default());
    table.add_job(job("j", 2));
    table.finish_commit(&claim("j", 0, 0, 0));
    assert_eq!((table.totals().queued, table.totals().leased), (2, 0));
    assert_eq!(
        table.beat("w", &[1], Millis(2)).lost,
        [1],
        "its last frame was written"
    );
}
