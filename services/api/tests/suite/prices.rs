//! Prices of jobs and their limits.

use std::time::Duration;

use api::PriceLimits;
use serde_json::{Value, json};

use crate::common::worker::Fake;
use crate::common::{Answer, Running, Setup, job, start, start_on, start_with};
use crate::fairness::post_as;

/// A small frame with a million paths for each pixel.
fn expensive() -> Value {
    json!({
        "dataset": "truth", "count": 1000, "scene": {"kind": "procedural", "family": "structure", "seed": 3},
        "camera": {"width": 48, "height": 32}, "water": {"optics": "jerlov-1C"},
        "artifacts": ["rgb", "truth"], "truth": {"paths_max": 1_048_576}
    })
}

#[test]
fn a_frame_that_takes_hours_is_refused_with_the_figure_and_the_remedy() {
    let service = start();
    let mut single = expensive();
    single["count"] = json!(1);
    let (preview, submission) = ("/v1/jobs/preview", "/v1/jobs");
    for (path, body) in [
        (submission, expensive()),
        (preview, expensive()),
        ("/v1/renders", single),
    ] {
        let problem = service.post(path, &body).problem(422, "too-expensive");
        let detail = problem["detail"].as_str().unwrap();
        for part in ["2.7 h", "60 min", "--max-frame-s", "paths_max"] {
            assert!(detail.contains(part), "{path}: {part}: {detail}");
        }
        assert!(problem["frame_seconds"].as_f64().unwrap() > 9000.0);
    }
    assert_eq!(service.shown()[0], 0);
    let mut cheap = expensive();
    cheap["truth"]["paths_max"] = json!(4096);
    assert_eq!(service.post("/v1/jobs", &cheap).status, 202);
}

#[test]
fn the_limit_of_a_frame_can_be_changed() {
    let service = start_with(Setup {
        prices: PriceLimits {
            frame: Duration::from_secs(20_000),
            ..PriceLimits::default()
        },
        ..Setup::default()
    });
    assert_eq!(service.post("/v1/jobs", &expensive()).status, 202);
}

/// Submits 100 frames of the small job with the dataset as key.
fn submit_as(service: &Running, caller: &str, dataset: &str) -> Answer {
    let mut body = job();
    (body["dataset"], body["count"]) = (json!(dataset), json!(100));
    post_as(
        service,
        caller,
        "/v1/jobs",
        &body,
        &[("idempotency-key", dataset)],
    )
}

/// The price of 100 frames of the small job, s.
fn price_of_100(service: &Running) -> f64 {
    let mut body = job();
    body["count"] = json!(100);
    let preview = service.post("/v1/jobs/preview", &body).json();
    preview["estimate"]["slot_seconds"].as_f64().unwrap()
}

#[test]
fn the_open_jobs_of_a_caller_are_limited_together() {
    let price = price_of_100(&start());
    let mut service = start_with(Setup {
        token: Some("boss,read+submit:alice,read+submit:bob"),
        prices: PriceLimits {
            caller: Duration::from_secs_f64(price * 1.5),
            ..PriceLimits::default()
        },
        ..Setup::default()
    });
    service.token = Some("boss");
    let first = submit_as(&service, "alice", "first");
    assert_eq!(first.status, 202, "{}", first.text());
    let problem = submit_as(&service, "alice", "second").problem(429, "caller-limit");
    let detail = problem["detail"].as_str().unwrap();
    assert!(
        detail.contains("--max-caller-h") && detail.contains("cancel one"),
        "{detail}"
    );
    // The limit is per caller, and a repeated submission returns its job.
    assert_eq!(submit_as(&service, "bob", "third").status, 202);
    assert_eq!(
        submit_as(&service, "alice", "first").json()["id"],
        first.json()["id"]
    );
    let id = first.json()["id"].as_str().unwrap().to_owned();
    let headers = [("authorization", "Bearer alice")];
    assert_eq!(
        service
            .post_with(&format!("/v1/jobs/{id}/cancel"), &headers, b"")
            .status,
        200
    );
    assert_eq!(submit_as(&service, "alice", "second").status, 202);
}

#[test]
fn jobs_of_a_broker_count_among_the_open_ones_of_their_caller() {
    let price = price_of_100(&start());
    let store = tempfile::tempdir().unwrap();
    let setup = || Setup {
        token: Some("boss,read+submit:alice,read+submit:bob"),
        prices: PriceLimits {
            caller: Duration::from_secs_f64(price * 1.5),
            ..PriceLimits::default()
        },
        broker_store: Some(store.path().to_owned()),
        ..Setup::default()
    };
    let mut service = start_with(setup());
    service.token = Some("boss");
    let first = submit_as(&service, "alice", "first");
    assert_eq!(first.status, 202, "{}", first.text());
    assert!(first.json()["set"].is_string(), "{}", first.text());
    submit_as(&service, "alice", "second").problem(429, "caller-limit");
    let mut body = job();
    (body["dataset"], body["count"]) = (json!("second"), json!(100));
    let preview = post_as(&service, "alice", "/v1/jobs/preview", &body, &[]).json();
    assert!(
        preview["warnings"].to_string().contains("--max-caller-h"),
        "{preview}"
    );
    // A repeated submission returns its job, the limit is per caller, and it holds after a restart.
    let again = submit_as(&service, "alice", "first");
    assert_eq!(again.json()["id"], first.json()["id"], "{}", again.text());
    assert_eq!(submit_as(&service, "bob", "third").status, 202);
    let mut service = start_on(service.stop(), setup());
    service.token = Some("boss");
    submit_as(&service, "alice", "second").problem(429, "caller-limit");
    let cancel = format!("/v1/jobs/{}/cancel", first.json()["id"].as_str().unwrap());
    assert_eq!(post_as(&service, "alice", &cancel, &json!({}), &[]).status, 200);
    assert_eq!(submit_as(&service, "alice", "second").status, 202);
}

#[test]
fn the_price_of_a_job_is_shown_and_survives_a_restart() {
    let service = start();
    let mut body = job();
    body["count"] = json!(100);
    let estimate = service.post("/v1/jobs/preview", &body).json()["estimate"].clone();
    let submitted = service.post("/v1/jobs", &body).json();
    let price = &submitted["price"];
    let (shown, estimated) = (&price["slot_seconds"], &estimate["slot_seconds"]);
    assert!(
        (shown.as_f64().unwrap() - estimated.as_f64().unwrap()).abs() < 0.01,
        "{price} {estimate}"
    );
    assert_eq!(price["bytes"].as_f64(), estimate["bytes"].as_f64());
    assert!(estimate["frame_seconds"].as_f64().unwrap() > 0.0);
    let id = submitted["id"].as_str().unwrap();
    let service = start_on(service.stop(), Setup::default());
    assert_eq!(&service.get(&format!("/v1/jobs/{id}")).json()["price"], price);
    assert_eq!(Fake::register(&service).lease(1000).unwrap().job_id, id);
}
