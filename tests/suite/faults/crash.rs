//! Processes killed at the worst moments. The comment above each test defines failure.
//!
//! `FATHOM_CRASH_KILLS` sets the number of kills in the first test (default 50); it prints a log.

use std::path::Path;
use std::time::{Duration, Instant};

use fathom_tests::{
    Dice, SERVICE_POINTS, SMALL_JOB_FRAMES, Service, Worker, digest_by_render, run, small_job,
};
use serde_json::json;

const WORKER_POINTS: [&str; 4] = [
    "worker.leased",
    "worker.rendered",
    "worker.stored",
    "worker.committed",
];

fn temporary() -> tempfile::TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Audits a stopped service's folder: every row's bytes must exist and match, counts must agree, the databases must be
/// intact.
fn audit(data: &Path, when: &str) {
    let output = run(&["scrub", "--data", data.to_str().expect("text"), "--json"]);
    assert!(
        output.status.success(),
        "{when}: {}{}",
        text(&output.stdout),
        text(&output.stderr)
    );
}

/// In every other life a job of an earlier life starts again, or other machines may finish it. A worker from outside renders too, so its
/// frames have to be proven.
fn disturb(service: &Service, kill: usize, jobs: &[(String, String)], dice: &mut Dice) -> Option<Worker> {
    if kill.is_multiple_of(2) || jobs.is_empty() {
        return None;
    }
    let (_, id) = &jobs[dice.draw(jobs.len() as u64) as usize];
    let action = ["start-again", "finish-elsewhere"][dice.draw(2) as usize];
    // A service that dies meanwhile does not respond.
    let _ = service.try_post_bytes(&format!("/v1/jobs/{id}/{action}"), b"");
    Some(Worker::start(&service.url, &format!("outsider-{kill}"), 1))
}

/// Failure: an acknowledged job is lost or does not finish, a frame has two images or no image, a row's bytes are
/// missing or differ, counts disagree, a database is damaged, the digest differs from that of an undisturbed run, a
/// healthy frame is given up, a frame stays unproven, or a key creates a second job.
#[test]
fn kills_at_every_step_and_at_any_time_lose_nothing() {
    let kills: usize = std::env::var("FATHOM_CRASH_KILLS").map_or(50, |n| n.parse().expect("a number"));
    let points = [SERVICE_POINTS.as_slice(), &WORKER_POINTS].concat();
    let (job, mut dice) = (small_job("crash"), Dice(20_261_121));
    let expected = digest_by_render(&job, temporary().path(), "2");
    let data = temporary();
    let mut acknowledged: Vec<(String, String)> = Vec::new();
    let (mut by_itself, mut from_outside) = (0, 0);
    for kill in 0..kills {
        let point = points[kill % points.len()];
        // Early or late in the life of the process. A worker lives long enough to finish its first lease: a frame with
        // three deaths in a row is correctly given up.
        let nth = match point {
            point if point.starts_with("worker") => 6 + dice.draw(8),
            point if point.starts_with("submit") => 1 + dice.draw(2),
            _ => 1 + dice.draw(8),
        };
        let fault = format!("{point}=abort@{nth}");
        let environment: &[(&str, &str)] = match kill % 4 {
            // No kill point: killed from outside at any time.
            3 => &[],
            _ => &[("FATHOM_FAULTS", &fault)],
        };
        let started = Service::launch(data.path(), &["--workers", "2", "--slots", "1"], environment);
        let mut service = match started {
            Ok(service) => service,
            // Workers find the jobs of earlier lives, and may reach the point before the service reports its address.
            Err(printed) => {
                assert!(!environment.is_empty(), "{printed}");
                by_itself += 1;
                audit(data.path(), &format!("after kill {kill} ({fault})"));
                continue;
            }
        };
        for submission in 0..2 {
            let key = format!("{kill}-{submission}");
            if let Some(id) = service.try_submit(&job, &key) {
                acknowledged.push((key, id));
            }
        }
        let outsider = disturb(&service, kill, &acknowledged, &mut dice);
        let until = Instant::now() + Duration::from_millis(40 + dice.draw(600));
        while service.is_alive() && Instant::now() < until {
            std::thread::sleep(Duration::from_millis(2));
        }
        if service.is_alive() {
            from_outside += 1
        } else {
            by_itself += 1
        }
        service.kill();
        drop(outsider);
        audit(data.path(), &format!("after kill {kill} ({fault})"));
    }
    let service = Service::start(data.path(), &["--workers", "2", "--slots", "2"]);
    for (key, id) in &acknowledged {
        let again = service.try_submit(&job, key);
        assert_eq!(again.as_ref(), Some(id), "key {key} names another job");
        let done = service.finished(id);
        assert_eq!(
            (done["state"].as_str(), done["done"].as_u64()),
            (Some("done"), Some(SMALL_JOB_FRAMES)),
            "{done}"
        );
        assert_eq!(done["digest"], expected, "{done}");
        assert_eq!(done["unproven"].as_u64().unwrap_or(0), 0, "{done}");
    }
    drop(service);
    audit(data.path(), "at the end");
    assert!(
        acknowledged.len() >= kills,
        "only {} jobs were accepted in {kills} lives",
        acknowledged.len()
    );
    println!(
        "{kills} kills ({by_itself} at a named point of the service, {from_outside} from outside), {} jobs of {SMALL_JOB_FRAMES} frames",
        acknowledged.len()
    );
}

/// Failure: a worker suspended for longer than its lease writes anything, its frames are not done by another, or the
/// digest differs.
#[test]
fn a_worker_that_slept_past_its_lease_cannot_write() {
    let mut job = small_job("crash");
    job["count"] = json!(400);
    let expected = digest_by_render(&job, temporary().path(), "2");
    let data = temporary();
    let service = Service::start(data.path(), &["--workers", "0"]);
    let zombie = Worker::start(&service.url, "zombie", 1);
    let id = service.submit(&job);
    // Suspended while it holds a lease.
    loop {
        let (_, body) = service.get("/v1/workers");
        let holds = body["items"]
            .as_array()
            .is_some_and(|all| all.iter().any(|w| w["leased_frames"] != 0));
        let (_, state) = service.get(&format!("/v1/jobs/{id}"));
        if holds && state["done"].as_u64() > Some(0) {
            break;
        }
    }
    zombie.signal("STOP");
    let (_, stopped) = service.get(&format!("/v1/jobs/{id}"));
    assert_ne!(stopped["state"], "done", "the worker was too fast: {stopped}");
    let other = Worker::start(&service.url, "other", 2);
    let done = service.finished(&id);
    let images = |service: &Service| service.get("/v1/datasets").1.to_string();
    let before = images(&service);
    zombie.signal("CONT");
    // Long enough for the resumed worker to send its finished results.
    std::thread::sleep(Duration::from_secs(2));
    assert_eq!(images(&service), before, "the woken worker changed something");
    assert_eq!(
        (done["done"].as_u64(), done["failed"].as_u64()),
        (Some(400), Some(0)),
        "{done}"
    );
    assert_eq!(done["digest"], expected);
    drop((zombie, other, service));
    audit(data.path(), "after the zombie");
}
