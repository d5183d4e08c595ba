//! Hashes stored images and renders them again by the real binary.

use std::fs;

use fathom_tests::Service;
use serde_json::{Value, json};
use sha2::{Digest, Sha256};

use crate::datasets::sets::{Work, files, marker, text};

fn job(dataset: &str) -> Value {
    json!({
        "dataset": dataset, "count": 3, "seed": 5,
        "scene": {"kind": "procedural", "family": "structure", "seed": {"int": [0, 99]}},
        "camera": {"width": 96, "height": 64, "hfov_deg": 80},
        "water": {"optics": "jerlov-5C", "style": "muddy"}, "alpha": {"uniform": [0.2, 0.8]},
        "enhance": ["hscm"], "artifacts": ["rgb", "range", "transmittance", "enhanced.hscm"]
    })
}

#[test]
fn an_image_is_intact_and_renders_to_the_same_bytes() {
    let data = tempfile::tempdir().expect("a temporary folder");
    let service = Service::start(data.path(), &["--workers", "1"]);
    let id = service.submit(&job("bay"));
    assert_eq!(service.finished(&id)["state"], "done");
    let (status, quick) = service.post(&format!("/v1/images/{id}/1/verify"), &json!({}));
    assert_eq!(
        (status, &quick["intact"], &quick["reproduced"]),
        (200, &json!(true), &Value::Null),
        "{quick}"
    );
    let (status, found) = service.post(&format!("/v1/images/{id}/1/verify"), &json!({"rerender": true}));
    assert_eq!(status, 200, "{found}");
    assert_eq!(
        (&found["intact"], &found["reproduced"]),
        (&json!(true), &json!(true)),
        "{found}"
    );
    let artifacts = found["artifacts"].as_array().expect("a list");
    assert_eq!(artifacts.len(), 4);
    for artifact in artifacts {
        assert_eq!(
            (&artifact["stored"], &artifact["largest_difference"]),
            (&json!("good"), &json!(0.0)),
            "{found}"
        );
        assert_eq!(artifact["digest"], artifact["rerendered_digest"]);
    }
    assert_eq!(found["differences"], json!([]));
    let (status, _) = service.post(&format!("/v1/images/{id}/9/verify"), &json!({}));
    assert_eq!(status, 404);
    let (status, problem) = service.post(&format!("/v1/images/{id}/1/verify"), &json!({"render": true}));
    assert_eq!(
        (status, &problem["type"]),
        (400, &json!("/problems/invalid-body")),
        "{problem}"
    );
}

/// Failure: a set with valid digests counts as intact although a record or an artifact is not that of its frame.
#[test]
fn false_records_and_artifacts_of_a_set_are_found_by_rendering() {
    let mut small = job("set");
    small["count"] = json!(4);
    let work = Work::new(&small);
    let forged = [("FATHOM_FAULTS", "record.wrong=flag#2")];
    let output = work.start(&["--frames-per-shard", "2"], &forged);
    let output = output.wait_with_output().expect("a child ends");
    assert!(output.status.success(), "{}", text(&output.stderr));

    // A changed picture with a marker that agrees with it.
    let tar = files(&work.set().join("shards")).remove(0);
    let mut bytes = fs::read(&tar).expect("a tar");
    let signature = b"\x89PNG\r\n\x1a\n";
    let picture = bytes.windows(8).position(|window| window == signature);
    bytes[picture.expect("a picture") + 50] ^= 1;
    fs::write(&tar, &bytes).expect("a writable tar");
    let mut changed = marker(&work.set(), 0);
    let digest = Sha256::digest(&bytes);
    changed["tar"]["sha256"] = json!(
        digest
            .iter()
            .map(|byte| format!("{byte:02x}"))
            .collect::<String>()
    );
    fs::write(work.set().join("done/000000.json"), changed.to_string()).expect("a writable marker");

    let quick = work.command("verify", &[]);
    assert!(quick.status.success(), "{}", text(&quick.stdout));
    let found = work.command("verify", &["--render", "4"]);
    let printed = text(&found.stdout);
    assert_eq!(found.status.code(), Some(1), "{printed}");
    let named = |start: &str| printed.lines().filter(|line| line.starts_with(start)).count();
    assert_eq!(
        (
            named("frame 2: /plan/0 is missing, rendered again {"),
            named("frame 0: `")
        ),
        (1, 1),
        "{printed}"
    );
    assert_eq!(named("frame "), 2, "{printed}");
}
