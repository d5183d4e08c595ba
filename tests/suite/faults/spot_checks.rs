//! Workers that return plausible but wrong pictures.

use std::time::{Duration, Instant};

use fathom_tests::{Service, Worker, digest_by_render};
use serde_json::{Value, json};

const LIMIT: Duration = Duration::from_secs(120);

fn job(frames: u64) -> Value {
    json!({
        "dataset": "checked", "count": frames, "seed": 5,
        "scene": {"kind": "procedural", "family": "structure", "seed": {"int": [0, 99]}},
        "camera": {"width": 64, "height": 40, "hfov_deg": 80},
        "water": {"optics": "jerlov-3C"}
    })
}

fn workers(service: &Service) -> Vec<String> {
    let (_, page) = service.get("/v1/workers");
    let items = page["items"].as_array().expect("workers").iter();
    items
        .filter_map(|worker| worker["name"].as_str().map(str::to_owned))
        .collect()
}

fn until(what: &str, holds: impl Fn() -> bool) -> Duration {
    let begun = Instant::now();
    while !holds() {
        assert!(begun.elapsed() < LIMIT, "not within {LIMIT:?}: {what}");
        std::thread::sleep(Duration::from_millis(50));
    }
    begun.elapsed()
}

/// Failure: a picture that differs by one code of one pixel stays, its worker keeps working, or a frame ends with two
/// images or without one.
#[test]
fn a_worker_whose_frame_renders_to_something_else_is_dismissed_and_its_frames_are_rendered_again() {
    let data = tempfile::tempdir().expect("a temporary folder");
    let job = job(40);
    let expected = digest_by_render(&job, data.path(), "2");
    let service = Service::start(data.path(), &["--workers", "0", "--spot-check", "1"]);
    let lies = [("FATHOM_FAULTS", "rgb.wrong=flag")];
    let liar = Worker::start_with(&service.url, "liar", 1, &lies);
    until("the liar registers", || workers(&service) == ["liar"]);
    let id = service.submit(&job);
    let after = until("the liar is dismissed", || workers(&service).is_empty());
    println!(
        "dismissed {:.1} s after the job was submitted",
        after.as_secs_f64()
    );
    let honest = Worker::start(&service.url, "honest", 1);
    let begun = Instant::now();
    let digest = || service.get(&format!("/v1/jobs/{id}")).1["digest"].clone();
    until("the job has the digest of an undisturbed run", || {
        digest() == expected
    });
    println!(
        "all frames right {:.1} s after an honest worker came",
        begun.elapsed().as_secs_f64()
    );
    let (_, row) = service.get(&format!("/v1/jobs/{id}"));
    assert_eq!(
        (&row["state"], &row["done"], &row["failed"]),
        (&json!("done"), &json!(40), &json!(0))
    );
    let (_, dataset) = service.get("/v1/datasets/checked");
    assert_eq!(dataset["images"], json!(40), "{dataset}");
    assert_eq!(workers(&service), ["honest"]);
    drop((liar, honest));
}

/// Failure: a dismissed worker of the service leaves a job waiting without a report.
#[test]
fn a_service_whose_own_worker_is_dismissed_is_not_ready_and_says_why() {
    let data = tempfile::tempdir().expect("a temporary folder");
    // The worker inherits the fault; the checking process renders the same frame and passes the point a second time.
    let faults = [("FATHOM_FAULTS", "rgb.wrong=flag@1")];
    let arguments = ["--workers", "1", "--slots", "1", "--spot-check", "1"];
    let service = Service::start_with(data.path(), &arguments, &faults);
    let _ = service.submit(&job(2000));
    let detail = || {
        service.get("/readyz").1["detail"]
            .as_str()
            .unwrap_or_default()
            .to_owned()
    };
    // Each process counts separately: both are wrong about their first frame, so the second is the first that differs.
    until("the service is not ready", || detail().contains("local-1"));
    assert_eq!(service.get("/readyz").0, 503);
}
