//! Sets in a folder: several processes share a job through the store alone, and any of them may be killed. The comment
//! above each test defines failure.

use std::fs;
use std::process::{Command, Stdio};
use std::time::Duration;

use crate::datasets::sets::{Work, files, marker, text};
use fathom_tests::{digest_by_render, fathom};
use serde_json::{Value, json};

/// Failure: two processes that share a job omit a frame, or the digest differs from that of `fathom render`.
#[test]
fn processes_that_share_a_job_make_what_one_render_makes() {
    let work = Work::new(&job(60));
    let expected = digest_by_render(&job(60), work.folder(), "2");
    let parts: Vec<_> = (0..3)
        .map(|part| work.start(&["--shard", &format!("{part}/3"), "--frames-per-shard", "7"], &[]))
        .collect();
    for part in parts {
        let output = part.wait_with_output().expect("a child ends");
        assert!(output.status.success(), "{}", text(&output.stderr));
    }
    let again = work.render(&[]);
    assert_eq!(
        digest_in(&again.stdout),
        Some(expected),
        "{}",
        text(&again.stderr)
    );
    assert!(
        text(&again.stdout).starts_with("0 shards with 0 frames"),
        "{}",
        text(&again.stdout)
    );
    assert_eq!(files(&work.set().join("done")).len(), 9);
    let status = work.command("status", &["--json"]);
    let status: Value = serde_json::from_slice(&status.stdout).expect("JSON");
    assert_eq!(
        (&status["done"], &status["frames_done"], &status["orphans"]),
        (&json!(9), &json!(60), &json!(0))
    );
}

/// Failure: two processes on the same shards disagree, or leave files without a marker.
#[test]
fn processes_that_race_for_the_same_shards_leave_one_winner_of_each() {
    let work = Work::new(&job(40));
    let racers = [
        work.start(&["--frames-per-shard", "10"], &[]),
        work.start(&["--frames-per-shard", "10"], &[]),
    ];
    for racer in racers {
        let output = racer.wait_with_output().expect("a child ends");
        assert!(output.status.success(), "{}", text(&output.stderr));
    }
    assert_eq!(files(&work.set().join("shards")).len(), 4);
    assert_eq!(files(&work.set().join("rows")).len(), 4);
}

/// Failure: after a kill at any point incomplete files count, the next run does not finish the job with the same
/// digest, or `gc` leaves more than the winners.
#[test]
fn a_killed_supervisor_costs_only_time() {
    let work = Work::new(&job(40));
    let expected = digest_by_render(&job(40), work.folder(), "2");
    for fault in [
        "shard.frame_written=abort#13",
        "shard.files_written=abort@1",
        "shard.committed=abort@1",
    ] {
        let output = work.start(&["--frames-per-shard", "10"], &[("FATHOM_FAULTS", fault)]);
        let output = output.wait_with_output().expect("a child ends");
        assert_eq!(output.status.code(), None, "{fault}: {}", text(&output.stderr));
        let verified = work.command("verify", &[]);
        assert!(verified.status.success(), "{fault}: {}", text(&verified.stdout));
    }
    let output = work.render(&[]);
    assert_eq!(
        digest_in(&output.stdout),
        Some(expected),
        "{}",
        text(&output.stderr)
    );
    assert!(work.command("gc", &["--older", "0s"]).status.success());
    for folder in ["shards", "rows"] {
        assert_eq!(files(&work.set().join(folder)).len(), 4, "{folder}");
    }
    assert!(work.command("verify", &["--render", "3"]).status.success());
}

/// Failure: a killed child ends the run or changes its output.
#[test]
fn a_killed_child_costs_only_time() {
    let work = Work::new(&job(100));
    let expected = digest_by_render(&job(100), work.folder(), "2");
    let run = work.start(&["--frames-per-shard", "50"], &[]);
    // A third kill may be the third in a row before a child begins, or the third try of a frame alone; both end the run.
    let killed = (0..2).filter(|_| {
        std::thread::sleep(Duration::from_millis(150));
        kill_children(run.id())
    });
    assert!(killed.count() > 0, "no child was there to be killed");
    let output = run.wait_with_output().expect("a child ends");
    assert_eq!(
        digest_in(&output.stdout),
        Some(expected),
        "{}",
        text(&output.stderr)
    );
}

/// Failure: a poisoned frame affects a neighbor, is listed without its reason, or prevents the set from ending.
#[test]
fn poisoned_frames_are_listed_and_their_neighbors_are_there() {
    let work = Work::new(&job(40));
    let poison = "frame=panic#3,frame=abort#11,frame=hang#17,frame=memory#23,scene.nan=flag#29";
    let limits = [
        ("FATHOM_FAULTS", poison),
        ("FATHOM_FRAME_LIMIT_S", "1"),
        ("FATHOM_MEMORY_LIMIT_MIB", "400"),
    ];
    let output = work
        .start(&["--frames-per-shard", "40"], &limits)
        .wait_with_output()
        .expect("a child ends");
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stderr));
    let marker = marker(&work.set(), 0);
    let reasons = [
        (3, "broken on purpose"),
        (11, "signal"),
        (17, "took more than 1 s"),
        (23, "must be at most 400"),
        (29, "NaN"),
    ];
    assert_eq!(
        marker["failed"].as_array().map(Vec::len),
        Some(reasons.len()),
        "{marker}"
    );
    for ((frame, part), failed) in reasons.iter().zip(marker["failed"].as_array().expect("a list")) {
        assert_eq!(failed["frame"], json!(frame));
        assert!(
            failed["error"].as_str().is_some_and(|error| error.contains(part)),
            "{failed}"
        );
    }
    assert_eq!(marker["images"], json!(35));
    let again = work.render(&[]);
    assert_eq!(again.status.code(), Some(1), "the failed frames are still said");
}

/// Failure: `verify` misses a flipped byte, a truncated tar or a missing one.
#[test]
fn damage_is_found() {
    let work = Work::new(&job(20));
    assert!(work.render(&["--frames-per-shard", "5"]).status.success());
    let shards = files(&work.set().join("shards"));
    let whole = fs::read(&shards[1]).expect("a tar");
    let mut flipped = whole.clone();
    flipped[whole.len() / 2] ^= 1;
    fs::write(&shards[1], flipped).expect("a writable tar");
    fs::write(&shards[2], &fs::read(&shards[2]).expect("a tar")[..1000]).expect("a writable tar");
    fs::remove_file(&shards[3]).expect("a tar");
    let output = work.command("verify", &[]);
    assert_eq!(output.status.code(), Some(1));
    let printed = text(&output.stdout);
    for part in ["SHA-256", "has 1000 bytes", "is gone", "3 damaged"] {
        assert!(
            (printed.clone() + &text(&output.stderr)).contains(part),
            "{part} is not in:\n{printed}"
        );
    }
    fs::write(&shards[1], whole).expect("a writable tar");
    for shard in [2, 3] {
        fs::remove_file(work.set().join(format!("done/{shard:06}.json"))).expect("a marker");
    }
    assert!(work.render(&[]).status.success());
    assert!(work.command("verify", &["--render", "2"]).status.success());
}

/// Failure: another job, another division, a plain folder or a cancelled set is rendered into, or the exit status
/// allows an engine to retry.
#[test]
fn what_cannot_succeed_exits_with_two() {
    let work = Work::new(&job(10));
    assert!(work.render(&["--frames-per-shard", "5"]).status.success());
    let refused = |output: std::process::Output, parts: &[&str]| {
        let printed = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{printed}");
        parts
            .iter()
            .for_each(|part| assert!(printed.contains(part), "{part} is not in: {printed}"));
    };
    refused(
        work.render(&["--frames-per-shard", "6"]),
        &["5 frames per shard", "not 6"],
    );
    refused(work.render(&["--shard", "3/3"]), &["3/3"]);
    refused(work.render(&["--frames", "5..11"]), &["5..11", "10"]);
    work.describe(&job(11));
    refused(work.render(&[]), &["another job", "digest"]);
    work.describe(&job(10));
    fs::write(work.set().join("state.json"), r#"{"state": "cancelled"}"#).expect("a writable set");
    fs::remove_file(work.set().join("done/000001.json")).expect("a marker");
    refused(work.render(&[]), &["cancelled"]);
    fs::write(work.set().join("state.json"), r#"{"state": "paused"}"#).expect("a writable set");
    assert_eq!(work.render(&[]).status.code(), Some(5));
}

/// Failure: a set cancelled during rendering continues or leaves a marker.
#[test]
fn a_cancelled_run_ends_without_a_marker() {
    let work = Work::new(&job(40));
    let slow = [("FATHOM_FAULTS", "frame=hang#39")];
    let run = work.start(&["--frames-per-shard", "40", "--state-interval-s", "0.1"], &slow);
    while !work.set().join("job.json").exists() {
        std::thread::sleep(Duration::from_millis(10));
    }
    fs::write(work.set().join("state.json"), r#"{"state": "cancelled"}"#).expect("a writable set");
    let output = run.wait_with_output().expect("a child ends");
    assert_eq!(output.status.code(), Some(2), "{}", text(&output.stderr));
    assert!(files(&work.set().join("done")).is_empty() && files(&work.set().join("shards")).is_empty());
}

/// Failure: the manifest of a complete set lacks its digest, or an incomplete set is sealed.
#[test]
fn only_a_complete_set_is_sealed() {
    let work = Work::new(&job(20));
    let expected = digest_by_render(&job(20), work.folder(), "2");
    assert!(
        work.render(&["--frames-per-shard", "5", "--shard", "0/2"])
            .status
            .success()
    );
    assert_eq!(work.command("seal", &[]).status.code(), Some(2));
    assert!(work.render(&[]).status.success());
    let closed = Command::new(fathom())
        .arg("seal")
        .arg(work.set())
        .stdout(Stdio::piped())
        .spawn();
    let mut closed = closed.expect("the binary starts");
    drop(closed.stdout.take());
    assert!(
        closed.wait().expect("an end").success(),
        "a closed pipe is no failure"
    );
    for _ in 0..2 {
        let output = work.command("seal", &[]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        let manifest: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        assert_eq!(
            (&manifest["digest"], &manifest["images"]),
            (&json!(expected), &json!(20))
        );
        assert!(
            manifest["sources"][0]["licence"]
                .as_str()
                .is_some_and(|licence| !licence.is_empty())
        );
    }
}

fn digest_in(printed: &[u8]) -> Option<String> {
    text(printed)
        .lines()
        .find_map(|line| line.strip_prefix("digest ").map(str::to_owned))
}

fn job(frames: u64) -> Value {
    json!({
        "dataset": "sets", "count": frames, "seed": 3,
        "scene": {"kind": "procedural", "family": "structure", "seed": {"int": [0, 99]}},
        "camera": {"width": 40, "height": 24, "hfov_deg": 80},
        "water": {"optics": "jerlov-3C"},
        "artifacts": ["rgb", "range"]
    })
}

/// Sends SIGKILL to every child of a process; returns whether there was one.
fn kill_children(parent: u32) -> bool {
    let path = format!("/proc/{parent}/task/{parent}/children");
    let children = fs::read_to_string(path).unwrap_or_default();
    let killed = children.split_whitespace().filter(|child| {
        let status = Command::new("kill").args(["-KILL", child]).status();
        status.is_ok_and(|status| status.success())
    });
    killed.count() > 0
}
