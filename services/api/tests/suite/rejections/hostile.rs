//! Hostile requests: floods, slow senders, deep and huge JSON, decompression bombs, path tricks.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use crate::common::worker::Fake;
use crate::common::{Running, Setup, job, start, start_with};
use crate::rejections::bad_input::nothing_changes;
use api::Limits;

const JSON: [(&str, &str); 1] = [("content-type", "application/json")];
const CLIENTS: usize = 250;
const SUBMISSIONS: usize = 10_000;

#[test]
fn ten_thousand_submissions_are_accepted_or_shed_and_no_lease_ends() {
    let service = start();
    let first = service.submit(&job());
    let worker = Fake::register(&service);
    let lease = worker.lease(1000).expect("a frame");
    assert_eq!(lease.job_id, first);
    let (accepted, shed) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let over = AtomicBool::new(false);
    let body = job().to_string();
    let slowest_beat = std::thread::scope(|scope| {
        let beating = scope.spawn(|| {
            let mut slowest = Duration::ZERO;
            while !over.load(Ordering::SeqCst) {
                let begun = Instant::now();
                let beat = worker.beat(&[lease.token]);
                assert!(beat.lost.is_empty() && beat.cancelled.is_empty());
                slowest = slowest.max(begun.elapsed());
                std::thread::sleep(Duration::from_millis(50));
            }
            slowest
        });
        let clients: Vec<_> = (0..CLIENTS)
            .map(|_| {
                scope.spawn(|| {
                    for _ in 0..SUBMISSIONS / CLIENTS {
                        let answer = service.post_with("/v1/jobs", &JSON, body.as_bytes());
                        match answer.status {
                            202 => accepted.fetch_add(1, Ordering::SeqCst),
                            _ => {
                                answer.problem(503, "overloaded");
                                assert_eq!(answer.header("retry-after"), "1");
                                shed.fetch_add(1, Ordering::SeqCst)
                            }
                        };
                    }
                })
            })
            .collect();
        for client in clients {
            client.join().unwrap();
        }
        over.store(true, Ordering::SeqCst);
        beating.join().unwrap()
    });
    let (accepted, shed) = (accepted.into_inner(), shed.into_inner());
    assert_eq!(accepted + shed, SUBMISSIONS);
    assert!(
        slowest_beat < Duration::from_secs(5),
        "{slowest_beat:?} for a beat of a lease of 15 s"
    );
    assert_eq!(
        jobs(&service),
        accepted + 1,
        "what was accepted is there, what was shed is not"
    );
    worker.finish(&lease).unwrap();
}

/// All jobs, page by page.
fn jobs(service: &Running) -> usize {
    let (mut found, mut cursor) = (0, String::new());
    loop {
        let page = service.get(&format!("/v1/jobs?limit=1000{cursor}")).json();
        found += page["items"].as_array().unwrap().len();
        match page["next_cursor"].as_str() {
            Some(next) => cursor = format!("&cursor={next}"),
            None => return found,
        }
    }
}

#[test]
fn slow_clients_are_cut_off_without_delaying_others() {
    let limits = Limits {
        head_read: Duration::from_millis(500),
        ..Limits::default()
    };
    let service = start_with(Setup {
        limits,
        ..Setup::default()
    });
    std::thread::scope(|scope| {
        let dribblers: Vec<_> = (0..64)
            .map(|_| {
                scope.spawn(|| {
                    let mut stream = TcpStream::connect(service.url.trim_start_matches("http://")).unwrap();
                    let begun = Instant::now();
                    let head =
                        b"GET /v1/jobs HTTP/1.1\r\nhost: localhost\r\nx-slow: aaaaaaaaaaaaaaaaaaaaaaaaaaaaaa";
                    for byte in head.iter().cycle() {
                        if stream.write_all(&[*byte]).is_err() || begun.elapsed() > Duration::from_secs(20) {
                            break;
                        }
                        std::thread::sleep(Duration::from_millis(30));
                    }
                    let _ = stream.read_to_end(&mut Vec::new());
                    begun.elapsed()
                })
            })
            .collect();
        for _ in 0..20 {
            assert_eq!(service.get("/v1/jobs").status, 200);
        }
        for dribbler in dribblers {
            assert!(
                dribbler.join().unwrap() < Duration::from_secs(20),
                "it was served for ever"
            );
        }
    });
}

#[test]
fn json_that_is_deep_huge_or_ambiguous_is_refused() {
    let around = |value: &str| {
        let body = job().to_string();
        format!("{},\"labels\":{value}}}", &body[..body.len() - 1])
    };
    let deep = |depth: usize| format!("{}1{}", "{\"a\":".repeat(depth), "}".repeat(depth));
    let choices = format!("{{\"choice\":[{}1]}}", "{\"choice\":[".repeat(5000));
    let cases = [
        ("deep objects", around(&deep(200))),
        ("deeper than any stack", around(&deep(100_000))),
        (
            "deep arrays",
            around(&format!("{}{}", "[".repeat(100_000), "]".repeat(100_000))),
        ),
        ("deep laws", around(&choices)),
        (
            "a huge string",
            around(&format!("{{\"a\":\"{}\"}}", "x".repeat(900_000))),
        ),
        (
            "many labels",
            around(&format!(
                "{{{}\"z\":1}}",
                (0..50_000).map(|n| format!("\"k{n}\":1,")).collect::<String>()
            )),
        ),
        ("a duplicate key", around("{\"a\":1,\"a\":2}")),
        ("a number beyond all", around("{\"a\":1e999}")),
        ("half a character", around("{\"a\":\"\\ud800\"}")),
        ("two documents", format!("{}{}", job(), job())),
        ("no end", job().to_string()[..40].to_owned()),
        ("nothing", String::new()),
        ("a list", "[]".to_owned()),
    ];
    nothing_changes(|service| {
        for (name, body) in cases {
            for path in ["/v1/jobs", "/v1/jobs/preview", "/v1/renders"] {
                let answer = service.post_with(path, &JSON, body.as_bytes());
                assert_eq!(answer.status, 422, "{name} to {path}: {}", answer.text());
                let problem = answer.problem(422, "validation");
                assert!(
                    answer.body.len() < 100_000,
                    "{name}: an answer as long as the question"
                );
                assert!(
                    !problem["errors"].as_array().unwrap().is_empty(),
                    "{name}: {problem}"
                );
            }
        }
    });
}

#[test]
fn compressed_bodies_are_not_unpacked() {
    nothing_changes(|service| {
        for encoding in ["gzip", "deflate", "br", "zstd", "gzip, gzip"] {
            let headers = [JSON[0], ("content-encoding", encoding)];
            let problem = service
                .post_with("/v1/jobs", &headers, &[0x1f, 0x8b, 8, 0])
                .problem(415, "unsupported-media-type");
            assert!(
                problem["detail"].as_str().unwrap().contains(encoding),
                "{problem}"
            );
        }
    });
}

#[test]
fn no_name_is_a_path() {
    let tricks = [
        "..%2f..%2f..%2fetc%2fpasswd",
        "%2e%2e%2f%2e%2e%2flock",
        "..%5c..%5clock",
        "%2fetc%2fpasswd",
        "lock%00.png",
        "a%0d%0aset-cookie:%20x",
        "%ff%fe",
        "'%20or%201=1%20--",
    ];
    nothing_changes(|service| {
        for trick in tricks {
            for path in [
                format!("/v1/jobs/{trick}"),
                format!("/v1/jobs/{trick}/results"),
                format!("/v1/datasets/{trick}"),
                format!("/v1/datasets/{trick}/metadata.csv"),
                format!("/v1/images/{trick}/0"),
                format!("/v1/images/job_x/0/artifacts/{trick}"),
                format!("/v1/worker/blobs/{trick}"),
                format!("/v1/worker/scenes/{trick}"),
                format!("/v1/worker/styles/{trick}"),
                format!("/docs/{trick}"),
                format!("/problems/{trick}"),
            ] {
                let answer = service.get(&path);
                assert!(
                    [400, 404].contains(&answer.status),
                    "{path}: {} {}",
                    answer.status,
                    answer.text()
                );
                assert!(!answer.text().contains("root:"), "{path}");
                assert!(answer.headers.get("set-cookie").is_none(), "{path}");
            }
        }
        for name in [
            "../../etc",
            "a/b",
            "..",
            "a\u{0}b",
            "",
            "a\nb",
            &"x".repeat(10_000),
        ] {
            let mut body = job();
            body["dataset"] = name.into();
            let problem = service.post("/v1/jobs", &body).problem(422, "validation");
            assert_eq!(problem["errors"][0]["pointer"], "/dataset", "{problem}");
        }
    });
}
