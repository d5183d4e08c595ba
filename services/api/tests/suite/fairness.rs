//! Shares of callers, and direct renders whose client has left.

use std::io::Write;
use std::net::TcpStream;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use renderer::worker::client::ClientError;
use serde_json::{Value, json};
use wire::messages::{Lease, LeaseRequest};

use crate::common::worker::Fake;
use crate::common::{Answer, Running, Setup, job, start, start_with};

/// Time of a frame of the workers below.
const FRAME: Duration = Duration::from_millis(100);

fn two_callers() -> Running {
    let mut service = start_with(Setup {
        token: Some("boss,read+submit:alice,read+submit:bob"),
        ..Setup::default()
    });
    service.token = Some("boss");
    service
}

pub(super) fn post_as(
    service: &Running,
    caller: &str,
    path: &str,
    body: &Value,
    more: &[(&str, &str)],
) -> Answer {
    let bearer = format!("Bearer {caller}");
    let mut headers = vec![
        ("content-type", "application/json"),
        ("authorization", bearer.as_str()),
    ];
    headers.extend(more);
    service.post_with(path, &headers, body.to_string().as_bytes())
}

fn submit_as(service: &Running, caller: &str, dataset: &str, frames: u64) -> String {
    let mut body = job();
    (body["dataset"], body["count"]) = (json!(dataset), json!(frames));
    let answer = post_as(service, caller, "/v1/jobs?again=true", &body, &[]);
    assert_eq!(answer.status, 202, "{}", answer.text());
    answer.json()["id"].as_str().unwrap().to_owned()
}

/// A description of one frame for a direct render.
fn direct() -> Value {
    let mut body = job();
    body["count"] = json!(1);
    body.as_object_mut().unwrap().remove("dataset");
    body
}

/// A slot whose frames take [`FRAME`]; notes the job of each frame that it rendered.
fn render(service: &Running, name: &str, stop: &AtomicBool, rendered: &Mutex<Vec<String>>) {
    let fake = Fake::try_named(service, name, None).unwrap();
    let request = LeaseRequest {
        worker_id: fake.id.clone(),
        wait_ms: 500,
        frame_ms: FRAME.as_secs_f64() * 1000.0,
    };
    while !stop.load(Ordering::SeqCst) {
        let Some(lease) = fake.client.lease(&request).unwrap() else {
            continue;
        };
        for frame in &lease.frames {
            if stop.load(Ordering::SeqCst) {
                return;
            }
            std::thread::sleep(FRAME);
            let single = Lease {
                frames: vec![*frame],
                ..lease.clone()
            };
            match fake.finish(&single) {
                Ok(_) | Err(ClientError::Stale) => {}
                Err(error) => panic!("{error}"),
            }
            rendered.lock().unwrap().push(lease.job_id.clone());
        }
    }
}

/// Waits until a job has its images.
fn await_images(service: &Running, job: &str) {
    let begun = Instant::now();
    loop {
        let path = format!("/v1/jobs/{job}?wait=1&since=999999");
        let row = service
            .get_with(&path, &[("authorization", "Bearer boss")])
            .json();
        if row["state"] == "done" {
            return;
        }
        assert!(begun.elapsed() < Duration::from_secs(120), "{row}");
    }
}

/// Counted in frames: the time alone is that of 40 frames, so twice that leaves room for 40 frames of another caller. A time would depend on
/// what else the machine does.
#[test]
fn with_400_jobs_of_one_token_40_frames_of_another_take_at_most_twice_their_time_alone() {
    let service = two_callers();
    let stop = AtomicBool::new(false);
    let rendered = Mutex::new(Vec::new());
    std::thread::scope(|scope| {
        for name in ["one", "two"] {
            let (service, stop, rendered) = (&service, &stop, &rendered);
            scope.spawn(move || render(service, name, stop, rendered));
        }
        for _ in 0..400 {
            submit_as(&service, "alice", "flood", 50);
        }
        let begun = Instant::now();
        let before = rendered.lock().unwrap().len();
        let shared = submit_as(&service, "bob", "shared", 40);
        await_images(&service, &shared);
        stop.store(true, Ordering::SeqCst);
        let since = &rendered.lock().unwrap()[before..];
        let other = since.iter().filter(|job| **job != shared).count();
        println!(
            "40 frames in {:?}, meanwhile {other} of 400 jobs of another token",
            begun.elapsed()
        );
        assert!(
            other <= 40,
            "{other} frames of the other caller came before the last of 40"
        );
    });
}

#[test]
fn the_priority_of_a_direct_render_ends_with_its_request() {
    let service = start();
    let ordinary = service.submit(&job());
    for number in 0..3 {
        let key = format!("render-{number}");
        let headers = [
            ("content-type", "application/json"),
            ("prefer", "wait=0"),
            ("idempotency-key", key.as_str()),
        ];
        let answer = service.post_with("/v1/renders", &headers, direct().to_string().as_bytes());
        assert_eq!(answer.status, 202, "{}", answer.text());
    }
    let fake = Fake::register(&service);
    let lease = fake.lease(1000).unwrap();
    assert_eq!(lease.job_id, ordinary, "the renders are ordinary jobs now");
}

#[test]
fn a_waiting_direct_render_goes_before_the_other_jobs_of_its_caller() {
    let service = start();
    service.submit(&job());
    let headers = [("content-type", "application/json"), ("prefer", "wait=30")];
    std::thread::scope(|scope| {
        let rendered =
            scope.spawn(|| service.post_with("/v1/renders", &headers, direct().to_string().as_bytes()));
        let fake = Fake::register(&service);
        await_jobs(&service, 2);
        fake.finish(&fake.lease(1000).unwrap()).unwrap();
        let answer = rendered.join().unwrap();
        assert_eq!(answer.status, 200, "{}", answer.text());
    });
}

fn jobs(service: &Running) -> Vec<Value> {
    service.get("/v1/jobs").json()["items"]
        .as_array()
        .unwrap()
        .clone()
}

fn await_jobs(service: &Running, count: usize) {
    let begun = Instant::now();
    while jobs(service).len() != count {
        assert!(begun.elapsed() < Duration::from_secs(10), "{:?}", jobs(service));
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// Sends a direct render without reading the response.
fn send_render(service: &Running, body: &Value, more: &str) -> TcpStream {
    let mut stream = TcpStream::connect(service.url.trim_start_matches("http://")).unwrap();
    let body = body.to_string();
    let head = format!(
        "POST /v1/renders HTTP/1.1\r\nhost: localhost\r\ncontent-type: application/json\r\nprefer: wait=60\r\n{more}\
         content-length: {}\r\n\r\n",
        body.len()
    );
    stream.write_all(head.as_bytes()).unwrap();
    stream.write_all(body.as_bytes()).unwrap();
    stream
}

#[test]
fn a_direct_render_is_cancelled_when_its_client_leaves() {
    let service = start();
    let clients: Vec<TcpStream> = (0..20).map(|_| send_render(&service, &direct(), "")).collect();
    await_jobs(&service, 20);
    drop(clients);
    await_jobs(&service, 0);
    // Its dataset keeps the cancelled job.
    let named = send_render(
        &service,
        &json!({"dataset": "kept", "scene": direct()["scene"]}),
        "",
    );
    await_jobs(&service, 1);
    drop(named);
    let begun = Instant::now();
    while jobs(&service)[0]["state"] != "cancelled" {
        assert!(begun.elapsed() < Duration::from_secs(10), "{:?}", jobs(&service));
        std::thread::sleep(Duration::from_millis(20));
    }
    // The client can repeat a request with a key.
    let keyed = send_render(&service, &direct(), "idempotency-key: k\r\n");
    await_jobs(&service, 2);
    drop(keyed);
    std::thread::sleep(Duration::from_millis(500));
    let fake = Fake::register(&service);
    fake.finish(&fake.lease(1000).unwrap()).unwrap();
    let headers = [("content-type", "application/json"), ("idempotency-key", "k")];
    let answer = service.post_with("/v1/renders", &headers, direct().to_string().as_bytes());
    assert_eq!(answer.status, 200, "{}", answer.text());
}
