//! The life of a job: submission, lease, commit, queries; repetition, cancellation, resumption.

use std::time::{Duration, Instant};

use crate::common::worker::Fake;
use crate::common::{job, start, start_on};
use renderer::worker::client::ClientError;
use serde_json::json;
use wire::messages::Lease;

#[test]
fn a_submitted_job_becomes_queryable_images() {
    let service = start();
    let accepted = service.post("/v1/jobs", &job());
    assert_eq!(accepted.status, 202, "{}", accepted.text());
    let id = accepted.json()["id"].as_str().unwrap().to_owned();
    assert_eq!(accepted.header("location"), format!("/v1/jobs/{id}"));
    Fake::register(&service).work();
    let done = service.get(&format!("/v1/jobs/{id}")).json();
    assert_eq!(
        (&done["state"], &done["done"]),
        (&json!("done"), &json!(2)),
        "{done}"
    );
    assert!(
        done["digest"].as_str().is_some_and(|digest| digest.len() == 64),
        "{done}"
    );

    let rows = service
        .get("/v1/images?dataset=tests&filter=uiqm%20%3E%201&fields=frame,uiqm")
        .json();
    assert_eq!(rows["items"], json!([{"frame": 1, "uiqm": 1.5}]));
    let record = service.get(&format!("/v1/images/{id}/1")).json();
    assert_eq!(record["job"], json!(id), "{record}");
    assert_eq!(record["measurements"]["rgb"]["uiqm"], 1.5);
    let stats = service.get("/v1/datasets/tests/stats?metrics=uiqm").json();
    assert_eq!(
        (&stats["groups"][0]["count"], &stats["groups"][0]["mean"]),
        (&json!(2), &json!(1.0)),
        "{stats}"
    );
    assert_eq!(service.get("/v1/datasets").json()["items"][0]["images"], 2);
    assert_eq!(service.get("/v1/workers").json()["items"][0]["name"], "fake");
    let metrics = service.get("/metrics").text();
    for name in [
        "fathom_requests_total",
        "fathom_request_seconds_bucket",
        "fathom_frames_committed_total",
        "fathom_frames_queued",
        "fathom_frames_leased",
        "fathom_stage_seconds_bucket",
        "fathom_queue_age_seconds",
        "fathom_leases_granted_total",
        "fathom_leases_expired_total",
        "fathom_attempts_total",
        "fathom_commit_bytes_bucket",
        "fathom_commit_operations_bucket",
        "fathom_wal_bytes",
        "fathom_store_bytes",
    ] {
        assert!(
            metrics.contains(&format!("\n{name}")),
            "{name} is not in {metrics}"
        );
    }
}

#[test]
fn the_same_key_returns_the_same_job_and_rejects_another_description() {
    let service = start();
    let key = [("content-type", "application/json"), ("idempotency-key", "once")];
    let post = |body: &serde_json::Value| service.post_with("/v1/jobs", &key, body.to_string().as_bytes());
    let first = post(&job()).json();
    assert_eq!(post(&job()).json()["id"], first["id"]);
    let mut other = job();
    other["seed"] = json!(8);
    post(&other).problem(422, "idempotency-key-reused");
    assert_eq!(service.shown()[0], 1);
    let long = "k".repeat(256);
    let headers = [
        ("content-type", "application/json"),
        ("idempotency-key", long.as_str()),
    ];
    service
        .post_with("/v1/jobs", &headers, job().to_string().as_bytes())
        .problem(400, "invalid-header");
}

#[test]
fn a_long_poll_wakes_with_the_change_and_not_before() {
    let service = start();
    let id = service.submit(&job());
    let version = service.get(&format!("/v1/jobs/{id}")).json()["version"]
        .as_u64()
        .unwrap();
    let begun = Instant::now();
    let same = service
        .get(&format!("/v1/jobs/{id}?wait=1&since={version}"))
        .json();
    assert_eq!(same["version"], version);
    assert!(begun.elapsed() >= Duration::from_secs(1));

    std::thread::scope(|scope| {
        let waiting = scope.spawn(|| {
            service
                .get(&format!("/v1/jobs/{id}?wait=60&since={version}"))
                .json()
        });
        let worker = Fake::register(&service);
        let begun = Instant::now();
        worker.work();
        let changed = waiting.join().unwrap();
        assert!(changed["version"].as_u64().unwrap() > version, "{changed}");
        assert!(begun.elapsed() < Duration::from_secs(20));
    });
    let ended = service.get(&format!("/v1/jobs/{id}?wait=60&since=999999")).json();
    assert_eq!(ended["state"], "done");
}

#[test]
fn a_waiting_worker_gets_a_job_as_soon_as_it_is_submitted() {
    let service = start();
    let worker = Fake::register(&service);
    std::thread::scope(|scope| {
        let waiting = scope.spawn(|| worker.lease(30_000));
        let begun = Instant::now();
        let id = service.submit(&job());
        let lease = waiting.join().unwrap().expect("frames");
        assert_eq!(lease.job_id, id);
        assert!(begun.elapsed() < Duration::from_secs(10));
    });
}

#[test]
fn a_cancelled_job_offers_no_frames_and_its_worker_is_notified() {
    let service = start();
    let id = service.submit(&job());
    let worker = Fake::register(&service);
    let lease = worker.lease(1000).expect("frames");
    let cancelled = service.post(&format!("/v1/jobs/{id}/cancel"), &json!({}));
    assert_eq!(
        (cancelled.status, &cancelled.json()["state"]),
        (200, &json!("cancelled"))
    );
    let beat = worker.beat(&[lease.token]);
    assert_eq!(beat.cancelled, [lease.token]);
    assert!(worker.lease(300).is_none());
    assert_eq!(
        service.post(&format!("/v1/jobs/{id}/cancel"), &json!({})).status,
        200
    );
    service
        .post("/v1/jobs/job_x/cancel", &json!({}))
        .problem(404, "not-found");
}

#[test]
fn a_stale_token_changes_nothing_and_a_repeated_commit_is_harmless() {
    let service = start();
    let id = service.submit(&job());
    let worker = Fake::register(&service);
    let lease = worker.lease(1000).expect("frames");
    let forged = Lease {
        token: lease.token + 1,
        ..lease.clone()
    };
    assert!(matches!(worker.finish(&forged), Err(ClientError::Stale)));
    assert_eq!(service.shown()[2], 0);
    worker.release(&lease);
    assert!(matches!(worker.finish(&lease), Err(ClientError::Stale)));
    worker.work();
    assert_eq!(service.get(&format!("/v1/jobs/{id}")).json()["state"], "done");
    assert_eq!(service.shown()[2], 2);
}

#[test]
fn a_failure_that_is_final_ends_the_frame_and_the_job() {
    let service = start();
    let mut one = job();
    one["count"] = json!(1);
    let id = service.submit(&one);
    let worker = Fake::register(&service);
    let lease = worker.lease(1000).expect("a frame");
    worker.fail(&lease, "no such scene");
    let ended = service.get(&format!("/v1/jobs/{id}?wait=10")).json();
    assert_eq!(
        (&ended["state"], &ended["failed"]),
        (&json!("done_with_failures"), &json!(1)),
        "{ended}"
    );
}

#[test]
fn a_restart_offers_open_frames_and_drops_old_workers_and_tokens() {
    let service = start();
    let id = service.submit(&job());
    let worker = Fake::register(&service);
    let lease = worker.lease(1000).expect("frames");
    worker.finish(&lease).unwrap();
    let service = start_on(service.stop(), crate::common::Setup::default());
    let fresh = Fake::register(&service);
    assert!(matches!(fresh.finish(&lease), Err(ClientError::Stale)));
    let old = Fake {
        client: fresh.client.clone(),
        id: worker.id,
    };
    assert!(matches!(old.try_lease(0), Err(ClientError::UnknownWorker)));
    fresh.work();
    let done = service.get(&format!("/v1/jobs/{id}")).json();
    assert_eq!(
        (&done["state"], &done["done"]),
        (&json!("done"), &json!(2)),
        "{done}"
    );
}

#[test]
fn a_job_with_a_style_of_another_form_needs_a_runtime_somewhere() {
    let service = start();
    let mut styled = job();
    styled["water"]["style"] = json!("muddy");
    service.submit(&styled);
    styled["water"]["style"] = json!({"choice": ["muddy", "foreign"]});
    let problem = service.post("/v1/jobs", &styled).problem(409, "runtime-missing");
    assert!(
        problem["detail"]
            .as_str()
            .unwrap()
            .contains("scripts/get-onnxruntime.sh"),
        "{problem}"
    );
    Fake::with_runtime(&service, Some("1.31.1"));
    service.submit(&styled);
}

#[test]
fn a_preview_shows_frames_and_cost_and_stores_nothing() {
    let service = start();
    let mut body = job();
    body["count"] = json!(1000);
    body["camera"]["hfov_deg"] = json!({"uniform": [60.0, 80.0]});
    body["water"]["range_scale"] = json!({"grid": [0.5, 2.0]});
    let preview = service.post("/v1/jobs/preview?frames=3", &body);
    assert_eq!(preview.status, 200, "{}", preview.text());
    let preview = preview.json();
    assert_eq!(preview["frames"], 2000);
    let first = preview["first"].as_array().unwrap();
    assert_eq!(first.len(), 3);
    assert_eq!(first[1]["parameters"]["water"]["range_scale"], 2.0, "{preview}");
    let hfov = first[2]["parameters"]["camera"]["hfov_deg"].as_f64().unwrap();
    assert!(hfov > 60.0 && hfov < 80.0);
    let seconds = |preview: &serde_json::Value| preview["estimate"]["seconds"].as_f64().unwrap();
    assert!(seconds(&preview) > 0.0 && preview["estimate"]["bytes"].as_f64().unwrap() > 2000.0);
    let mut twice = body.clone();
    twice["count"] = json!(2000);
    let twice = service.post("/v1/jobs/preview", &twice).json();
    assert!(
        (seconds(&twice) / seconds(&preview) - 2.0).abs() < 0.01,
        "{twice}"
    );
    assert_eq!(service.shown(), [0, 0, 0]);

    service
        .post("/v1/jobs/preview?frames=101", &body)
        .problem(400, "invalid-query");
    body["camera"] = json!({"hfov_deg": 200});
    service.post("/v1/jobs/preview", &body).problem(422, "validation");
    body["camera"] = json!({"hfov_deg": 80});
    body["scene"] = json!({"kind": "uploaded", "id": "scn_00000000000000000000000000000000"});
    service.post("/v1/jobs/preview", &body).problem(422, "validation");
}

#[test]
fn a_job_with_existing_images_returns_the_earlier_job() {
    let service = start();
    let first = service.submit(&job());
    Fake::register(&service).work();
    let again = service.post("/v1/jobs", &job());
    assert_eq!(again.status, 200, "{}", again.text());
    assert_eq!(again.header("location"), format!("/v1/jobs/{first}"));
    let answer = again.json();
    assert_eq!((&answer["id"], &answer["state"]), (&json!(first), &json!("done")));
    assert!(
        answer["warnings"][0]
            .as_str()
            .unwrap()
            .contains("every image of this description"),
        "{answer}"
    );
    assert_eq!(service.shown(), [1, 0, 2]);
    let wanted = service.post("/v1/jobs?again=true", &job());
    assert_eq!(wanted.status, 202, "{}", wanted.text());
    assert_ne!(wanted.json()["id"], json!(first));
    assert!(wanted.json()["warnings"].is_null());
    let stats = |query: &str| service.get(&format!("/v1/datasets/tests/stats?metrics=uiqm{query}"));
    let grouped = stats("&by=dataset,frame:10").json();
    assert_eq!(
        grouped["by"][1],
        json!({"column": "frame", "unit": null, "width": 10.0})
    );
    assert_eq!(
        grouped["groups"][0]["group"],
        json!({"dataset": "tests", "frame": 0.0})
    );
    assert_eq!(grouped["groups"][0]["count"], 2);
    stats("&by=alpha&group_by=alpha").problem(400, "invalid-query");
    stats("&by=alpha:x").problem(400, "invalid-filter");
}
