//! A running service renders the frames of damaged records and artifacts again.

#![allow(clippy::unwrap_used)]

use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use fathom_tests::{Service, audit, compile};
use serde_json::{Value, json};
use sha2::{Digest, Sha256};

const FRAMES: u64 = 6;

fn start_rendered(data: &Path) -> (Service, String) {
    let service = Service::start(data, &["--workers", "1", "--slots", "2"]);
    let id = service.submit(&json!({
        "dataset": "heal", "count": FRAMES, "seed": 8,
        "scene": {"kind": "procedural", "family": "structure", "seed": {"int": [0, 99]}},
        "camera": {"width": 40, "height": 26, "hfov_deg": 80},
        "water": {"optics": "jerlov-3C"}, "metrics": ["entropy"]
    }));
    assert_eq!(service.finished(&id)["state"], "done");
    (service, id)
}

/// Waits until no damage is known.
fn await_ready(service: &Service) {
    let begun = Instant::now();
    while service.get_bytes("/readyz") != (200, b"ready\n".to_vec()) {
        let ready = service.get_bytes("/readyz").1;
        assert!(
            begun.elapsed() < Duration::from_secs(60),
            "{}",
            String::from_utf8_lossy(&ready)
        );
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// Changes a database as someone with access to the disk.
fn sabotage(database: &Path, sql: &str) {
    let script = "import sqlite3, sys\nc = sqlite3.connect(sys.argv[1], timeout=20)\nc.executescript(sys.argv[2])\nc.commit()";
    let changed = Command::new("python3")
        .args(["-c", script])
        .arg(database)
        .arg(sql)
        .status();
    assert!(changed.is_ok_and(|status| status.success()));
}

fn without_times(mut image: Value) -> Value {
    image.as_object_mut().unwrap().remove("timings_ms");
    image
}

/// Failure: a list that fails, damage that lasts although its frame can be rendered, or a restored image that differs
/// from the stored one.
#[test]
fn frames_of_damaged_records_are_rendered_again_while_the_service_runs() {
    let folder = tempfile::tempdir().unwrap();
    let data = folder.path().join("data");
    let (service, id) = start_rendered(&data);
    let image = |frame: u64| service.get(&format!("/v1/images/{id}/{frame}"));
    let stored: Vec<Value> = (0..FRAMES).map(|frame| without_times(image(frame).1)).collect();
    sabotage(
        &data.join("catalogue.sqlite"),
        "UPDATE records SET record = replace(record, '0.', '1.') WHERE frame = 1;
         UPDATE records SET record = 'not JSON' WHERE frame = 2;
         UPDATE images SET digest = 'forged' WHERE frame = 3;
         UPDATE artifacts SET digest = 'forged' WHERE frame = 4;",
    );
    let begun = Instant::now();
    let (status, page) = service.get("/v1/images?dataset=heal");
    assert_eq!(
        (status, page["damaged"].as_array().map(Vec::len)),
        (200, Some(3)),
        "{page}"
    );
    assert_eq!(
        service.get_bytes(&format!("/v1/images/{id}/4/artifacts/rgb")).0,
        500
    );
    await_ready(&service);
    println!("four images restored after {:?}", begun.elapsed());
    for frame in 0..FRAMES {
        assert_eq!(
            without_times(image(frame).1),
            stored[frame as usize],
            "frame {frame}"
        );
        let artifact = format!("/v1/images/{id}/{frame}/artifacts/rgb");
        assert_eq!(service.get_bytes(&artifact).0, 200, "frame {frame}");
    }
    let (_, page) = service.get("/v1/images?dataset=heal");
    assert_eq!(
        page["items"].as_array().map(Vec::len),
        Some(FRAMES as usize),
        "{page}"
    );
    assert!(page.get("damaged").is_none(), "{page}");
    drop(service);
    audit(&data, &[&id], "after the restoration");
}

/// Failure: damaged bytes are served, a damaged or missing artifact stays so although its frame can be rendered, or a
/// response about it has another status.
#[test]
fn damaged_and_missing_artifacts_are_rendered_again_while_the_service_runs() {
    let folder = tempfile::tempdir().unwrap();
    let data = folder.path().join("data");
    let (service, id) = start_rendered(&data);
    let artifact =
        |service: &Service, frame: u64| service.get_bytes(&format!("/v1/images/{id}/{frame}/artifacts/rgb"));
    let stored: Vec<_> = (0..FRAMES).map(|frame| artifact(&service, frame)).collect();
    drop(service);
    let entry = |frame: usize| {
        let digest = Sha256::digest(&stored[frame].1);
        let digits: String = digest.iter().map(|byte| format!("{byte:02X}")).collect();
        format!("FROM entry WHERE hex(digest) = '{digits}'")
    };
    sabotage(
        &data.join("packs/pack-000001.sqlite"),
        &format!(
            "UPDATE data SET bytes = zeroblob(length(bytes)) WHERE id = (SELECT data {});
             UPDATE data SET bytes = x'00' WHERE id = (SELECT data {}); DELETE {};",
            entry(1),
            entry(2),
            entry(4)
        ),
    );
    let service = Service::start(&data, &["--workers", "0"]);
    for frame in [1, 2, 4] {
        assert_eq!(artifact(&service, frame).0, 500, "frame {frame}");
    }
    let begun = Instant::now();
    await_ready(&service);
    println!("three artifacts restored after {:?}", begun.elapsed());
    for frame in 0..FRAMES {
        assert_eq!(artifact(&service, frame), stored[frame as usize], "frame {frame}");
    }
    drop(service);
    audit(&data, &[&id], "after the restoration");
}

/// Failure: the read error of a disk lasts for an artifact although its frame can be rendered.
#[test]
fn an_artifact_that_the_disk_does_not_return_is_rendered_again() {
    let folder = tempfile::tempdir().unwrap();
    let data = folder.path().join("data");
    let (service, id) = start_rendered(&data);
    let path = format!("/v1/images/{id}/3/artifacts/rgb");
    let stored = service.get_bytes(&path);
    drop(service);
    let pack = data.join("packs/pack-000001.sqlite");
    let bytes = std::fs::read(&pack).unwrap();
    let at = bytes
        .windows(64)
        .position(|window| window == &stored.1[..64])
        .unwrap();
    let (library, at) = (compile("eio.c", folder.path()), (at + 32).to_string());
    let environment = [
        ("LD_PRELOAD", library.to_str().unwrap()),
        ("FATHOM_EIO_READ_FILE", pack.to_str().unwrap()),
        ("FATHOM_EIO_READ_AT", at.as_str()),
    ];
    let service = Service::start_with(&data, &["--workers", "0"], &environment);
    assert_eq!(service.get_bytes(&path).0, 500);
    await_ready(&service);
    assert_eq!(service.get_bytes(&path), stored);
}
