//! Sets over stores that misbehave, without a process that renders.

use std::thread;
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use spec::{Job, SetState, Vocabulary};

use crate::error::SetError;
use crate::operations::plan::Selection;
use crate::rows::columns::columns;
use crate::set::job::{Card, NewSet};
use crate::set::marker::{Commit, FailedFrame, Marker};
use crate::set::opened::Set;
use crate::storage::faulty::{Fault, store};
use crate::storage::layout;
use crate::storage::location::Location;
use crate::storage::store::Store;
use crate::storage::upload::{FileSum, Upload};

fn job(count: u64) -> Job {
    let text = format!(
        r#"{{"dataset": "reef", "count": {count}, "artifacts": ["rgb"], "metrics": ["uiqm"], "camera": {{"width": 8, "height": 8}},
            "scene": {{"kind": "procedural", "family": "structure", "seed": 1}}}}"#
    );
    let vocabulary = Vocabulary {
        families: vec!["structure".to_owned()],
        metrics: vec!["uiqm".to_owned()],
        ..Vocabulary::default()
    };
    Job::parse(text.as_bytes(), &vocabulary).unwrap()
}

fn begin(store: &Store, count: u64) -> Result<Set, SetError> {
    let new = NewSet {
        job: &job(count),
        frames_per_shard: Some(10),
        parts: 1,
        code_version: "1",
        metrics: vec!["uiqm".to_owned()],
    };
    Set::begin_in(store.clone(), &new)
}

fn marker(attempt: &str, digest: &str) -> Marker {
    let sum = FileSum {
        sha256: "0".to_owned(),
        bytes: 1,
    };
    Marker {
        shard: 3,
        attempt: attempt.to_owned(),
        digest: digest.to_owned(),
        images: 10,
        failed: Vec::new(),
        tar: sum.clone(),
        rows: sum,
        cpu_features: "avx2".to_owned(),
    }
}

#[test]
fn a_set_is_begun_once_and_holds_one_job() {
    let store = store(Fault::None);
    assert_eq!(begin(&store, 95).unwrap().card().shards(), 10);
    let set = begin(&store, 95).unwrap();
    assert_eq!(set.card().frames_of(9), 90..95);
    let Err(SetError::Refused(reason)) = begin(&store, 96) else {
        panic!("another job is refused");
    };
    assert!(
        reason.contains(&job(95).digest()) && reason.contains(&job(96).digest()),
        "{reason}"
    );
    assert!(
        store.list(layout::PROBE).unwrap().is_empty(),
        "probes are removed"
    );
}

#[test]
fn a_small_job_has_a_shard_for_each_process_and_no_shard_is_cut() {
    let small = job(95);
    let new = |parts: u64| NewSet {
        job: &small,
        frames_per_shard: None,
        code_version: "0.2.0",
        metrics: Vec::new(),
        parts,
    };
    let shards = |parts: u64| Card::new(&new(parts)).unwrap().shards();
    assert_eq!([1, 4, 60, 95, 1000].map(shards), [1, 4, 95, 95, 95]);
    let card = Card::new(&new(4)).unwrap();
    let selected = |frames: &str| Selection::parse(None, Some(frames)).unwrap().shards(&card);
    assert_eq!(selected("24..95").unwrap(), [1, 2, 3]);
    let Err(SetError::Refused(reason)) = selected("20..50") else {
        panic!("20..50 cuts two shards");
    };
    assert!(reason.contains("give 0..72"), "{reason}");
}

#[test]
fn labels_that_rows_would_round_are_refused() {
    let text = r#"{"dataset": "reef", "metrics": [], "camera": {"width": 8, "height": 8}, "labels": {"run": {"choice": [1, 9007199254740993]}},
        "scene": {"kind": "procedural", "family": "structure", "seed": 1}}"#;
    let vocabulary = Vocabulary {
        families: vec!["structure".to_owned()],
        ..Vocabulary::default()
    };
    let set = NewSet {
        job: &Job::parse(text.as_bytes(), &vocabulary).unwrap(),
        frames_per_shard: None,
        parts: 1,
        code_version: "0.2.0",
        metrics: Vec::new(),
    };
    let Err(SetError::Refused(reason)) = Card::new(&set) else {
        panic!("a double rounds 9007199254740993");
    };
    assert!(reason.contains("`labels.run` is 9007199254740993"), "{reason}");
}

#[test]
fn rows_have_the_columns_of_every_site() {
    let text = r#"{"dataset": "reef", "metrics": ["uiqm"], "camera": {"width": 8, "height": 8},
        "scene": {"kind": "procedural", "family": "structure", "seed": 1},
        "site": {"choice": [{"name": "harbor", "artifacts": ["rgb"]},
                            {"name": "bay", "artifacts": ["rgb", "range"], "enhance": ["hscm"]}]}}"#;
    let vocabulary = Vocabulary {
        families: vec!["structure".to_owned()],
        metrics: vec!["uiqm".to_owned()],
        ..Vocabulary::default()
    };
    let job = Job::parse(text.as_bytes(), &vocabulary).unwrap();
    let columns = columns(&job, &["uiqm".to_owned()]);
    for name in ["uiqm", "hscm.uiqm", "artifacts.rgb", "artifacts.range.offset"] {
        assert!(columns.iter().any(|column| column.name == name), "{name}");
    }
}

#[test]
fn a_set_of_version_0_1_is_read_but_has_no_job_to_render() {
    let mut description: Value = serde_json::from_str(job(95).canonical()).unwrap();
    description.as_object_mut().unwrap().remove("daylight");
    let text = description.to_string();
    let card = json!({"format": 1, "digest": spec::sha256(text.as_bytes()), "job": text, "frames": 95, "frames_per_shard": 10,
                      "code_version": "0.1.0", "metrics": ["uiqm"]});
    let (card, job) = Card::read(card.to_string().as_bytes()).unwrap();
    assert!(job.is_none());
    assert_eq!((card.dataset().as_str(), card.shards()), ("reef", 10));
}

#[test]
fn a_store_that_ignores_conditions_is_refused_and_left_empty() {
    let store = store(Fault::IgnoresConditions);
    assert!(matches!(begin(&store, 95), Err(SetError::Refused(reason)) if reason.contains("only if absent")));
    assert!(store.list("").unwrap().is_empty());
}

#[test]
fn a_lost_reply_is_no_refusal() {
    let store = store(Fault::LosesReplies(1));
    assert_eq!(marker("a", "x").commit(&store).unwrap(), Commit::Won);
    assert_eq!(marker("b", "x").commit(&store).unwrap(), Commit::Lost);
}

#[test]
fn the_first_marker_stays_and_a_contradiction_raises_an_alarm() {
    let store = store(Fault::None);
    assert_eq!(marker("a", "x").commit(&store).unwrap(), Commit::Won);
    let existing = "x".to_owned();
    assert_eq!(
        marker("b", "y").commit(&store).unwrap(),
        Commit::Contradicted { existing }
    );
    let first = Marker::read("", &store.get(&layout::done(3)).unwrap().unwrap()).unwrap();
    assert_eq!(first, marker("a", "x"));
    assert_eq!(store.list(layout::ALARM).unwrap().len(), 1);
}

#[test]
fn a_full_store_is_tried_again_later_and_one_that_refuses_access_is_not() {
    let full = begin(&store(Fault::IsFull), 95);
    assert!(matches!(full, Err(SetError::Later(reason)) if reason.contains("is full")));
    let denied = begin(&store(Fault::RefusesAccess), 95);
    assert!(matches!(denied, Err(SetError::Refused(reason)) if reason.contains("AWS_ACCESS_KEY_ID")));
}

#[test]
fn an_upload_is_visible_only_when_it_is_finished() {
    let store = store(Fault::None);
    for is_kept in [false, true] {
        let mut upload = Upload::new(&store, layout::tar(1, "a"));
        std::io::Write::write_all(&mut upload, &vec![7; 20 << 20]).unwrap();
        assert!(store.list(layout::SHARDS).unwrap().is_empty());
        if is_kept {
            assert_eq!(upload.finish().unwrap().bytes, 20 << 20);
        } else {
            upload.abandon();
        }
    }
    let entry = store.entry(&layout::tar(1, "a")).unwrap().unwrap();
    assert_eq!(
        (entry.bytes, entry.name),
        (20 << 20, "shards/000001-a.tar".to_owned())
    );
}

#[test]
fn only_missing_shards_are_selected() {
    let set = begin(&store(Fault::None), 95).unwrap();
    let selected =
        |part, frames| Selection::parse(part, frames).and_then(|selection| selection.missing(&set));
    marker("a", "x").commit(&set.store).unwrap();
    assert_eq!(selected(None, None).unwrap(), [0, 1, 2, 4, 5, 6, 7, 8, 9]);
    assert_eq!(selected(Some("1/3"), None).unwrap(), [1, 4, 7]);
    assert_eq!(selected(None, Some("10..50")).unwrap(), [1, 2, 4]);
    assert!(matches!(
        selected(None, Some("90..96")),
        Err(SetError::Refused(_))
    ));
}

#[test]
fn status_counts_what_is_done_and_sweeping_leaves_the_winners() {
    let set = begin(&store(Fault::None), 95).unwrap();
    let failed = FailedFrame {
        frame: 31,
        error: "no water".to_owned(),
    };
    let winner = Marker {
        failed: vec![failed.clone()],
        ..marker("a", "x")
    };
    for (shard, attempt) in [(3, "a"), (3, "b"), (4, "c")] {
        for name in [layout::tar(shard, attempt), layout::rows(shard, attempt)] {
            set.store.replace(&name, b"files").unwrap();
        }
    }
    winner.commit(&set.store).unwrap();
    let status = set.status().unwrap();
    let counts = (
        status.done,
        status.frames_done,
        status.failed,
        status.orphans,
        status.unfinished,
    );
    assert_eq!(counts, (1, 10, 1, 2, 2));
    assert_eq!(set.failed_frames(&Selection::default()).unwrap(), [failed]);
    assert_eq!(set.sweep(86_400_000).unwrap(), 0, "what is young stays");
    assert_eq!(set.sweep(0).unwrap(), 4);
    let left: Vec<String> = set
        .store
        .list(layout::SHARDS)
        .unwrap()
        .into_iter()
        .map(|entry| entry.name)
        .collect();
    assert_eq!(left, [winner.tar_name()]);
}

#[test]
fn a_cancelled_set_stays_cancelled_whoever_pauses_and_resumes_it() {
    let folder = tempfile::tempdir().unwrap();
    let in_folder = Location::Folder(folder.path().to_owned());
    for store in [store(Fault::None), Store::open(&in_folder).unwrap()] {
        let set = begin(&store, 95).unwrap();
        let begun = Instant::now();
        thread::scope(|scope| {
            // They are still running when the set is cancelled, even on a fast machine, and all end.
            let changes: Vec<_> = (0..3)
                .map(|_| {
                    scope.spawn(|| {
                        let states = [SetState::Paused, SetState::Running].into_iter().cycle();
                        states
                            .take_while(|_| begun.elapsed() < Duration::from_secs(60))
                            .find_map(|state| set.set_state(state).err())
                    })
                })
                .collect();
            thread::sleep(Duration::from_millis(50));
            set.set_state(SetState::Cancelled).unwrap();
            for change in changes {
                let refused = change.join().unwrap();
                assert!(matches!(refused, Some(SetError::Refused(_))), "{refused:?}");
            }
        });
        assert_eq!(set.state().unwrap(), SetState::Cancelled);
    }
}

#[test]
fn a_pipe_in_place_of_a_file_is_refused_at_once() {
    let folder = tempfile::tempdir().unwrap();
    let store = Store::open(&Location::Folder(folder.path().to_owned())).unwrap();
    let pipe = folder.path().join("set.json");
    assert!(
        std::process::Command::new("mkfifo")
            .arg(&pipe)
            .status()
            .unwrap()
            .success()
    );
    let begun = Instant::now();
    let refusals = [
        store.get("set.json").map(drop),
        store.entry("set.json").map(drop),
        store.range("set.json", 0..1).map(drop),
    ];
    for refused in refusals {
        assert!(
            matches!(&refused, Err(SetError::Damaged(reason)) if reason == "set.json is not a regular file"),
            "{refused:?}"
        );
    }
    assert!(begun.elapsed() < Duration::from_secs(5));
    assert!(store.get("absent.json").unwrap().is_none());
}
