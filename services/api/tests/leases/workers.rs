//! The worker against a service that restarts, loses responses, cancels and disappears.

use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{self, JoinHandle};
use std::time::{Duration, Instant};

use imaging::codec::{encode_npy_plane, encode_png};
use imaging::{Plane, Raster, Rgb8};
use renderer::worker::{self, Limits, WorkerOptions};
use renderer::{Engine, SceneSource, Slot};
use serde_json::{Value, json};
use spec::{Job, RangeFile, RangeKind, SceneFiles};
use style::Library;

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
            onnxruntime: Some(NO_RUNTIME.into()),
            limits: Limits::NONE,
        };
        let stopped = Arc::clone(&stop);
        Self {
            stop,
            thread: thread::spawn(move || worker::run(options, stopped)),
        }
    }

    /// Stops the worker; returns how long it took.
    fn stop(self) -> Duration {
        let begun = Instant::now();
        self.stop.store(true, Ordering::SeqCst);
        self.thread.join().unwrap().unwrap();
        begun.elapsed()
    }
}

const FRAMES: u64 = 40;
/// A path without an ONNX Runtime.
const NO_RUNTIME: &str = "/nowhere/libonnxruntime.so";

/// An image, and its range: 1 m at the left to 5 m at the right, a hole in the corner.
fn files() -> (Vec<u8>, Vec<u8>) {
    let picture = Rgb8::from_fn(48, 32, |x, y| [5 * x as u8, 7 * y as u8, 90]);
    let range = Plane::from_fn(48, 32, |x, y| match (x, y) {
        (0, 0) => f32::NAN,
        _ => 1.0 + 4.0 * x as f32 / 47.0,
    });
    (
        encode_png(&Raster::from(picture)).unwrap(),
        encode_npy_plane(&range),
    )
}

/// The shipped styles and `foreign`: the network of `muddy` with a renamed graph, which only ONNX Runtime accepts.
fn library() -> Library {
    let shipped = Library::embedded().unwrap();
    let mut onnx = shipped.get("muddy").unwrap().onnx.to_vec();
    let name = b"style";
    let start = onnx
        .windows(name.len())
        .position(|window| window == name)
        .unwrap();
    onnx[start] = b'F';
    shipped.with_model("foreign", onnx, None).unwrap()
}

/// A job with the uploaded scene of the service.
fn job(frames: u64, fields: &Value) -> Job {
    let mut description = json!({
        "scene": {"kind": "uploaded", "id": "scn_018f0000000070008000000000000000"},
        "camera": {"hfov_deg": 80}, "count": frames,
        "water": {"optics": "jerlov-3C", "range_scale": {"uniform": [0.5, 3]}},
        "artifacts": ["rgb", "range"], "metrics": ["uciqe"]});
    for (name, value) in fields.as_object().unwrap() {
        description[name] = value.clone();
    }
    let vocabulary = renderer::vocabulary(&library(), true);
    Job::parse(description.to_string().as_bytes(), &vocabulary).unwrap_or_else(|invalid| panic!("{invalid}"))
}

fn service(frames: u64) -> (FakeService, Job) {
    let service = FakeService::start();
    let job = job(frames, &json!({}));
    let (rgb, range) = files();
    service.add_scene(rgb, range);
    service.add_job("job_1", &job);
    (service, job)
}

/// The digest of every frame, rendered without a service.
fn expected(job: &Job) -> BTreeMap<u64, String> {
    let (rgb, range) = files();
    let kind = RangeKind::Range;
    let range = Some(RangeFile {
        file: range,
        kind,
        unit_m: Some(1.0),
        invalid_code: None,
    });
    let source = SceneSource::Uploaded(Arc::new(SceneFiles {
        rgb,
        range,
        intrinsics: None,
        classes: None,
        world_from_camera: None,
        hfov_deg: None,
        scale: None,
        instances: None,
    }));
    let engine = Arc::new(Engine::new(library(), Some(Path::new(NO_RUNTIME))));
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
    assert_eq!(
        service.state().fetched,
        1,
        "three slots, many leases, one description"
    );
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
fn a_commit_with_a_lost_response_is_harmless() {
    let (service, job) = service(10);
    service.state().lost_answers = 2;
    let worker = Worker::start(&service, 1);
    service.wait("all frames", |state| state.images.len() == 10);
    worker.stop();
    assert_eq!(committed(&service), expected(&job));
    let state = service.state();
    assert_eq!((state.commits, state.lost_answers), (10, 0));
    assert_eq!(state.table.totals(), api::lease_table::Totals::default());
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
fn a_stopped_worker_returns_its_leases_without_counting_an_attempt() {
    let (service, _) = service(1_000_000);
    let worker = Worker::start(&service, 2);
    service.wait("some frames", |state| state.images.len() > 3);
    let took = worker.stop();
    assert!(took < Duration::from_secs(10), "{took:?}");
    let mut state = service.state();
    assert_eq!(state.table.totals().leased, 0);
    let grant = state
        .table
        .grant("other", api::lease_table::Millis(0), u64::MAX, 1.0)
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
        state.table.totals() == api::lease_table::Totals::default()
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
    let (rgb, range) = files();
    service.add_scene(rgb, range);
    let styles = json!({"water": {"style": {"grid": ["muddy", "foreign"]}}, "alpha": {"grid": [0.0, 1.0]}});
    service.add_job("job_1", &job(1, &styles));
    let worker = Worker::start(&service, 2);
    service.wait("the end of the job", |state| {
        state.table.totals() == api::lease_table::Totals::default()
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

#[test]
fn a_worker_does_not_join_a_service_of_another_version_of_the_protocol() {
    let (service, _) = service(1);
    service.state().protocol = Some(wire::VERSION + 1);
    let worker = Worker::start(&service, 1);
    let refusal = worker.thread.join().unwrap().unwrap_err();
    let said = format!("{refusal:#}");
    let (theirs, ours) = (wire::VERSION + 1, wire::VERSION);
    assert!(
        said.contains(&format!(
            "the other side uses version {theirs} of the worker protocol"
        )) && said.contains(&format!("this side version {ours}"))
            && said.contains("run the same version of fathom"),
        "{said}"
    );
}
