//! Styles trained by the service through the real binary: good photos, bad photos, and interrupted trainings.

#![allow(clippy::unwrap_used)]

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use fathom_tests::{Service, muddy_photo, run};
use imaging::codec::encode_png;
use imaging::{Channels, Raster, Rgb8, Samples};
use serde_json::{Value, json};

const LIMIT: Duration = Duration::from_secs(240);

fn photo() -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::read(muddy_photo(folder.path())).unwrap()
}

fn ask(service: &Service, name: &str, steps: &str, photo: &[u8]) -> (u16, Value) {
    ask_with_range(service, (name, "false"), steps, photo)
}

fn ask_with_range(service: &Service, (name, range): (&str, &str), steps: &str, photo: &[u8]) -> (u16, Value) {
    let fields = [
        ("range", range.as_bytes()),
        ("name", name.as_bytes()),
        ("steps", steps.as_bytes()),
        ("photo", photo),
    ];
    service.form("/v1/styles/train", &fields)
}

/// The training when it is no longer queued or running.
fn ended(service: &Service, id: &Value) -> Value {
    let path = format!("/v1/styles/trainings/{}?wait=30", id.as_str().unwrap());
    let begun = Instant::now();
    while begun.elapsed() < LIMIT {
        let (status, training) = service.get(&path);
        assert_eq!(status, 200, "{training}");
        if !["queued", "running"].contains(&training["state"].as_str().unwrap()) {
            return training;
        }
    }
    panic!("the training does not end");
}

fn names(service: &Service) -> Vec<String> {
    let (_, page) = service.get("/v1/styles");
    let cards = page["items"].as_array().unwrap();
    cards
        .iter()
        .map(|card| card["name"].as_str().unwrap().to_owned())
        .collect()
}

#[test]
fn a_photo_becomes_a_style_that_is_usable_at_once_and_the_same_as_the_command_makes() {
    let data = tempfile::tempdir().unwrap();
    let service = Service::start(data.path(), &["--slots", "1"]);
    let photo = photo();
    let (status, training) = ask(&service, "harbour", "3", &photo);
    assert_eq!(status, 202, "{training}");
    let training = ended(&service, &training["id"]);
    assert_eq!(
        (&training["state"], &training["done"]),
        (&json!("done"), &json!(3)),
        "{training}"
    );
    let (_, page) = service.get("/v1/styles");
    assert!(
        page["items"].as_array().unwrap().contains(&training["card"]),
        "{page}"
    );
    let job = json!({"dataset": "harbour", "water": {"style": "harbour"}, "metrics": [],
        "scene": {"kind": "procedural", "family": "structure", "seed": 1},
        "camera": {"width": 48, "height": 32, "hfov_deg": 80}});
    assert_eq!(service.finished(&service.submit(&job))["state"], "done");
    let (status, problem) = ask(&service, "harbour", "3", &photo);
    assert_eq!(
        (status, &problem["type"]),
        (409, &json!("/problems/name-taken")),
        "{problem}"
    );

    let (file, out) = (data.path().join("photo.png"), data.path().join("out"));
    std::fs::write(&file, &photo).unwrap();
    let [file, out_text] = [&file, &out].map(|path| path.to_str().unwrap());
    let arguments = [
        "train",
        file,
        "--name",
        "harbour",
        "--steps",
        "3",
        "--threads",
        "1",
        "--out",
        out_text,
    ];
    assert!(run(&arguments).status.success());
    let card: Value = serde_json::from_slice(&std::fs::read(out.join("harbour.card.json")).unwrap()).unwrap();
    assert_eq!(card["sha256"], training["card"]["sha256"]);
    assert_eq!(card["training"], training["card"]["training"]);
}

#[test]
fn a_style_that_follows_the_range_can_be_trained() {
    let data = tempfile::tempdir().unwrap();
    let service = Service::start(data.path(), &["--slots", "1"]);
    let (status, training) = ask_with_range(&service, ("dock", "true"), "3", &photo());
    assert_eq!((status, &training["range"]), (202, &json!(true)), "{training}");
    let training = ended(&service, &training["id"]);
    assert_eq!(training["state"], "done", "{training}");
    let (_, page) = service.get("/v1/styles");
    let styles = page["items"].as_array().unwrap();
    let dock = styles.iter().find(|style| style["name"] == "dock").unwrap();
    assert_eq!(dock["takes_range"], true, "{dock}");
}

#[test]
fn a_training_shows_what_it_has_learned_by_now() {
    let data = tempfile::tempdir().unwrap();
    let service = Service::start(data.path(), &["--slots", "1"]);
    let (status, training) = ask(&service, "quay", "5000", &photo());
    assert_eq!(status, 202, "{training}");
    let path = format!("/v1/styles/trainings/{}", training["id"].as_str().unwrap());
    let begun = Instant::now();
    let mut seen = Vec::new();
    while seen.len() < 2 {
        assert!(begun.elapsed() < LIMIT, "no two previews: {seen:?}");
        let (_, now) = service.get(&path);
        assert!(
            ["queued", "running"].contains(&now["state"].as_str().unwrap()),
            "{now}"
        );
        if let Some(drawn) = now["preview_ms"].as_u64().filter(|drawn| !seen.contains(drawn)) {
            let (status, bytes) = service.get_bytes(&format!("{path}/preview"));
            assert_eq!(status, 200);
            let picture = imaging::codec::decode_picture(&bytes).unwrap();
            assert_eq!((picture.width(), picture.height()), (320, 240));
            seen.push(drawn);
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    assert_eq!(service.delete(&path).0, 200);
    assert_eq!(ended(&service, &training["id"])["state"], "cancelled");
    assert_eq!(service.get_bytes(&format!("{path}/preview")).0, 404);
}

#[test]
fn photos_that_cannot_be_learned_from_are_refused_at_once_and_the_others_taken() {
    let data = tempfile::tempdir().unwrap();
    let service = Service::start(data.path(), &["--slots", "1"]);
    let before = names(&service);
    let encode_square = |side, pixel: fn(usize, usize) -> [u8; 3]| {
        encode_png(&Rgb8::from_fn(side, side, pixel).into()).unwrap()
    };
    let whole = photo();
    let bad = [
        ("flat", encode_square(100, |_, _| [9, 120, 180]), "flat"),
        ("black", encode_square(100, |_, _| [0; 3]), "flat"),
        ("dot", encode_square(1, |_, _| [9; 3]), "1×1"),
        ("text", b"hello, world".to_vec(), "neither PNG"),
        ("empty", Vec::new(), "neither PNG"),
        ("cut", whole[..whole.len() / 2].to_vec(), "photo 1"),
        ("bomb", bomb(), "photo 1"),
    ];
    for (name, bytes, says) in bad {
        let (status, problem) = ask(&service, name, "1", &bytes);
        assert_eq!(status, 422, "{name}: {problem}");
        let error = &problem["errors"][0];
        assert_eq!(error["pointer"], "/photo", "{name}: {problem}");
        let message = error["message"].as_str().unwrap();
        assert!(
            message.contains(says) && !message.contains("/tmp"),
            "{name}: {problem}"
        );
    }
    assert_eq!(names(&service), before);

    let deep = (0..100 * 80u32).map(|at| (at * 7919 % 65_536) as u16).collect();
    let deep = Raster::new(100, 80, Channels::Gray, Samples::U16(deep), None).unwrap();
    let huge = Rgb8::from_fn(3000, 1600, |x, y| {
        [(x / 20) as u8, (y / 9) as u8, (x * y % 251) as u8]
    });
    for (name, picture) in [("gray_and_deep", deep), ("huge", huge.into())] {
        let (status, training) = ask(&service, name, "1", &encode_png(&picture).unwrap());
        assert_eq!(status, 202, "{name}: {training}");
        assert_eq!(ended(&service, &training["id"])["state"], "done", "{name}");
        assert!(names(&service).contains(&name.to_owned()));
    }
}

/// A PNG whose header announces 60000×60000 pixels.
fn bomb() -> Vec<u8> {
    let mut bytes = encode_png(&Rgb8::from_fn(2, 2, |_, _| [1, 2, 3]).into()).unwrap();
    for at in [16, 20] {
        bytes[at..at + 4].copy_from_slice(&60_000u32.to_be_bytes());
    }
    bytes
}

#[test]
fn a_training_that_ends_in_the_middle_leaves_nothing_and_the_service_goes_on() {
    let data = tempfile::tempdir().unwrap();
    let service = Service::start(data.path(), &["--slots", "1"]);
    let (before, photo) = (names(&service), photo());

    let (_, cancelled) = ask(&service, "cancelled", "5000", &photo);
    running(&service, &cancelled["id"]);
    // It is queued behind the first.
    let (_, killed) = ask(&service, "killed", "5000", &photo);
    assert_eq!(killed["state"], "queued");
    let (status, problem) = ask(&service, "killed", "5000", &photo);
    assert_eq!(status, 409, "{problem}");
    let path = format!("/v1/styles/trainings/{}", cancelled["id"].as_str().unwrap());
    assert_eq!(service.delete(&path).1["state"], "cancelled");

    running(&service, &killed["id"]);
    kill_training_of("killed");
    let training = ended(&service, &killed["id"]);
    assert_eq!(training["state"], "failed");
    assert!(
        training["error"].as_str().unwrap().contains("signal: 9"),
        "{training}"
    );
    assert_eq!(names(&service), before);

    let (_, again) = ask(&service, "killed", "1", &photo);
    assert_eq!(ended(&service, &again["id"])["state"], "done", "the name is free");

    // Stopping the service ends an open training; finished styles remain.
    let (_, open) = ask(&service, "open", "5000", &photo);
    running(&service, &open["id"]);
    drop(service);
    let service = Service::start(data.path(), &["--slots", "1"]);
    assert!(names(&service).contains(&"killed".to_owned()));
    assert!(!names(&service).contains(&"open".to_owned()));
    let (status, _) = service.get(&format!("/v1/styles/trainings/{}", open["id"].as_str().unwrap()));
    assert_eq!(status, 404);
}

/// Failure: after SIGKILL of the service the trainer goes on, or the photos stay.
#[test]
fn a_training_ends_with_a_service_that_is_killed() {
    let data = tempfile::tempdir().unwrap();
    let service = Service::start(data.path(), &["--slots", "1"]);
    let (_, training) = ask(&service, "orphan", "5000", &photo());
    running(&service, &training["id"]);
    // Empty of a process that ended and is not awaited yet.
    let command = PathBuf::from("/proc").join(training_of("orphan")).join("cmdline");
    assert!(!walk(&data.path().join("tmp")).is_empty(), "the photo is there");
    service.kill();
    let begun = Instant::now();
    while std::fs::read(&command).is_ok_and(|command| !command.is_empty()) {
        assert!(
            begun.elapsed() < Duration::from_secs(10),
            "the trainer outlives the service"
        );
        std::thread::sleep(Duration::from_millis(20));
    }
    let _service = Service::start(data.path(), &["--slots", "1"]);
    let left = walk(&data.path().join("tmp"));
    assert!(left.is_empty(), "{left:?}");
}

/// The process cannot write while it trains: the result has no place to be stored.
#[test]
fn a_disk_that_fills_while_training_ends_the_training_alone() {
    let data = tempfile::tempdir().unwrap();
    let service = Service::start(data.path(), &["--slots", "1"]);
    let (before, photo) = (names(&service), photo());
    let (_, training) = ask(&service, "full", "300", &photo);
    running(&service, &training["id"]);
    let limited = std::process::Command::new("prlimit")
        .args(["--pid", &training_of("full"), "--fsize=4096"])
        .status();
    assert!(limited.unwrap().success());
    let training = ended(&service, &training["id"]);
    assert_eq!(training["state"], "failed", "{training}");
    // SIGXFSZ, or the error of the write where that is ignored.
    let error = training["error"].as_str().unwrap();
    assert!(
        error.contains("signal: 25") || error.contains("File too large"),
        "{training}"
    );
    assert_eq!(names(&service), before);
    let left = walk(&data.path().join("tmp"));
    assert!(left.is_empty(), "{left:?}");
    let (_, again) = ask(&service, "full", "1", &photo);
    assert_eq!(
        ended(&service, &again["id"])["state"],
        "done",
        "the service keeps running"
    );
}

/// All files below a folder.
fn walk(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap().flatten();
    let list = |path: PathBuf| if path.is_dir() { walk(&path) } else { vec![path] };
    entries.flat_map(|entry| list(entry.path())).collect()
}

fn running(service: &Service, id: &Value) {
    let path = format!("/v1/styles/trainings/{}", id.as_str().unwrap());
    let begun = Instant::now();
    while service.get(&path).1["done"] == 0 {
        assert!(begun.elapsed() < LIMIT, "{}", service.get(&path).1);
        std::thread::sleep(Duration::from_millis(100));
    }
}

/// The id of the process that trains a style of this name.
fn training_of(name: &str) -> String {
    let is_it = |command: &[u8]| {
        let arguments: Vec<_> = command.split(|&byte| byte == 0).collect();
        arguments.get(1) == Some(&&b"train"[..]) && arguments.contains(&name.as_bytes())
    };
    let entries = std::fs::read_dir("/proc").unwrap().flatten();
    let process = entries
        .filter(|entry| std::fs::read(entry.path().join("cmdline")).is_ok_and(|command| is_it(&command)))
        .find_map(|entry| entry.file_name().into_string().ok());
    process.unwrap()
}

/// Kills the process that trains a style of this name, as a machine that runs out of memory does.
fn kill_training_of(name: &str) {
    let status = std::process::Command::new("kill")
        .args(["-9", &training_of(name)])
        .status();
    assert!(status.unwrap().success());
}
