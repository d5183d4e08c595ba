//! The worker against a service that restarts, loses answers, cancels and goes away.

use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use renderer::worker::{self, Limits, WorkerOptions};
use renderer::{Engine, RangeUpload, SceneSource, Slot, UploadedScene};
use scenes::uploaded::RangeKind;
use serde_json::{Value, json};
use spec::Job;

use crate::common::{Files, engine_without_runtime, library, parse};
use crate::fake_service::FakeService;

struct Worker {
    stop: Arc<AtomicBool>,
    thread: JoinHandle<anyhow::Result<()>>,
}

impl Worker {
    fn start(service: &FakeService, slots: usize) -> Self {
        let stop = Arc::new(AtomicBool::new(false));
        let options = WorkerOptions {
            server: service.url.clone(),
            token: None,
            slots,
            name: "test".to_owned(),
            library: library(),
            onnxruntime: Some("/nowhere/libonnxruntime.so".into()),
            limits: Limits::NONE,
        };
        let stopped = Arc::clone(&stop);
        Self {
            stop,
            thread: thread::spawn(move || worker::run(options, &stopped)),
        }
    }

    /// Stops the worker; answers how long it took.
    fn stop(self) -> Duration {
        let begun = Instant::now();
        self.stop.store(true, Ordering::SeqCst);
        self.thread.join().unwrap().unwrap();
        begun.elapsed()
    }
}

const FRAMES: u64 = 40;

/// A job about the uploaded scene of the service.
fn job(frames: u64, fields: &Value) -> Job {
    let mut description = json!({
        "scene": {"kind": "uploaded", "id": "scn_018f0000000070008000000000000000"},
        "camera": {"width": 48, "height": 32, "hfov_deg": 80}, "count": frames,
        "water": {"optics": "jerlov-3C", "range_scale": {"uniform": [0.5, 3]}},
        "artifacts": ["rgb", "range"], "metrics": ["uciqe"]});
    for (name, value) in fields.as_object().unwrap() {
        description[name] = value.clone();
    }
    parse(&description)
}

fn service(frames: u64) -> (FakeService, Job) {
    let service = FakeService::start();
    let job = job(frames, &json!({}));
    let (rgb, range) = Files::new().bytes();
    service.add_scene(rgb, range);
    service.add_job("job_1", &job);
    (service, job)
}

/// The digest of every frame, rendered without a service.
fn expected(job: &Job) -> BTreeMap<u64, String> {
    let (rgb, range) = Files::new().bytes();
    let kind = RangeKind::Range;
    let range = Some(RangeUpload {
        bytes: range,
        kind,
        unit_m: Some(1.0),
        invalid_code: None,
    });
    let source = SceneSource::Uploaded(Arc::new(UploadedScene {
        rgb,
        range,
        intrinsics: None,
        instances: None,
    }));
    let engine: Arc<Engine> = engine_without_runtime();
    let mut slot = Slot::new(&engine);
    let render = |frame| {
        slot.render(&job.resolve(frame).unwrap(), &source)
            .unwrap()
            .record
            .digest()
    };
    let digests: Vec<String> = (0..job.frames()).map(render).collect();
    (0..).zip(digests).collect()
}

fn committed(service: &FakeService) -> BTreeMap<u64, String> {
    service
        .state()
        .images
        .iter()
        .map(|(frame, record)| (*frame, record.digest()))
        .collect()
}

#[test]
fn a_job_comes_out_as_without_a_service_and_each_frame_is_committed_once() {
    let (service, job) = service(FRAMES);
    let worker = Worker::start(&service, 3);
    service.wait("all frames", |state| state.images.len() as u64 == FRAMES);
    worker.stop();
    assert_eq!(committed(&service), expected(&job));
    assert_eq!(service.state().commits, FRAMES);
    assert!(service.state().failures.is_empty());
}

#[test]
fn after_a_restart_of_the_service_the_worker_joins_again_and_finishes() {
    let (service, job) = service(FRAMES);
    let worker = Worker::start(&service, 2);
    service.wait("some frames", |state| state.images.len() > 3);
    service.restart();
    service.wait("all frames", |state| state.images.len() as u64 == FRAMES);
    worker.stop();
    assert_eq!(committed(&service), expected(&job));
}

#[test]
fn a_commit_whose_answer_is_lost_costs_nothing() {
    let (service, job) = service(10);
    service.state().lost_answers = 2;
    let worker = Worker::start(&service, 1);
    service.wait("all frames", |state| state.images.len() == 10);
    worker.stop();
    assert_eq!(committed(&service), expected(&job));
    let state = service.state();
    assert_eq!((state.commits, state.lost_answers), (10, 0));
    assert_eq!(state.table.totals(), queue::Totals::default());
}

#[test]
fn a_service_that_goes_away_is_waited_for() {
    let (service, job) = service(FRAMES);
    service.state().away = true;
    let worker = Worker::start(&service, 2);
    thread::sleep(Duration::from_millis(100));
    service.state().away = false;
    service.wait("some frames", |state| state.images.len() > 3);
    service.state().away = true;
    thread::sleep(Duration::from_millis(300));
    service.state().away = false;
    service.wait("all frames", |state| state.images.len() as u64 == FRAMES);
    worker.stop();
    assert_eq!(committed(&service), expected(&job));
}

#[test]
fn a_stopped_worker_gives_everything_back_without_burning_an_attempt() {
    let (service, _) = service(1_000_000);
    let worker = Worker::start(&service, 2);
    service.wait("some frames", |state| state.images.len() > 3);
    let took = worker.stop();
    assert!(took < Duration::from_secs(10), "{took:?}");
    let mut state = service.state();
    assert_eq!(state.table.totals().leased, 0);
    let grant = state
        .table
        .grant("other", queue::Millis(0), u64::MAX, 1.0)
        .unwrap();
    assert!(grant.frames.iter().all(|&(_, attempt)| attempt == 1));
}

#[test]
fn a_cancelled_job_is_dropped_and_the_next_one_is_taken() {
    let (service, _) = service(1_000_000);
    let worker = Worker::start(&service, 1);
    service.wait("some frames", |state| state.images.len() > 3);
    service.state().table.cancel("job_1");
    service.state().images.clear();
    service.add_job("job_2", &job(5, &json!({"seed": 2})));
    service.wait("the other job", |state| {
        state.table.totals() == queue::Totals::default()
    });
    worker.stop();
    let images = service.state().images.len();
    assert!(
        (5..8).contains(&images),
        "{images}: five, and what was under way when the job was cancelled"
    );
}

#[test]
fn a_frame_that_cannot_be_rendered_is_reported_once_with_the_reason() {
    let service = FakeService::start();
    let (rgb, range) = Files::new().bytes();
    service.add_scene(rgb, range);
    let styles = json!({"water": {"style": {"grid": ["muddy", "foreign"]}}, "alpha": {"grid": [0.0, 1.0]}});
    service.add_job("job_1", &job(1, &styles));
    let worker = Worker::start(&service, 2);
    service.wait("the end of the job", |state| {
        state.table.totals() == queue::Totals::default()
    });
    worker.stop();
    let state = service.state();
    assert_eq!(state.images.len(), 3, "our networks and alpha 0 need no runtime");
    assert_eq!(state.failures.len(), 1);
    for (_, error, retryable) in &state.failures {
        assert!(
            !retryable && error.contains("scripts/get-onnxruntime.sh"),
            "{error}"
        );
    }
}

#[test]
fn a_worker_that_is_refused_ends_with_the_reason() {
    let (service, _) = service(1);
    service.state().strict = true;
    let error = Worker::start(&service, 1).thread.join().unwrap().unwrap_err();
    assert!(format!("{error:#}").contains("401"), "{error:#}");
}
