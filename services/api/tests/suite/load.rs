//! Floods, slow clients and cross-site requests.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

use crate::common::worker::Fake;
use crate::common::{Running, Setup, job, start, start_with};
use api::Limits;
use serde_json::json;

/// Opens a connection that has sent the head of a request but not its body.
fn half_sent(service: &Running, path: &str, content_type: &str) -> TcpStream {
    let mut stream = connect(service);
    let head = format!(
        "POST {path} HTTP/1.1\r\nhost: localhost\r\ncontent-type: {content_type}\r\ncontent-length: 1000\r\n\r\n{{"
    );
    stream.write_all(head.as_bytes()).unwrap();
    stream
}

/// Opens a connection that sends a request and reads nothing.
fn asked(service: &Running, path: &str) -> TcpStream {
    let mut stream = connect(service);
    let head = format!("GET {path} HTTP/1.1\r\nhost: localhost\r\n\r\n");
    stream.write_all(head.as_bytes()).unwrap();
    stream
}

fn limited(limits: Limits) -> Running {
    start_with(Setup {
        limits,
        ..Setup::default()
    })
}

/// Requests that must always succeed: reads of every kind, a submission, an upload, a frame of a worker.
fn others_are_served(service: &Running, worker: &Fake) {
    let begun = Instant::now();
    let id = service.submit(&job());
    for path in ["/v1/jobs", &format!("/v1/jobs/{id}"), "/v1/images", "/livez"] {
        assert_eq!(service.get(path).status, 200, "{path}");
    }
    let refused = service.upload(&[("rgb", b"no picture")]);
    refused.problem(422, "validation");
    worker.work();
    for path in ["results", "errors"] {
        assert_eq!(
            service.get(&format!("/v1/jobs/{id}/{path}")).status,
            200,
            "{path}"
        );
    }
    let elapsed = begun.elapsed();
    assert!(elapsed < Duration::from_secs(10), "{elapsed:?}");
}

#[test]
fn slow_bodies_hold_no_permit_and_are_cut() {
    let service = limited(Limits {
        body_grace: Duration::from_secs(4),
        ..Limits::default()
    });
    let worker = Fake::register(&service);
    let json = (0..260).map(|_| half_sent(&service, "/v1/jobs", "application/json"));
    let mut held: Vec<TcpStream> = json.collect();
    let form = "multipart/form-data; boundary=x";
    held.extend((0..8).map(|_| half_sent(&service, "/v1/scenes", form)));
    let message = "application/x-protobuf";
    held.extend((0..260).map(|_| half_sent(&service, "/v1/worker/artifacts", message)));
    others_are_served(&service, &worker);
    for mut stream in held {
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        assert!(
            answer.starts_with("HTTP/1.1 408") && answer.contains("bytes per second"),
            "{answer}"
        );
    }
}

#[test]
fn long_polls_and_event_streams_beyond_their_budget_are_shed_immediately() {
    let service = limited(Limits {
        waits: 100,
        streams: 20,
        ..Limits::default()
    });
    let worker = Fake::register(&service);
    let held_job = service.submit(&job());
    let lease = worker.lease(1000).unwrap();
    let polls = format!("/v1/jobs/{held_job}?wait=60&since=999999");
    let events = format!("/v1/jobs/{held_job}/events");
    let mut held: Vec<TcpStream> = (0..200).map(|_| asked(&service, &polls)).collect();
    held.extend((0..200).map(|_| asked(&service, &events)));
    // This address has half of the permits.
    let mut shed = 0;
    for stream in &mut held {
        stream.set_read_timeout(Some(Duration::from_millis(20))).unwrap();
        let mut head = [0; 12];
        shed += usize::from(stream.read_exact(&mut head).is_ok() && head == *b"HTTP/1.1 503");
    }
    assert_eq!(shed, 150 + 190);
    let begun = Instant::now();
    let refused = service.get(&polls);
    refused.problem(503, "overloaded");
    assert_eq!(refused.header("retry-after"), "1");
    assert!(begun.elapsed() < Duration::from_secs(1));
    worker.release(&lease);
    others_are_served(&service, &worker);
}

#[test]
fn datasets_come_in_pages() {
    let service = start();
    for name in ["a", "b", "c"] {
        let mut job = job();
        job["dataset"] = json!(name);
        service.submit(&job);
    }
    let first = service.get("/v1/datasets?limit=2").json();
    let names = |page: &serde_json::Value| -> Vec<String> {
        let items = page["items"].as_array().unwrap().iter();
        items
            .map(|row| row["name"].as_str().unwrap().to_owned())
            .collect()
    };
    assert_eq!(names(&first), ["a", "b"]);
    let cursor = first["next_cursor"].as_str().unwrap();
    let last = service
        .get(&format!("/v1/datasets?limit=2&cursor={cursor}"))
        .json();
    assert_eq!(
        (names(&last), &last["next_cursor"]),
        (vec!["c".to_owned()], &json!(null))
    );
    service.get("/v1/datasets?limit=0").problem(400, "invalid-query");
    service
        .get("/v1/datasets?cursor=x")
        .problem(400, "invalid-cursor");
}

#[test]
fn names_of_the_services_own_workers_are_theirs() {
    let service = start();
    let taken = Fake::try_named(&service, "local-1", None);
    assert!(taken.is_err_and(|error| error.to_string().contains("reserved for the service")));
    assert!(Fake::try_named(&service, "local-x", None).is_ok());
}

#[test]
fn waiting_requests_take_no_places_of_others() {
    let limits = Limits {
        requests: 1,
        waits: 64,
        ..Limits::default()
    };
    let service = start_with(Setup {
        limits,
        ..Setup::default()
    });
    let id = service.submit(&job());
    std::thread::scope(|scope| {
        for _ in 0..32 {
            scope.spawn(|| service.get(&format!("/v1/jobs/{id}?wait=30&since=999999")));
        }
        std::thread::sleep(Duration::from_millis(200));
        for _ in 0..20 {
            assert_eq!(service.get("/v1/waters").status, 200);
        }
        assert_eq!(
            service.post(&format!("/v1/jobs/{id}/cancel"), &json!({})).status,
            200
        );
    });
}

#[test]
fn a_burst_of_submissions_ends_in_accepted_or_shed() {
    let service = start();
    let accepted: usize = std::thread::scope(|scope| {
        let clients: Vec<_> = (0..16)
            .map(|_| {
                scope.spawn(|| {
                    (0..40)
                        .filter(|_| {
                            let answer = service.post("/v1/jobs", &job());
                            assert!(answer.status == 202 || answer.status == 503, "{}", answer.text());
                            answer.status == 202
                        })
                        .count()
                })
            })
            .collect();
        clients.into_iter().map(|client| client.join().unwrap()).sum()
    });
    assert_eq!(service.shown()[0], accepted);
    assert!(accepted > 0);
}

#[test]
fn pages_of_other_sites_cannot_submit() {
    let service = start();
    let headers = [
        ("content-type", "application/json"),
        ("origin", "http://evil.example"),
    ];
    service
        .post_with("/v1/jobs", &headers, job().to_string().as_bytes())
        .problem(403, "cross-origin");
    assert_eq!(service.shown()[0], 0);
}

#[test]
fn an_open_service_responds_to_its_own_names_alone() {
    let service = start();
    let ask = |host: &str| {
        let mut stream = connect(&service);
        let head = format!("GET /v1/jobs HTTP/1.1\r\nhost: {host}\r\nconnection: close\r\n\r\n");
        stream.write_all(head.as_bytes()).unwrap();
        let mut answer = String::new();
        stream.read_to_string(&mut answer).unwrap();
        answer
    };
    for host in ["localhost", "127.0.0.1:80", "[::1]:7311"] {
        assert!(ask(host).starts_with("HTTP/1.1 200"), "{host}");
    }
    for host in ["evil.example", "localhost.evil.example:7311", "192.168.0.7"] {
        let answer = ask(host);
        assert!(
            answer.starts_with("HTTP/1.1 421") && answer.contains("/problems/unknown-host"),
            "{host}: {answer}"
        );
    }
    let guarded = start_with(Setup {
        token: Some("secret"),
        ..Setup::default()
    });
    let mut stream = connect(&guarded);
    let head = "GET /v1/jobs HTTP/1.1\r\nhost: fathom.example\r\nauthorization: Bearer secret\r\nconnection: close\r\n\r\n";
    stream.write_all(head.as_bytes()).unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    assert!(answer.starts_with("HTTP/1.1 200"), "{answer}");
}

#[test]
fn two_idempotency_keys_are_refused() {
    let service = start();
    let headers = [
        ("content-type", "application/json"),
        ("idempotency-key", "a"),
        ("idempotency-key", "b"),
    ];
    service
        .post_with("/v1/jobs", &headers, job().to_string().as_bytes())
        .problem(400, "invalid-header");
    assert_eq!(service.shown()[0], 0);
}

#[test]
fn an_oversized_or_malformed_head_ends_only_its_connection() {
    let service = start();
    let large = [b"GET / HTTP/1.1\r\nx: ".to_vec(), vec![b'y'; 200_000]].concat();
    for bytes in [b"hello\r\n\r\n".to_vec(), large] {
        let mut stream = connect(&service);
        let _ = stream.write_all(&bytes);
        let mut answer = Vec::new();
        let _ = stream.read_to_end(&mut answer);
        assert!(
            answer.is_empty() || answer.starts_with(b"HTTP/1.1 4"),
            "{}",
            String::from_utf8_lossy(&answer)
        );
    }
    assert_eq!(service.get("/livez").status, 200);
}

#[test]
fn a_head_that_does_not_come_is_not_waited_for() {
    let limits = Limits {
        head_read: Duration::from_millis(200),
        ..Limits::default()
    };
    let service = start_with(Setup {
        limits,
        ..Setup::default()
    });
    for beginning in ["", "GET /livez HTTP/1.1\r\nx-slow: "] {
        let mut stream = connect(&service);
        stream.write_all(beginning.as_bytes()).unwrap();
        let begun = Instant::now();
        let mut answer = Vec::new();
        let _ = stream.read_to_end(&mut answer);
        assert!(begun.elapsed() < Duration::from_secs(10));
        assert!(answer.is_empty() || answer.starts_with(b"HTTP/1.1 408"));
    }
}

fn connect(service: &Running) -> TcpStream {
    TcpStream::connect(service.url.trim_start_matches("http://")).unwrap()
}
