//! SIGTERM to the service and to workers with work in flight. The comment above each test defines failure.

#![allow(clippy::unwrap_used)]

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use fathom_tests::{Service, Worker, digest_by_render};
use serde_json::{Value, json};

/// Time limit for a process to end.
const LIMIT: Duration = Duration::from_secs(25);

fn job(frames: u64) -> Value {
    json!({
        "dataset": "drain", "count": frames, "seed": 11,
        "scene": {"kind": "procedural", "family": "structure", "seed": {"int": [0, 99]}},
        "camera": {"width": 160, "height": 100, "hfov_deg": 80},
        "water": {"optics": "jerlov-3C"}
    })
}

/// Waits until this many frames are done.
fn under_way(service: &Service, id: &str, frames: u64) -> Value {
    let begun = Instant::now();
    loop {
        let (_, state) = service.get(&format!("/v1/jobs/{id}"));
        if state["done"].as_u64().unwrap_or(0) >= frames {
            return state;
        }
        assert!(begun.elapsed() < Duration::from_secs(120), "{state}");
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// Checks that no frame failed or was given up.
fn no_errors(service: &Service, id: &str) {
    assert_eq!(
        service.get_bytes(&format!("/v1/jobs/{id}/errors")),
        (200, Vec::new())
    );
}

/// Failure: an exit status other than 0, an end after the limit, a waiting request without a response, an accepted job
/// missing after the next start, a frame that counts the stop as a strike, or another digest than without the stop.
#[test]
fn a_service_told_to_stop_responds_to_waiting_clients_and_loses_nothing() {
    let data = tempfile::tempdir().unwrap();
    let workers = ["--workers", "2", "--slots", "2"];
    let mut service = Service::start(data.path(), &workers);
    let id = service.submit(&job(300));
    let state = under_way(&service, &id, 20);
    assert_eq!(state["state"], "running", "the stop comes in the middle");
    // Long-polls for a change that never arrives.
    let version = state["version"].as_u64().unwrap() + 1000;
    let path = format!("/v1/jobs/{id}?wait=60&since={version}");
    let accepted = Arc::new(Mutex::new(Vec::new()));
    let go_on = AtomicBool::new(true);
    let (ended, waited) = std::thread::scope(|scope| {
        // Submits until the service stops responding.
        scope.spawn(|| {
            for number in 0.. {
                match service.try_submit(&job(1), &format!("key-{number}")) {
                    Some(id) => accepted.lock().unwrap().push(id),
                    None if !go_on.load(Ordering::SeqCst) => break,
                    None => std::thread::sleep(Duration::from_millis(10)),
                }
            }
        });
        let waiting = scope.spawn(|| service.get(&path));
        std::thread::sleep(Duration::from_millis(500));
        let since = Instant::now();
        service.ask_to_stop();
        let waited = waiting.join().unwrap();
        let answered = since.elapsed();
        std::thread::sleep(Duration::from_millis(500));
        go_on.store(false, Ordering::SeqCst);
        ((since, answered), waited)
    });
    let (since, answered) = ended;
    let ended = service.ended(since);
    println!(
        "answered after {answered:?}, ended after {:?}, accepted {}",
        ended.after,
        accepted.lock().unwrap().len()
    );
    assert!(ended.status.success() && ended.after < LIMIT, "{ended:?}");
    assert_eq!((waited.0, &waited.1["id"]), (200, &json!(id)), "{}", waited.1);
    assert!(answered < Duration::from_secs(5), "{answered:?}");

    let service = Service::start(data.path(), &workers);
    let accepted = accepted.lock().unwrap();
    assert!(!accepted.is_empty());
    for id in accepted.iter() {
        assert_eq!(service.finished(id)["state"], "done");
    }
    let done = service.finished(&id);
    no_errors(&service, &id);
    assert_eq!(done["digest"], digest_by_render(&job(300), data.path(), "2"));
}

/// Failure: the service waits for the frame beyond the limit, or for a second signal; or the frame receives a strike.
#[test]
fn a_frame_that_never_ends_does_not_keep_the_service() {
    let data = tempfile::tempdir().unwrap();
    let workers = ["--workers", "1", "--slots", "2"];
    let mut service = Service::start_with(data.path(), &workers, &[("FATHOM_FAULTS", "frame=hang#7")]);
    let id = service.submit(&job(40));
    // The frames after the hanging one belong to the same lease and wait with it.
    under_way(&service, &id, 12);
    std::thread::sleep(Duration::from_secs(2));
    let since = Instant::now();
    service.ask_to_stop();
    std::thread::sleep(Duration::from_secs(1));
    service.ask_to_stop();
    let ended = service.ended(since);
    println!("ended after {:?}", ended.after);
    assert!(ended.status.success() && ended.after < LIMIT, "{ended:?}");

    let service = Service::start(data.path(), &workers);
    assert_eq!(service.finished(&id)["state"], "done");
    no_errors(&service, &id);
}

/// Failure: the worker ends late or with another status than 0; its frames wait for the end of its lease; one of them
/// receives a strike.
#[test]
fn a_worker_that_is_told_to_stop_hands_back_what_it_has_not_finished() {
    let data = tempfile::tempdir().unwrap();
    let service = Service::start(data.path(), &["--workers", "0"]);
    let first = Worker::start(&service.url, "first", 2);
    let id = service.submit(&job(200));
    under_way(&service, &id, 20);
    let ended = first.stopped();
    println!("the worker ended after {:?}", ended.after);
    assert!(ended.status.success() && ended.after < LIMIT, "{ended:?}");
    let second = Worker::start(&service.url, "second", 2);
    let since = Instant::now();
    assert_eq!(service.finished(&id)["state"], "done");
    println!("the rest took {:?}", since.elapsed());
    no_errors(&service, &id);
    drop(second);

    let stuck = Worker::start_with(&service.url, "stuck", 1, &[("FATHOM_FAULTS", "frame=hang#0")]);
    let id = service.submit(&job(1));
    std::thread::sleep(Duration::from_secs(2));
    let ended = stuck.stopped();
    println!("the stuck worker ended after {:?}", ended.after);
    assert!(ended.after < LIMIT, "{ended:?}");
    let _third = Worker::start(&service.url, "third", 1);
    assert_eq!(service.finished(&id)["state"], "done");
}
