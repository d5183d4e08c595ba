//! A running service renders the frames of damaged records again.

#![allow(clippy::unwrap_used)]

use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

use fathom_tests::{Service, audit};
use serde_json::{Value, json};

const FRAMES: u64 = 6;

/// Changes the catalogue as someone with access to the disk.
fn sabotage(data: &Path, sql: &str) {
    let script = "import sqlite3, sys\nc = sqlite3.connect(sys.argv[1], timeout=20)\nc.executescript(sys.argv[2])\nc.commit()";
    let changed = Command::new("python3")
        .args(["-c", script])
        .arg(data.join("catalogue.sqlite"))
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
    let service = Service::start(&data, &["--workers", "1", "--slots", "2"]);
    let id = service.submit(&json!({
        "dataset": "heal", "count": FRAMES, "seed": 8,
        "scene": {"kind": "procedural", "family": "structure", "seed": {"int": [0, 99]}},
        "camera": {"width": 40, "height": 26, "hfov_deg": 80},
        "water": {"optics": "jerlov-3C"}, "metrics": ["entropy"]
    }));
    assert_eq!(service.finished(&id)["state"], "done");
    let image = |frame: u64| service.get(&format!("/v1/images/{id}/{frame}"));
    let stored: Vec<Value> = (0..FRAMES).map(|frame| without_times(image(frame).1)).collect();
    sabotage(
        &data,
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
    while service.get_bytes("/readyz") != (200, b"ready\n".to_vec()) {
        let ready = service.get_bytes("/readyz").1;
        assert!(
            begun.elapsed() < Duration::from_secs(60),
            "{}",
            String::from_utf8_lossy(&ready)
        );
        std::thread::sleep(Duration::from_millis(20));
    }
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
