//! A disk that refuses writes with EIO: `tests/chaos/eio.c`.

#![allow(clippy::unwrap_used)]

use std::time::{Duration, Instant};

use fathom_tests::{Service, audit, compile};
use imaging::Rgb8;
use imaging::codec::encode_png;
use serde_json::{Value, json};

const FRAMES: u64 = 60;

fn job(seed: u64) -> Value {
    json!({
        "dataset": "refused", "count": FRAMES, "seed": seed,
        "scene": {"kind": "procedural", "family": "structure", "seed": {"int": [0, 99]}},
        "camera": {"width": 96, "height": 64, "hfov_deg": 80},
        "water": {"optics": "jerlov-3C"}
    })
}

fn check_refusal(what: &str, response: &(u16, Value)) {
    let (status, problem) = response;
    assert_eq!(*status, 503, "{what}: {problem}");
    assert_eq!(problem["type"], "/problems/storage-failed", "{what}: {problem}");
    let detail = problem["detail"].as_str().unwrap();
    let is_named = detail.contains("I/O error") || detail.contains("Input/output error");
    assert!(is_named, "{what}: {detail}");
}

/// Failure: a write that is accepted or fails without the reason, a read that fails, a readiness that hides the failure
/// or outlasts it, or a frame that is lost or given up.
#[test]
fn a_disk_that_refuses_writes_is_reported_with_the_reason_until_writes_work_again() {
    let folder = tempfile::tempdir().unwrap();
    let (data, flag) = (folder.path().join("data"), folder.path().join("refuse"));
    let photo = encode_png(&Rgb8::from_fn(64, 48, |x, y| [x as u8, y as u8, 7]).into()).unwrap();
    let library = compile("eio.c", folder.path());
    let environment = [
        ("LD_PRELOAD", library.to_str().unwrap()),
        ("FATHOM_EIO_FOLDER", data.to_str().unwrap()),
        ("FATHOM_EIO_FLAG", flag.to_str().unwrap()),
    ];
    let service = Service::start_with(&data, &["--workers", "1", "--slots", "2"], &environment);
    let id = service.submit(&job(1));
    std::fs::write(&flag, b"").unwrap();
    check_refusal("a submission", &service.post("/v1/jobs", &job(2)));
    check_refusal("a readiness", &service.get("/readyz"));
    check_refusal("an upload", &service.form("/v1/scenes", &[("rgb", &photo)]));
    assert_eq!(service.get(&format!("/v1/jobs/{id}")).0, 200, "reads continue");
    std::thread::sleep(Duration::from_secs(2));
    std::fs::remove_file(&flag).unwrap();
    let begun = Instant::now();
    while service.get_bytes("/readyz").0 != 200 {
        assert!(
            begun.elapsed() < Duration::from_secs(20),
            "{:?}",
            service.get("/readyz")
        );
        std::thread::sleep(Duration::from_millis(50));
    }
    println!("ready {:?} after the disk", begun.elapsed());
    let other = service.submit(&job(3));
    for job in [&id, &other] {
        let ended = service.finished(job);
        assert_eq!(
            (&ended["state"], &ended["done"]),
            (&json!("done"), &json!(FRAMES)),
            "{ended}"
        );
    }
    drop(service);
    audit(&data, &[&id, &other], "after the refusals");
}
