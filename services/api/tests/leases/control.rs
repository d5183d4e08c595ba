//! Effects of pausing, resuming and retrying on frames and leases.

use super::claim;
use api::lease_table::{JobEntry, LeaseTable, Millis, Totals};

fn table(frames: u64) -> LeaseTable {
    let mut table = LeaseTable::new();
    table.add_job(JobEntry {
        id: "j".to_owned(),
        frames,
        ..JobEntry::default()
    });
    table
}

fn give_up(table: &mut LeaseTable, token: u64) -> u64 {
    let grant = table.grant("w", Millis(0), token, 0.0).unwrap();
    let (frame, attempt) = grant.frames[0];
    let event = table.fail(&claim("j", frame, token, attempt), false, "no", Millis(0));
    assert!(event.unwrap().quarantined);
    frame
}

#[test]
fn a_paused_job_offers_no_frames_and_its_leases_continue() {
    let mut table = table(3);
    table.grant("w", Millis(0), 1, 0.0).unwrap();
    table.pause("j");
    assert_eq!(table.grant("v", Millis(1), 2, 0.0), None);
    let beat = table.beat("w", &[1], Millis(10_000));
    assert_eq!((beat.cancelled, beat.lost), (vec![], vec![]));
    assert_eq!(table.expire(Millis(20_000)), [], "the beat prolonged it");
    table.begin_commit(&claim("j", 0, 1, 1), Millis(20_000)).unwrap();
    table.finish_commit(&claim("j", 0, 0, 0));
    assert_eq!(table.grant("v", Millis(20_001), 3, 0.0), None);
    table.resume("j");
    assert_eq!(table.grant("v", Millis(20_002), 4, 0.0).unwrap().frames, [(1, 1)]);
}

#[test]
fn frames_returned_to_a_paused_job_wait_for_it() {
    let mut table = table(2);
    table.register("w", crate::about("w", 2), Millis(0));
    for token in [1, 2] {
        table.grant("w", Millis(0), token, 0.0).unwrap();
    }
    table.pause("j");
    assert_eq!(table.drop_worker("w", Millis(1)), []);
    // Both frames are suspects now, and no worker is kept empty for them.
    table.add_job(JobEntry {
        id: "other".to_owned(),
        frames: 2,
        ..JobEntry::default()
    });
    for token in [3, 4] {
        assert_eq!(table.grant("v", Millis(2), token, 0.0).unwrap().job_id, "other");
    }
    table.resume("j");
    assert_eq!(table.grant("u", Millis(3), 5, 0.0).unwrap().frames, [(0, 1)]);
}

#[test]
fn a_frame_that_was_given_up_is_tried_again_with_all_its_attempts() {
    let mut table = table(2);
    let frame = give_up(&mut table, 1);
    assert!(table.retry("j", &[frame, 1, 99]), "the other frame still waits");
    assert_eq!(table.totals(), Totals { queued: 2, leased: 0 });
    let grant = table.grant("w", Millis(0), 2, 0.0).unwrap();
    assert_eq!(grant.frames, [(frame, 1)]);
    assert!(
        table.retry("j", &[frame]),
        "it is held, not given up: nothing changes"
    );
    assert_eq!(table.totals(), Totals { queued: 1, leased: 1 });
}

#[test]
fn a_job_that_has_ended_is_no_longer_there_to_try_again() {
    let mut table = table(1);
    give_up(&mut table, 1);
    assert!(!table.retry("j", &[0]));
}

#[test]
fn frames_given_up_in_an_earlier_life_can_be_tried_again() {
    let mut table = LeaseTable::new();
    table.add_job(JobEntry {
        id: "j".to_owned(),
        frames: 5,
        done: vec![0..1, 3..4],
        failed: vec![2],
        ..JobEntry::default()
    });
    assert!(table.retry("j", &[0, 2]), "frame 0 has its image and stays");
    let mut offered: Vec<u64> = (1..)
        .map_while(|token| Some(table.grant("w", Millis(0), token, 0.0)?.frames[0].0))
        .collect();
    offered.sort_unstable();
    assert_eq!(offered, [1, 2, 4]);
}
