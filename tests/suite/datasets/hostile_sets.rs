//! Sets whose authors attack the service that imports them. The comment above each test defines failure.

use std::process::Command;
use std::time::{Duration, Instant};

use fathom_tests::Service;
use serde_json::{Value, json};

use crate::datasets::sets::{Work, text};

fn serve(work: &Work) -> Service {
    let store = work.folder().to_str().expect("text");
    let data = work.folder().join("data");
    Service::start(&data, &["--workers", "0", "--store", store])
}

fn job() -> Value {
    json!({
        "dataset": "reef", "count": 10, "seed": 5,
        "scene": {"kind": "procedural", "family": "structure", "seed": 1},
        "camera": {"width": 40, "height": 24, "hfov_deg": 70},
        "water": {"optics": "jerlov-3C"}, "metrics": []
    })
}

/// Failure: pipes in place of files that block imports of other sets, or that are not named.
#[test]
fn pipes_block_no_import() {
    let work = Work::new(&job());
    let rendered = work.render(&[]);
    assert!(rendered.status.success(), "{}", text(&rendered.stderr));
    let service = serve(&work);
    let mut traps = Vec::new();
    for number in 0..4 {
        let set = work.folder().join(format!("trap-{number}"));
        std::fs::create_dir(&set).expect("a folder");
        let made = Command::new("mkfifo").arg(set.join("job.json")).status();
        assert!(made.is_ok_and(|status| status.success()));
        traps.push(set);
    }
    let begun = Instant::now();
    std::thread::scope(|scope| {
        for trap in &traps {
            let service = &service;
            scope.spawn(move || {
                let (status, problem) = service.post("/v1/sets", &json!({"url": trap}));
                let detail = problem["detail"].to_string();
                assert!(
                    status == 422 && detail.contains("not a regular file"),
                    "{problem}"
                );
            });
        }
    });
    let (status, set) = service.post("/v1/sets", &json!({"url": work.set()}));
    assert_eq!(status, 202, "{set}");
    assert!(begun.elapsed() < Duration::from_secs(20), "{:?}", begun.elapsed());
    let ended = service.finished(set["job"].as_str().expect("an id"));
    assert_eq!(ended["state"], "done", "{ended}");
}

/// Failure: a damaged set that is read every two seconds with the same result, or cannot be deleted.
#[test]
fn a_followed_set_that_turns_bad_is_read_less_often_and_can_be_deleted() {
    let work = Work::new(&job());
    let first = work.render(&["--frames-per-shard", "5", "--shard", "0/2"]);
    assert!(first.status.success(), "{}", text(&first.stderr));
    let service = serve(&work);
    let (status, set) = service.post("/v1/sets", &json!({"url": work.set()}));
    assert_eq!(status, 202, "{set}");
    let id = set["job"].as_str().expect("an id").to_owned();
    let marker = work.set().join("done/000001.json");
    std::fs::write(&marker, "not a marker").expect("a file");
    let mut polls = std::collections::BTreeSet::new();
    let begun = Instant::now();
    while begun.elapsed() < Duration::from_secs(24) {
        let (_, view) = service.get(&format!("/v1/sets/{id}"));
        if !view["error"].is_null() {
            polls.insert(view["looked_at"].to_string());
        }
        std::thread::sleep(Duration::from_millis(100));
    }
    println!("{} failed polls in 24 s", polls.len());
    assert!((1..=5).contains(&polls.len()), "{polls:?}");
    let deleting = Instant::now();
    assert_eq!(service.delete(&format!("/v1/sets/{id}")).0, 200);
    assert!(deleting.elapsed() < Duration::from_secs(5));
}
