//! Pausing, resuming, retrying, deleting.

use crate::common::worker::Fake;
use crate::common::{Running, job, start, start_on};
use serde_json::{Value, json};

fn order(service: &Running, id: &str, what: &str) -> Value {
    let answer = service.post(&format!("/v1/jobs/{id}/{what}"), &json!({}));
    assert_eq!(answer.status, 200, "{}", answer.text());
    answer.json()
}

fn state(service: &Running, id: &str) -> String {
    service.get(&format!("/v1/jobs/{id}")).json()["state"]
        .as_str()
        .unwrap()
        .to_owned()
}

#[test]
fn a_paused_job_finishes_leased_frames_and_stays_paused_over_a_restart() {
    let service = start();
    let mut three = job();
    three["count"] = json!(3);
    let id = service.submit(&three);
    let worker = Fake::register(&service);
    let held = worker.lease(1000).expect("a frame");
    assert_eq!(order(&service, &id, "pause")["state"], "paused");
    assert_eq!(order(&service, &id, "pause")["state"], "paused");
    assert!(worker.lease(300).is_none(), "a paused job offers nothing");
    assert!(worker.beat(&[held.token]).cancelled.is_empty());
    worker.finish(&held).unwrap();
    let service = start_on(service.stop(), crate::common::Setup::default());
    let worker = Fake::register(&service);
    assert!(worker.lease(300).is_none(), "nor after a restart");
    assert_eq!(state(&service, &id), "paused");
    assert_eq!(order(&service, &id, "resume")["state"], "running");
    worker.work();
    assert_eq!(state(&service, &id), "done");
    for what in ["pause", "resume", "retry-failed"] {
        let refused = service.post(&format!("/v1/jobs/{id}/{what}"), &json!({}));
        let problem = refused.problem(409, "job-state");
        assert!(
            problem["detail"].as_str().unwrap().contains("is done"),
            "{problem}"
        );
        service
            .post(&format!("/v1/jobs/job_x/{what}"), &json!({}))
            .problem(404, "not-found");
    }
}

#[test]
fn frames_that_were_given_up_are_tried_again_on_demand() {
    let service = start();
    let id = service.submit(&job());
    let worker = Fake::register(&service);
    let lease = worker.lease(1000).expect("a frame");
    worker.fail(&lease, "a passing fault");
    worker.work();
    assert_eq!(state(&service, &id), "done_with_failures");
    let again = order(&service, &id, "retry-failed");
    assert_eq!(
        (&again["state"], &again["failed"]),
        (&json!("running"), &json!(0)),
        "{again}"
    );
    worker.work();
    let done = service.get(&format!("/v1/jobs/{id}")).json();
    assert_eq!(
        (&done["state"], &done["done"]),
        (&json!("done"), &json!(2)),
        "{done}"
    );
    assert!(done["digest"].is_string());
}

#[test]
fn a_deleted_job_is_gone_immediately_and_its_worker_is_notified() {
    let service = start();
    let (gone, stays) = (service.submit(&job()), service.submit(&job()));
    let worker = Fake::register(&service);
    let lease = worker.lease(1000).expect("a frame");
    assert_eq!(lease.job_id, gone);
    worker.finish(&lease).unwrap();
    let mut others = Vec::new();
    let held = loop {
        let lease = worker.lease(1000).expect("another");
        if lease.job_id == gone {
            break lease;
        }
        others.push(lease);
    };
    let answer = service.delete(&format!("/v1/jobs/{gone}"));
    assert_eq!(
        (answer.status, &answer.json()["images"]),
        (200, &json!(1)),
        "{}",
        answer.text()
    );
    assert_eq!(worker.beat(&[held.token]).cancelled, [held.token]);
    assert!(worker.finish(&held).is_err());
    service.get(&format!("/v1/jobs/{gone}")).problem(404, "not-found");
    service
        .get(&format!("/v1/images/{gone}/0"))
        .problem(404, "not-found");
    service
        .delete(&format!("/v1/jobs/{gone}"))
        .problem(404, "not-found");
    others.iter().for_each(|other| worker.release(other));
    worker.work();
    assert_eq!(state(&service, &stays), "done");
    assert_eq!(service.shown()[2], 2, "only the other job's images are left");
}

#[test]
fn a_dataset_is_deleted_with_its_jobs_unless_one_is_running() {
    let service = start();
    let id = service.submit(&job());
    let refused = service.delete("/v1/datasets/tests").problem(409, "job-state");
    assert!(refused["detail"].as_str().unwrap().contains(&id), "{refused}");
    Fake::register(&service).work();
    let seen = service.get("/v1/datasets/tests").json();
    assert_eq!((&seen["images"], &seen["jobs"]), (&json!(2), &json!(1)), "{seen}");
    assert!(seen["bytes"].as_u64().unwrap() > 0);
    let deleted = service.delete("/v1/datasets/tests");
    assert_eq!(
        (deleted.status, &deleted.json()["images"]),
        (200, &json!(2)),
        "{}",
        deleted.text()
    );
    for left in ["/v1/datasets/tests", &format!("/v1/jobs/{id}")] {
        service.get(left).problem(404, "not-found");
    }
    assert_eq!(service.get("/v1/datasets").json()["items"], json!([]));
    // The same description is accepted again under the same name.
    service.submit(&job());
}

#[test]
fn a_key_is_free_again_when_its_job_is_deleted() {
    let service = start();
    let key = [("content-type", "application/json"), ("idempotency-key", "once")];
    let post = || {
        service
            .post_with("/v1/jobs", &key, job().to_string().as_bytes())
            .json()
    };
    let first = post()["id"].as_str().unwrap().to_owned();
    assert_eq!(service.delete(&format!("/v1/jobs/{first}")).status, 200);
    assert_ne!(post()["id"], json!(first));
}
