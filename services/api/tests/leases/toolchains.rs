//! Which workers may render the frames of a job: version, kind of machine, runtime.

use api::lease_table::{Grant, JobEntry, LeaseTable, Millis, Rules, Toolchain};
use wire::messages::{Claim, RegisterRequest};

use super::claim;
use super::promises::job;

fn worker(code_version: &str, onnx_runtime: Option<&str>) -> RegisterRequest {
    RegisterRequest {
        name: code_version.to_owned(),
        slots: 1,
        code_version: code_version.to_owned(),
        onnx_runtime: onnx_runtime.map(str::to_owned),
        cpu_features: "avx2".to_owned(),
        ..RegisterRequest::default()
    }
}

fn toolchain(code_version: &str, onnx_runtime: Option<&str>) -> Toolchain {
    Toolchain {
        code_version: code_version.to_owned(),
        cpu_features: "avx2".to_owned(),
        onnx_runtime: onnx_runtime.map(str::to_owned),
    }
}

fn first_claim(grant: &Grant) -> Claim {
    let (frame, attempt) = grant.frames[0];
    claim(&grant.job_id, frame, grant.token, attempt)
}

#[test]
fn a_job_stays_with_the_program_and_the_machines_of_its_first_image() {
    let now = Millis(0);
    for mixed in [false, true] {
        let mut table = LeaseTable::with_rules(Rules {
            mixed,
            ..Rules::default()
        });
        table.register("old", worker("1", None), now);
        table.register("new", worker("2", None), now);
        table.add_job(job("a", 10));
        let [first, second] =
            [("old", 1), ("new", 2)].map(|(name, token)| table.grant(name, now, token, 0.0).unwrap());
        // There is no frame yet that the second could differ from.
        assert!(table.misfits("a").is_none());
        assert!(table.record_toolchain("a", &toolchain("1", None)));
        table.begin_commit(&first_claim(&first), now).unwrap();
        assert_eq!(table.record_toolchain("a", &toolchain("2", None)), mixed);
        table.finish_commit(&first_claim(&first));
        assert_eq!(table.record_toolchain("a", &toolchain("2", None)), mixed);
        table.refuse(&first_claim(&second)).unwrap();
        assert_eq!(table.grant("new", now, 3, 0.0).is_some(), mixed);
        assert!(table.grant("old", now, 4, 0.0).is_some());
        table.drop_worker("old", now);
        assert_eq!(
            table.misfits("a").is_some_and(|misfits| misfits.is_waiting),
            !mixed
        );
        if !mixed {
            // Another job has no provenance yet.
            table.add_job(job("b", 1));
            assert_eq!(table.grant("new", now, 5, 0.0).unwrap().job_id, "b");
        }
    }
}

#[test]
fn a_runtime_binds_only_jobs_that_have_used_it() {
    let now = Millis(0);
    let mut table = LeaseTable::new();
    let resumed = |id: &str, onnx_runtime| JobEntry {
        done: std::iter::once(0..1).collect(),
        made: Some(toolchain("1", onnx_runtime)),
        ..job(id, 2)
    };
    table.add_job(resumed("plain", None));
    table.add_job(resumed("styled", Some("1.20")));
    table.register("other", worker("1", Some("1.22")), now);
    assert_eq!(table.grant("other", now, 1, 0.0).unwrap().job_id, "plain");
    assert_eq!(table.grant("other", now, 2, 0.0), None);
    assert!(!table.record_toolchain("styled", &toolchain("1", Some("1.22"))));
    table.register("same", worker("1", Some("1.20")), now);
    assert_eq!(table.grant("same", now, 3, 0.0).unwrap().job_id, "styled");
}

/// A table whose frames are checked by version 2.
fn checked_table() -> LeaseTable {
    LeaseTable::with_rules(Rules {
        reference: Some(toolchain("2", Some("1.22"))),
        ..Rules::default()
    })
}

#[test]
fn if_frames_are_checked_no_unverified_first_frame_decides_and_misfits_are_named_at_once() {
    let now = Millis(0);
    let mut table = checked_table();
    table.register("9.9.9", worker("9.9.9", None), now);
    table.add_job(job("a", 10));
    assert_eq!(table.grant("9.9.9", now, 1, 0.0), None);
    let misfits = table.misfits("a").unwrap();
    assert_eq!((misfits.is_waiting, misfits.workers.len()), (true, 1));
    table.register("good", worker("2", None), now);
    assert!(!table.misfits("a").unwrap().is_waiting);
    assert!(table.grant("good", now, 2, 0.0).is_some());
    // Nor does a frame of the other worker that was granted before.
    assert!(!table.record_toolchain("a", &toolchain("9.9.9", None)));
    assert!(table.record_toolchain("a", &toolchain("2", None)));
    table.mix("a");
    assert_eq!(table.misfits("a"), None);
    assert!(table.grant("9.9.9", now, 3, 0.0).is_some());
    assert!(table.record_toolchain("a", &toolchain("9.9.9", None)));
}

#[test]
fn an_upgrade_continues_open_jobs_and_another_machine_waits_for_consent() {
    let now = Millis(0);
    let mut table = checked_table();
    for (id, cpu_features) in [("upgraded", "avx2"), ("moved", "sse4.1")] {
        let made = Toolchain {
            cpu_features: cpu_features.to_owned(),
            ..toolchain("1", Some("1.20"))
        };
        table.add_job(JobEntry {
            done: std::iter::once(0..1).collect(),
            made: Some(made),
            ..job(id, 2)
        });
    }
    table.register("new", worker("2", Some("1.22")), now);
    assert_eq!(table.grant("new", now, 1, 0.0).unwrap().job_id, "upgraded");
    assert!(table.record_toolchain("upgraded", &toolchain("2", Some("1.22"))));
    assert!(table.upgraded("upgraded").is_some());
    assert_eq!(table.grant("new", now, 2, 0.0), None);
    assert!(table.misfits("moved").unwrap().is_waiting);
    table.mix("moved");
    assert_eq!(table.grant("new", now, 3, 0.0).unwrap().job_id, "moved");
}

#[test]
fn a_runtime_that_cannot_be_checked_excludes_its_worker_from_the_job() {
    let now = Millis(0);
    let mut table = checked_table();
    table.register("other", worker("2", Some("1.20")), now);
    table.add_job(job("styled", 4));
    let grant = table.grant("other", now, 1, 0.0).unwrap();
    assert!(!table.record_toolchain("styled", &toolchain("2", Some("1.20"))));
    table.refuse(&first_claim(&grant)).unwrap();
    assert_eq!(table.grant("other", now, 2, 0.0), None);
    table.register("same", worker("2", Some("1.22")), now);
    assert!(table.grant("same", now, 3, 0.0).is_some());
}

#[test]
fn a_dismissed_worker_returns_its_frames_without_a_strike() {
    let now = Millis(0);
    let mut table = LeaseTable::new();
    table.register("liar", worker("1", None), now);
    table.add_job(job("a", 1));
    for token in 1..=4 {
        let grant = table.grant("liar", now, token, 0.0).unwrap();
        assert_eq!(grant.frames, [(0, 1)], "the first attempt each time");
        table.dismiss("liar", now);
        assert!(!table.has_worker("liar"));
        table.register("liar", worker("1", None), now);
    }
}
