//! Many simultaneous clients, and the service's memory before and after.

#![allow(clippy::unwrap_used)]

use std::io::{Read, Write};
use std::net::TcpStream;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use fathom_tests::{Service, small_job};
use serde_json::json;

/// Serializes the floods.
static TURN: Mutex<()> = Mutex::new(());

/// Submissions of one round, and their concurrent clients.
const SUBMISSIONS: u64 = 5_000;
const CLIENTS: u64 = 64;
/// Connections of each kind of slow client.
const BAD_READERS: usize = 200;
/// An accepted job stays in the table of queued jobs: some kilobytes each. The rest is slack for the allocator, which
/// retains memory of busy threads.
const MOST_GROWTH: u64 = 64 << 20;
/// Clients of each kind: long polls, event streams, and pages of all columns.
const LONG_POLLS: usize = 1200;
const STREAMS: usize = 200;
const HEAVY_PAGES: usize = 260;
/// A page ends before 8 MiB, plus its last row and its header.
const MOST_PAGE_BYTES: usize = 9 << 20;
/// Time limit of a plain read on a machine with a thousand other clients.
const PLAIN_READ: Duration = Duration::from_secs(10);

fn job(label: u64) -> String {
    json!({
        "dataset": "flood", "count": 1000, "seed": label,
        "scene": {"kind": "procedural", "family": "structure", "seed": {"int": [0, 99]}},
        "camera": {"width": 160, "height": 100, "hfov_deg": 80}
    })
    .to_string()
}

fn connect(service: &Service) -> TcpStream {
    let address = service.url.strip_prefix("http://").unwrap();
    let stream = TcpStream::connect(address).unwrap();
    stream.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
    stream
}

/// Sends one request on a new connection; returns the status.
fn submit(service: &Service, body: &str) -> u16 {
    let mut stream = connect(service);
    let head = format!(
        "POST /v1/jobs HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\ncontent-type: application/json\r\ncontent-length: {}\r\n\r\n",
        body.len()
    );
    // A shed request gets its response before its body is read, which may break the connection afterwards.
    let _ = stream.write_all(head.as_bytes());
    let _ = stream.write_all(body.as_bytes());
    let mut answer = Vec::new();
    let _ = stream.read_to_end(&mut answer);
    let status = answer
        .get(9..12)
        .and_then(|status| std::str::from_utf8(status).ok());
    status.and_then(|status| status.parse().ok()).unwrap_or(0)
}

/// Five thousand submissions by sixty-four clients, alongside clients that never read and headers that never end.
/// Returns the numbers of accepted and shed ones.
fn round(service: &Service, number: u64, id: &str) -> (u64, u64) {
    let requests = [
        format!("GET /v1/jobs/{id}/events HTTP/1.1\r\nhost: localhost\r\n\r\n"),
        "GET /v1/images?limit=1000 HTTP/1.1\r\nhost: localhost\r\n\r\n".to_owned(),
        "GET /v1/jobs?limit=1000 HTTP/1.1\r\nhost: localhost\r\n\r\n".to_owned(),
    ];
    let mut never_read = Vec::new();
    for request in &requests {
        for _ in 0..BAD_READERS {
            let mut stream = connect(service);
            stream.write_all(request.as_bytes()).unwrap();
            never_read.push(stream);
        }
    }
    let over = AtomicBool::new(false);
    let (next, accepted, shed) = (AtomicU64::new(0), AtomicU64::new(0), AtomicU64::new(0));
    std::thread::scope(|scope| {
        // Headers one byte at a time.
        scope.spawn(|| {
            let mut slow: Vec<TcpStream> = (0..BAD_READERS).map(|_| connect(service)).collect();
            for byte in b"GET /livez HTTP/1.1\r\nx-slow: "
                .iter()
                .chain(std::iter::repeat(&b'x'))
            {
                if over.load(Ordering::SeqCst) {
                    break;
                }
                // The service may have closed it.
                slow.retain_mut(|stream| stream.write_all(&[*byte]).is_ok());
                std::thread::sleep(Duration::from_millis(20));
            }
        });
        let clients: Vec<_> = (0..CLIENTS)
            .map(|_| {
                scope.spawn(|| {
                    loop {
                        let position = next.fetch_add(1, Ordering::SeqCst);
                        if position >= SUBMISSIONS {
                            break;
                        }
                        match submit(service, &job(number * SUBMISSIONS + position)) {
                            202 => accepted.fetch_add(1, Ordering::SeqCst),
                            503 => shed.fetch_add(1, Ordering::SeqCst),
                            status => panic!("a submission gave {status}"),
                        };
                    }
                })
            })
            .collect();
        let ended: Vec<_> = clients.into_iter().map(|client| client.join()).collect();
        over.store(true, Ordering::SeqCst);
        assert!(
            ended.iter().all(Result::is_ok),
            "every submission has one of two outcomes"
        );
    });
    (accepted.into_inner(), shed.into_inner())
}

/// Failure: a submission returns anything but 202 or 503; an accepted job is missing; the service does not respond
/// meanwhile; memory keeps growing from round to round.
#[test]
fn ten_thousand_submissions_beside_bad_readers_succeed_in_bounded_memory() {
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let data = tempfile::tempdir().unwrap();
    let service = Service::start(data.path(), &["--workers", "0"]);
    let id = service.submit(&serde_json::from_str(&job(0)).unwrap());
    let before = service.resident_bytes();
    let (mut accepted, mut after) = (1, Vec::new());
    for number in 0..2 {
        let begun = Instant::now();
        let (new, shed) = round(&service, number, &id);
        assert_eq!(service.get("/livez").0, 200);
        accepted += new;
        let peak = service.resident_bytes();
        std::thread::sleep(Duration::from_secs(2));
        after.push(service.resident_bytes());
        println!(
            "round {number}: {new} accepted, {shed} shed in {:.1} s; resident {} MB before, {} MB at its end, {} MB 2 s later",
            begun.elapsed().as_secs_f64(),
            before >> 20,
            peak >> 20,
            after[number as usize] >> 20
        );
    }
    let (_, dataset) = service.get("/v1/datasets/flood");
    assert_eq!(dataset["jobs"], json!(accepted), "{dataset}");
    drop(service);
    let again = Service::start(data.path(), &["--workers", "0"]);
    println!(
        "a fresh start with all of these jobs: {} MB",
        again.resident_bytes() >> 20
    );
    let growth = after[1].saturating_sub(after[0]);
    assert!(growth < MOST_GROWTH, "the second round added {} MB", growth >> 20);
}

/// The status and the body length of a GET on a new connection.
fn fetch(service: &Service, path: &str) -> (u16, usize) {
    let mut stream = connect(service);
    let head = format!("GET {path} HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\n\r\n");
    stream.write_all(head.as_bytes()).unwrap();
    let mut answer = Vec::new();
    stream.read_to_end(&mut answer).unwrap();
    let status = std::str::from_utf8(&answer[9..12]).unwrap().parse().unwrap();
    (status, answer.len())
}

/// Connections with a request sent and no response read yet.
fn waiting(service: &Service, path: &str, count: usize) -> Vec<TcpStream> {
    let ask = |_| {
        let mut stream = connect(service);
        let head = format!("GET {path} HTTP/1.1\r\nhost: localhost\r\n\r\n");
        stream.write_all(head.as_bytes()).unwrap();
        stream
    };
    (0..count).map(ask).collect()
}

/// Number of requests that were shed.
fn shed(streams: &mut [TcpStream]) -> usize {
    let is_shed = |stream: &mut TcpStream| {
        stream.set_read_timeout(Some(Duration::from_millis(5))).unwrap();
        let mut head = [0; 12];
        stream.read_exact(&mut head).is_ok() && head == *b"HTTP/1.1 503"
    };
    streams.iter_mut().map(is_shed).filter(|is_shed| *is_shed).count()
}

/// Failure: a plain read is refused or late; a heavy page returns anything but 200 or 503, or is too long; a crowd
/// occupies more slots than one address may.
#[test]
fn long_polls_streams_and_heavy_pages_leave_room_for_plain_reads() {
    let _turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
    let data = tempfile::tempdir().unwrap();
    let service = Service::start(data.path(), &["--workers", "1", "--slots", "2"]);
    let mut heavy = small_job("crowd");
    heavy["count"] = json!(600);
    heavy["metrics"] = json!(["uiqm", "uciqe", "entropy"]);
    let done = service.submit(&heavy);
    assert_eq!(service.finished(&done)["state"], "done");
    heavy["seed"] = json!(12);
    heavy["count"] = json!(100_000);
    let open = service.submit(&heavy);
    assert_eq!(service.post(&format!("/v1/jobs/{open}/pause"), &json!({})).0, 200);

    let mut polls = waiting(
        &service,
        &format!("/v1/jobs/{open}?wait=60&since=999999"),
        LONG_POLLS,
    );
    let mut streams = waiting(&service, &format!("/v1/jobs/{open}/events"), STREAMS);
    let over = AtomicBool::new(false);
    let (pages, reads, slowest) = std::thread::scope(|scope| {
        let plain = scope.spawn(|| {
            let (mut reads, mut slowest) = (0, Duration::ZERO);
            while !over.load(Ordering::SeqCst) {
                for path in [
                    &format!("/v1/jobs/{open}"),
                    &format!("/v1/images/{done}/3"),
                    "/livez",
                ] {
                    let begun = Instant::now();
                    assert_eq!(fetch(&service, path).0, 200, "{path}");
                    (reads, slowest) = (reads + 1, slowest.max(begun.elapsed()));
                }
            }
            (reads, slowest)
        });
        let clients: Vec<_> = (0..HEAVY_PAGES)
            .map(|_| scope.spawn(|| fetch(&service, "/v1/images?limit=1000")))
            .collect();
        let pages: Vec<_> = clients.into_iter().map(|client| client.join().unwrap()).collect();
        over.store(true, Ordering::SeqCst);
        let (reads, slowest) = plain.join().unwrap();
        (pages, reads, slowest)
    });
    let whole = pages.iter().filter(|(status, _)| *status == 200).count();
    let (shed_polls, shed_streams) = (shed(&mut polls), shed(&mut streams));
    println!(
        "{whole} of {HEAVY_PAGES} heavy pages came, {} were shed; {shed_polls} of {LONG_POLLS} long-polls and {shed_streams} of \
         {STREAMS} streams were shed; {reads} plain reads, the slowest in {} ms",
        HEAVY_PAGES - whole,
        slowest.as_millis()
    );
    assert!(
        pages.iter().all(|(status, _)| [200, 503].contains(status)),
        "{pages:?}"
    );
    assert!(pages.iter().all(|(_, bytes)| *bytes < MOST_PAGE_BYTES));
    assert!(whole > 0 && slowest < PLAIN_READ, "{slowest:?}");
    assert!(shed_polls > 0 && shed_streams > 0);
}
