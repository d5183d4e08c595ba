use std::time::Duration;

use super::*;
use crate::app::App;
use crate::config::{Config, Surroundings};
use crate::jobs::wait::Until;
use crate::limits::Limits;

pub(in crate::jobs) async fn app(folder: &std::path::Path) -> App {
    let config = Config {
        data: folder.to_owned(),
        listen: "127.0.0.1:0".parse().unwrap(),
        workers: 0,
        slots_per_worker: 1,
        program: "/bin/false".into(),
        hosts: Vec::new(),
        token: None,
        styles: None,
        onnxruntime: None,
        library: style::Library::embedded().unwrap(),
        stores: Vec::new(),
        engine: None,
        buckets: std::sync::Arc::new(|place, _| Err(crate::Unread::Gone(place.set.clone()))),
        style_trial: Duration::from_secs(1),
        frame_limit: Duration::from_secs(600),
        prices: crate::limits::PriceLimits::default(),
        mix_workers: false,
        spot_check: 0,
    };
    let surroundings = Surroundings {
        clock: crate::clock::Clock::system(),
        style_runtime: Err("none".to_owned()),
        limits: Limits {
            reserve_bytes: 1 << 16,
            compute: 1,
            ..Limits::default()
        },
    };
    App::open(&config, &surroundings).await.unwrap().0
}

/// Failure: a job is priced on a thread that serves requests.
#[tokio::test]
async fn a_price_is_sampled_in_a_place_of_the_pool() {
    let folder = tempfile::tempdir().unwrap();
    let jobs = app(folder.path()).await.jobs;
    let text = r#"{"dataset": "x", "scene": {"kind": "procedural", "family": "structure", "seed": 1}}"#;
    let job = Job::parse(text.as_bytes(), &jobs.vocabulary()).unwrap();
    let (release, released) = std::sync::mpsc::channel::<()>();
    let processes = Arc::clone(&jobs.processes);
    let held = tokio::spawn(async move { processes.compute.run(move || released.recv()).await });
    tokio::task::yield_now().await;
    let early = tokio::time::timeout(Duration::from_millis(100), jobs.price(&job)).await;
    assert!(early.is_err(), "it does not wait for a place");
    release.send(()).unwrap();
    jobs.price(&job).await.unwrap();
    held.await.unwrap().unwrap().unwrap();
}

#[tokio::test]
async fn a_job_is_never_read_again_after_it_was_written() {
    let folder = tempfile::tempdir().unwrap();
    let jobs = app(folder.path()).await.jobs;
    let text = r#"{"dataset": "x", "scene": {"kind": "procedural", "family": "structure", "seed": 1},
                   "camera": {"width": 100, "height": 50, "hfov_deg": 80}}"#;
    let submit = || {
        let job = Job::parse(text.as_bytes(), &jobs.vocabulary()).unwrap();
        let submitter = Submitter {
            owner: "me".to_owned(),
            idempotency_key: Some("key".to_owned()),
        };
        let submission = Submission {
            submitter,
            priority: 0,
            again: false,
        };
        jobs.submit(job, submission)
    };
    let reads = jobs.catalogue.reads();
    let stored = submit().await.unwrap().job.row;
    let submitted = submit().await.unwrap().job;
    assert_eq!(submitted.row, stored);
    let paused = jobs.pause(stored.id.clone()).await.unwrap();
    jobs.resume(stored.id.clone()).await.unwrap();
    // Resuming reads the description, which may be of an earlier version.
    let reads = reads + 1;
    let cancelled = jobs.cancel(stored.id.clone()).await.unwrap();
    assert_eq!(jobs.catalogue.reads(), reads, "every change returns its row");
    assert_eq!((stored.version, paused.version), (1, 2));
    let seen = jobs
        .wait_on(submitted, Duration::ZERO, Until::Ended)
        .await
        .unwrap();
    assert_eq!(seen, cancelled, "a change since the submission is noticed");
    assert_eq!(jobs.catalogue.reads(), reads + 1);
}
