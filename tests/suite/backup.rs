//! A backup of a running service can be started and continues from the moment of the copy.

use std::path::PathBuf;

use fathom_tests::{Service, digest_by_render, run};
use serde_json::json;

/// Failure: scrub reports a fault in the backup, the backup lacks an image, a job does not continue or ends with
/// another digest, or the copy disturbs the service.
#[test]
fn a_backup_of_a_running_service_goes_on_from_the_moment_of_the_copy() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let job = json!({
        "dataset": "kept", "count": 120, "seed": 21,
        "scene": {"kind": "procedural", "family": "structure", "seed": {"int": [0, 99]}},
        "camera": {"width": 96, "height": 64, "hfov_deg": 80},
        "water": {"optics": "jerlov-1C"}, "artifacts": ["rgb", "range"]
    });
    let expected = digest_by_render(&job, folder.path(), "2");
    let service = Service::start(&folder.path().join("data"), &["--workers", "1", "--slots", "2"]);
    let id = service.submit(&job);
    let mut seen = service.get(&format!("/v1/jobs/{id}")).1;
    while seen["done"].as_u64() < Some(10) {
        seen = service
            .get(&format!("/v1/jobs/{id}?wait=5&since={}", seen["version"]))
            .1;
    }
    let (status, backup) = service.post("/v1/backups", &json!({}));
    assert_eq!(status, 201, "{backup}");
    let copy = PathBuf::from(backup["folder"].as_str().expect("a folder"));
    assert_eq!(
        service.finished(&id)["digest"],
        expected,
        "the copied service was disturbed"
    );
    drop(service);

    let audit = run(&["scrub", "--data", copy.to_str().expect("text"), "--json"]);
    assert!(
        audit.status.success(),
        "{}",
        String::from_utf8_lossy(&audit.stdout)
    );
    let restored = Service::start(&copy, &["--workers", "1", "--slots", "2"]);
    let (_, first) = restored.get(&format!("/v1/jobs/{id}"));
    assert!(
        first["done"].as_u64() >= seen["done"].as_u64(),
        "images were lost: {first} after {seen}"
    );
    let done = restored.finished(&id);
    assert_eq!(
        (done["state"].as_str(), done["done"].as_u64()),
        (Some("done"), Some(120)),
        "{done}"
    );
    assert_eq!(done["digest"], expected);
}
