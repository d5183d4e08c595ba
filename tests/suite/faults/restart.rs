//! A kill of the service while a job starts again.

#![allow(clippy::unwrap_used)]

use std::path::Path;
use std::process::Command;

use fathom_tests::{Service, audit};
use serde_json::{Value, json};

const FRAMES: u64 = 4;
/// Changes of the catalogue until a restart has ended, with some more.
const COMMITS: u64 = 6;

fn created(service: &Service, id: &str) -> Vec<Value> {
    let image = |frame: u64| service.get(&format!("/v1/images/{id}/{frame}")).1;
    (0..FRAMES)
        .map(|frame| image(frame)["created_at"].clone())
        .collect()
}

/// A data folder with a finished job of any kind of machine; its id and the times of its images.
fn finish_job(data: &Path) -> (String, Vec<Value>) {
    let service = Service::start(data, &["--workers", "0"]);
    let id = service.submit(&json!({
        "dataset": "again", "count": FRAMES, "seed": 8,
        "scene": {"kind": "procedural", "family": "structure", "seed": {"int": [0, 99]}},
        "camera": {"width": 16, "height": 12, "hfov_deg": 80}, "metrics": []
    }));
    let (status, row) = service.post(&format!("/v1/jobs/{id}/finish-elsewhere"), &json!({}));
    assert_eq!((status, &row["mixed"]), (200, &json!(true)), "{row}");
    drop(service);
    let service = Service::start(data, &["--workers", "1"]);
    assert_eq!(service.finished(&id)["state"], "done");
    let times = created(&service, &id);
    (id, times)
}

/// Failure: after a kill, the job is neither as before nor one that starts again: it has images of its earlier run among new
/// ones, or new images under the old rules.
#[test]
fn a_kill_while_a_job_starts_again_leaves_the_old_job_or_the_new_one() {
    let folder = tempfile::tempdir().unwrap();
    let (id, before) = finish_job(&folder.path().join("data"));
    let mut killed = 0;
    for commit in 1..=COMMITS {
        let data = folder.path().join(format!("data-{commit}"));
        let copied = Command::new("cp")
            .arg("-a")
            .arg(folder.path().join("data"))
            .arg(&data)
            .status();
        assert!(copied.is_ok_and(|status| status.success()));
        let fault = format!("catalogue.committed=abort@{commit}");
        if let Ok(service) = Service::launch(&data, &["--workers", "0"], &[("FATHOM_FAULTS", &fault)]) {
            let response = service.try_post_bytes(&format!("/v1/jobs/{id}/start-again"), b"");
            killed += u64::from(response.is_none());
            service.kill();
        }
        let service = Service::start(&data, &["--workers", "1"]);
        let row = service.finished(&id);
        let kept = created(&service, &id)
            .iter()
            .zip(&before)
            .filter(|(now, then)| now == then)
            .count();
        let is_old = row["mixed"] == true && kept as u64 == FRAMES;
        let is_new = row["mixed"].is_null() && kept == 0;
        assert!(is_old || is_new, "commit {commit}: {kept} images kept: {row}");
        drop(service);
        audit(&data, &[&id], "after a restart");
    }
    assert!(killed >= 2, "{killed} kills");
}
