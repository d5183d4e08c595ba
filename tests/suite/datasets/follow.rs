//! Sets imported by a running service while they grow. The comment above each test defines failure.

use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use fathom_tests::{Service, digest_by_render, run};
use serde_json::{Value, json};

use crate::datasets::sets::{Work, text};

const PATIENCE: Duration = Duration::from_secs(120);

/// Failure: shards finished while the service is running or stopped are not imported, a repeated import creates a
/// second job, or the job differs from one rendered by the service.
#[test]
fn a_running_service_follows_a_set_to_its_end() {
    let work = Work::new(&job(20));
    let expected = digest_by_render(&job(20), work.folder(), "2");
    let shards = |frames: &str| {
        let output = work.render(&["--frames-per-shard", "5", "--frames", frames]);
        assert!(output.status.success(), "{}", text(&output.stderr));
    };
    shards("0..5");
    let service = serve(&work);
    let set = import(&service, &url(&work));
    let id = set["job"].as_str().expect("an id").to_owned();
    wait(&service, &id, |row| row["done"] == 5);
    assert_eq!(import(&service, &url(&work))["job"], json!(id));
    shards("5..10");
    let row = wait(&service, &id, |row| row["done"] == 10);
    assert_eq!(row["state"], "running");
    service.kill();
    shards("10..15");
    let service = serve(&work);
    wait(&service, &id, |row| row["done"] == 15);
    shards("15..20");
    let waited = run(&[
        "import",
        &url(&work),
        "--server",
        &service.url,
        "--wait",
        "--json",
    ]);
    assert!(waited.status.success(), "{}", text(&waited.stderr));
    let set: Value = serde_json::from_slice(&waited.stdout).expect("JSON");
    assert_eq!(
        (
            &set["job"],
            &set["state"],
            &set["shards"],
            &set["followed"],
            &set["error"]
        ),
        (&json!(id), &json!("done"), &json!(4), &json!(false), &Value::Null)
    );
    let row = service.get(&format!("/v1/jobs/{id}")).1;
    assert_eq!(row["digest"], json!(expected));
    assert_eq!(service.get("/v1/sets").1["items"], json!([set]));
    let (status, bytes) = service.get_bytes(&format!("/v1/images/{id}/17/artifacts/rgb"));
    assert!(status == 200 && bytes.starts_with(b"\x89PNG"));
}

/// Failure: a forgotten set is still shown or followed, or its files are deleted.
#[test]
fn a_set_is_forgotten_and_stays_where_it_is() {
    let work = Work::new(&job(10));
    assert!(
        work.render(&["--frames-per-shard", "5", "--shard", "0/2"])
            .status
            .success()
    );
    let service = serve(&work);
    let id = import(&service, &url(&work))["job"]
        .as_str()
        .expect("an id")
        .to_owned();
    wait(&service, &id, |row| row["done"] == 5);
    let (status, deleted) = service.delete(&format!("/v1/sets/{id}"));
    assert_eq!((status, &deleted["images"]), (200, &json!(5)), "{deleted}");
    assert_eq!(service.get(&format!("/v1/sets/{id}")).0, 404);
    assert!(work.render(&[]).status.success());
    std::thread::sleep(Duration::from_secs(5));
    assert_eq!(service.get("/v1/jobs").1["items"], json!([]));
    let again = import(&service, &url(&work))["job"]
        .as_str()
        .expect("an id")
        .to_owned();
    assert_ne!(again, id);
    wait(&service, &again, |row| row["state"] == "done");
}

/// Failure: a client makes the service read a location outside of any store, learns whether it exists, or a refusal
/// leaves a trace.
#[test]
fn only_sets_in_a_store_are_read() {
    let work = Work::new(&job(5));
    assert!(work.render(&[]).status.success());
    let store = work.folder().join("store");
    fs::create_dir(&store).expect("a folder");
    std::os::unix::fs::symlink(work.set(), store.join("link")).expect("a link");
    fs::create_dir(store.join("empty")).expect("a folder");
    let service = Service::start(
        &work.folder().join("data"),
        &["--workers", "0", "--store", &path(&store)],
    );
    let refused = |body: Value, pointer: &str, part: &str| {
        let (status, problem) = service.post("/v1/sets", &body);
        assert_eq!(status, 422, "{body}: {problem}");
        let errors = problem["errors"].as_array().expect("errors");
        let found = errors.iter().find(|error| error["pointer"] == pointer);
        let message = found
            .and_then(|error| error["message"].as_str())
            .unwrap_or_default();
        assert!(message.contains(part), "{body}: {problem}");
    };
    let outside = "does not lie in a store of this service";
    for url in [
        url(&work),
        format!("file://{}", url(&work)),
        path(&store.join("link")),
        path(&store.join("../set")),
        "/etc".to_owned(),
        "/there/is/nothing".to_owned(),
        "s3://bucket/set".to_owned(),
        "set".to_owned(),
        "--below".to_owned(),
    ] {
        refused(json!({"url": url}), "/url", outside);
    }
    refused(json!({"url": path(&store.join("empty"))}), "/url", "holds no set");
    refused(
        json!({"url": path(&store.join("nothing"))}),
        "/url",
        "No such file",
    );
    refused(json!({"url": "gs://a/b"}), "/url", "is no store");
    refused(json!({"url": 7}), "/url", "must be a string");
    refused(json!({"url": "x".repeat(5000)}), "/url", "must be at most 4096");
    refused(json!({"link": "x"}), "/link", "`link` is not a field");
    refused(json!({"link": "x"}), "/url", "`url` is missing");
    assert_eq!(service.post("/v1/sets", &json!("x")).0, 400);
    assert_eq!(service.get("/v1/jobs").1["items"], json!([]));
    assert_eq!(
        service.get("/v1/sets/job_0198c0ffee007000800000000000000a").0,
        404
    );
    let closed = Service::start(&work.folder().join("other"), &["--workers", "0"]);
    let (status, problem) = closed.post("/v1/sets", &json!({"url": url(&work)}));
    assert_eq!(
        (status, &problem["type"]),
        (409, &json!("/problems/imports-disabled"))
    );
    let refused = run(&["import", &path(&work.set()), "--server", &closed.url]);
    let told = String::from_utf8_lossy(&refused.stderr).into_owned();
    assert_eq!(refused.status.code(), Some(2), "{told}");
    assert!(
        told.contains("This service imports no sharded datasets") && told.contains("--store FOLDER"),
        "{told}"
    );
}

/// Failure: a contradictory shard is imported, stops the service from polling, or is not reported as damaged.
#[test]
fn a_damaged_shard_is_said_and_imported_once_it_is_repaired() {
    let work = Work::new(&job(10));
    assert!(work.render(&["--frames-per-shard", "5"]).status.success());
    let marker = work.set().join("done/000001.json");
    let good = fs::read_to_string(&marker).expect("a marker");
    fs::write(&marker, good.replace("\"images\": 5", "\"images\": 4")).expect("a writable set");
    let service = serve(&work);
    let id = import(&service, &url(&work))["job"]
        .as_str()
        .expect("an id")
        .to_owned();
    let set = wait_for(
        || service.get(&format!("/v1/sets/{id}")).1,
        |set| set["error"].is_string(),
    );
    assert!(
        set["error"]
            .as_str()
            .is_some_and(|error| error.contains("done/000001.json"))
            && set["followed"] == true,
        "{set}"
    );
    fs::write(&marker, good).expect("a writable set");
    wait(&service, &id, |row| row["state"] == "done");
    let set = wait_for(
        || service.get(&format!("/v1/sets/{id}")).1,
        |set| set["followed"] == false,
    );
    assert_eq!(set["error"], Value::Null);
}

fn serve(work: &Work) -> Service {
    Service::start(
        &work.folder().join("data"),
        &["--workers", "0", "--store", &path(work.folder())],
    )
}

fn import(service: &Service, url: &str) -> Value {
    let (status, set) = service.post("/v1/sets", &json!({"url": url}));
    assert_eq!(status, 202, "{set}");
    set
}

fn wait(service: &Service, id: &str, has_come: impl Fn(&Value) -> bool) -> Value {
    wait_for(|| service.get(&format!("/v1/jobs/{id}")).1, has_come)
}

fn wait_for(look: impl Fn() -> Value, has_come: impl Fn(&Value) -> bool) -> Value {
    let begun = Instant::now();
    loop {
        let found = look();
        if has_come(&found) {
            return found;
        }
        assert!(begun.elapsed() < PATIENCE, "waited in vain: {found}");
        std::thread::sleep(Duration::from_millis(50));
    }
}

fn url(work: &Work) -> String {
    path(&work.set().canonicalize().expect("a set"))
}

fn path(path: &Path) -> String {
    path.to_str().expect("a path of text").to_owned()
}

fn job(count: u64) -> Value {
    json!({
        "dataset": "reef", "count": count, "seed": 5,
        "scene": {"kind": "procedural", "family": "structure", "seed": {"int": [0, 1_000_000]}},
        "camera": {"width": 40, "height": 24, "hfov_deg": 70},
        "water": {"optics": "jerlov-3C"}, "artifacts": ["rgb", "range"]
    })
}
