//! Large uploads are on disk while they arrive, and few of them are in the memory of the service.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::Duration;

use client::{Http, HttpError};
use fathom_tests::Service;

/// Sides of the pictures: 16 Mpx of three floats are 192 MiB.
const SIDE: usize = 4096;
/// Most growth of the service's process: one form of the largest upload, with the copy that is stored. Without turns and the disk,
/// four of them take 2.4 GB.
const MOST_GROWTH: u64 = 900 << 20;
const TOKENS: [&str; 2] = ["first-secret-of-a-test", "second-secret-of-a-test"];

/// A picture of linear floats, all of this level.
fn npy(level: f32) -> Vec<u8> {
    let head = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({SIDE}, {SIDE}, 3), }}");
    let head = format!("{head:<117}\n");
    let mut file = b"\x93NUMPY\x01\x00".to_vec();
    file.extend((head.len() as u16).to_le_bytes());
    file.extend(head.as_bytes());
    file.extend(level.to_le_bytes().repeat(SIDE * SIDE * 3));
    file
}

fn form(picture: &[u8]) -> Vec<u8> {
    [
        b"--b\r\nContent-Disposition: form-data; name=\"rgb\"\r\n\r\n",
        picture,
        b"\r\n--b--\r\n",
    ]
    .concat()
}

fn upload(service: &Service, token: &str, level: f32) -> u16 {
    let http = Http::new(&service.url, Some(token), Duration::from_secs(280));
    let headers = [("content-type", "multipart/form-data; boundary=b")];
    match http.post("/v1/scenes", &headers, form(&npy(level))) {
        Ok(reply) => reply.status.as_u16(),
        Err(HttpError::Problem(problem)) => panic!("{}", problem.message()),
        Err(HttpError::Unreachable(error)) => panic!("{error}"),
    }
}

/// Failure: four uploads of 192 MiB at the same time take more memory than the bound, one of them is lost, or another request fails.
#[test]
fn large_uploads_at_the_same_time_take_the_memory_of_one() {
    let data = tempfile::tempdir().expect("a temporary folder");
    let tokens = TOKENS.map(|token| format!("read+submit:{token}")).join(",");
    let service = Service::start(data.path(), &["--workers", "0", "--token", &tokens]);
    let reader = Http::new(&service.url, Some(TOKENS[0]), Duration::from_secs(60));
    assert!(reader.get("/v1/scenes").is_ok());
    let before = service.resident_bytes();
    let (over, most) = (AtomicBool::new(false), AtomicU64::new(0));
    std::thread::scope(|scope| {
        scope.spawn(|| {
            while !over.load(Ordering::SeqCst) {
                most.fetch_max(service.resident_bytes(), Ordering::SeqCst);
                std::thread::sleep(Duration::from_millis(10));
            }
        });
        let uploads: Vec<_> = (0..4)
            .map(|number| {
                let (service, token) = (&service, TOKENS[number % 2]);
                scope.spawn(move || upload(service, token, 0.1 + number as f32 / 10.0))
            })
            .collect();
        assert!(reader.get("/v1/scenes").is_ok(), "other requests are served");
        let statuses: Vec<u16> = uploads
            .into_iter()
            .map(|upload| upload.join().expect("a response"))
            .collect();
        over.store(true, Ordering::SeqCst);
        assert_eq!(statuses, [201; 4]);
    });
    let most = most.into_inner();
    println!(
        "four uploads of {} MiB: {} MiB before, {} at most",
        npy(0.0).len() >> 20,
        before >> 20,
        most >> 20
    );
    assert!(most - before < MOST_GROWTH, "{} MiB", (most - before) >> 20);
    let left = std::fs::read_dir(data.path().join("tmp"))
        .expect("a folder")
        .count();
    assert_eq!(left, 0, "temporary files");
}
