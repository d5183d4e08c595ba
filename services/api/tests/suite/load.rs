//! Floods, slow clients and other sites' pages.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

use crate::common::worker::Fake;
use crate::common::{Running, Setup, job, start, start_with};
use api::Limits;
use serde_json::json;

/// Opens a connection that has sent the head of a submission and keeps its body back.
fn half_sent(service: &Running) -> TcpStream {
    let mut stream = connect(service);
    let head = "POST /v1/jobs HTTP/1.1\r\nhost: localhost\r\ncontent-type: application/json\r\ncontent-length: 9\r\n\r\n";
    stream.write_all(head.as_bytes()).unwrap();
    stream
}

#[test]
fn requests_beyond_the_budget_are_shed_and_workers_are_not_among_them() {
    let limits = Limits {
        requests: 2,
        ..Limits::default()
    };
    let service = start_with(Setup {
        limits,
        ..Setup::default()
    });
    service.submit(&job());
    let held = [half_sent(&service), half_sent(&service)];
    // The two hold their places as soon as the service has read their heads.
    let shed = loop {
        let answer = service.get("/v1/jobs");
        if answer.status == 503 {
            break answer;
        }
        std::thread::sleep(Duration::from_millis(10));
    };
    shed.problem(503, "overloaded");
    assert_eq!(shed.header("retry-after"), "1");
    assert_eq!(service.get("/livez").status, 200);
    let worker = Fake::register(&service);
    assert!(worker.lease(1000).is_some(), "workers have a budget of their own");
    drop(held);
    while service.get("/v1/jobs").status != 200 {
        std::thread::sleep(Duration::from_millis(10));
    }
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
fn a_head_that_is_too_large_or_no_http_ends_the_connection_and_nothing_else() {
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
