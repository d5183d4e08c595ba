//! Data folders with missing parts, and unreferenced bytes.

use std::path::{Path, PathBuf};
use std::process::Output;

use fathom_tests::{Service, run};
use serde_json::{Value, json};

const FRAMES: u64 = 12;

fn job(dataset: &str) -> Value {
    json!({
        "dataset": dataset, "count": FRAMES, "seed": 5,
        "scene": {"kind": "procedural", "family": "structure", "seed": {"int": [0, 99]}},
        "camera": {"width": 40, "height": 24, "hfov_deg": 80},
        "water": {"optics": "jerlov-3C"}, "metrics": ["entropy"], "artifacts": ["rgb", "range"]
    })
}

fn scrub(data: &Path, more: &[&str]) -> (Output, Value) {
    let output = run(&[&["scrub", "--json", "--data", data.to_str().expect("text")], more].concat());
    let findings = serde_json::from_slice(&output.stdout).unwrap_or_default();
    (output, findings)
}

/// Record and bytes of every image of a job.
fn images(service: &Service, job: &str) -> Vec<(Value, Vec<u8>, Vec<u8>)> {
    let image = |frame: u64| {
        let path = format!("/v1/images/{job}/{frame}");
        let bytes = |kind: &str| {
            let (status, bytes) = service.get_bytes(&format!("{path}/artifacts/{kind}"));
            assert_eq!(status, 200, "{kind} of {path}");
            bytes
        };
        let (status, record) = service.get(&path);
        assert_eq!(status, 200, "{record}");
        (record, bytes("rgb"), bytes("range"))
    };
    (0..FRAMES).map(image).collect()
}

/// A folder with a finished job, and a backup of it.
fn folder(data: &Path) -> (String, PathBuf) {
    let service = Service::start(data, &["--workers", "1", "--slots", "2"]);
    let id = service.submit(&job("kept"));
    let _ = service.finished(&id);
    let (status, backup) = service.post("/v1/backups", &json!({}));
    assert_eq!(status, 201, "{backup}");
    (id, PathBuf::from(backup["folder"].as_str().expect("a folder")))
}

fn refusal(data: &Path) -> String {
    match Service::launch(data, &["--workers", "0"], &[]) {
        Ok(service) => panic!("{} serves", service.url),
        Err(printed) => printed,
    }
}

/// Failure: a service starts as if it were empty or complete; a refusal does not name the missing part and the remedy;
/// the refusal changes something.
#[test]
fn a_folder_without_its_catalogue_or_packs_is_refused() {
    let folder_of_test = tempfile::tempdir().expect("a temporary folder");
    let data = folder_of_test.path().join("data");
    let (id, _) = folder(&data);
    let catalogue = data.join("catalogue.sqlite");
    let kept = folder_of_test.path().join("kept.sqlite");
    std::fs::rename(&catalogue, &kept).expect("the catalogue");
    let printed = refusal(&data);
    assert!(
        printed.contains("catalogue.sqlite is missing") && printed.contains("--rebuild"),
        "{printed}"
    );
    assert!(!catalogue.exists(), "a new one was made");
    std::fs::write(&catalogue, b"").expect("an empty file");
    let printed = refusal(&data);
    assert!(
        printed.contains("missing or empty") && printed.contains("backup"),
        "{printed}"
    );
    // The pack of another, empty folder.
    let other = folder_of_test.path().join("other");
    drop(Service::start(&other, &["--workers", "0"]));
    std::fs::copy(other.join("catalogue.sqlite"), &catalogue).expect("a copy");
    let printed = refusal(&data);
    assert!(
        printed.contains("another catalogue") && printed.contains("--rebuild"),
        "{printed}"
    );

    std::fs::rename(&kept, &catalogue).expect("the catalogue");
    let (packs, away) = (data.join("packs"), folder_of_test.path().join("away"));
    std::fs::rename(&packs, &away).expect("the packs");
    let printed = refusal(&data);
    assert!(
        printed.contains("packs is missing or empty") && printed.contains("--rebuild"),
        "{printed}"
    );
    assert!(refusal(&data).contains("packs is missing or empty"), "only once");
    if packs.exists() {
        std::fs::remove_dir_all(&packs).expect("an empty folder");
    }
    std::fs::rename(&away, &packs).expect("the packs");
    let service = Service::start(&data, &["--workers", "0"]);
    assert_eq!(images(&service, &id).len() as u64, FRAMES);
}

/// Failure: an image has another record or other bytes than before or is lost, or a job that was open at the time of
/// the backup does not end with its digest.
#[test]
fn a_lost_catalogue_comes_from_the_last_backup_and_the_packs() {
    let folder_of_test = tempfile::tempdir().expect("a temporary folder");
    let data = folder_of_test.path().join("data");
    let (before, open, digest) = {
        let service = Service::start(&data, &["--workers", "1", "--slots", "2"]);
        let id = service.submit(&job("kept"));
        let _ = service.finished(&id);
        let open = service.submit(&json!({"dataset": "open", "count": 200, "seed": 6,
            "scene": {"kind": "procedural", "family": "structure", "seed": {"int": [0, 99]}},
            "camera": {"width": 40, "height": 24, "hfov_deg": 80}, "artifacts": ["rgb"]}));
        assert_eq!(service.post("/v1/backups", &json!({})).0, 201);
        let digest = service.finished(&open)["digest"].clone();
        ((id.clone(), images(&service, &id)), open, digest)
    };
    for file in ["catalogue.sqlite", "catalogue.sqlite-wal", "catalogue.sqlite-shm"] {
        let _ = std::fs::remove_file(data.join(file));
    }
    let (output, findings) = scrub(&data, &["--rebuild"]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(
        output.status.success() && said.contains("bak_"),
        "{findings} {said}"
    );
    let service = Service::start(&data, &["--workers", "1", "--slots", "2"]);
    assert_eq!(images(&service, &before.0), before.1);
    assert_eq!(service.finished(&open)["digest"], digest);
}

/// Failure: an image is not rendered again to its previous bytes.
#[test]
fn lost_packs_are_rendered_again() {
    let folder_of_test = tempfile::tempdir().expect("a temporary folder");
    let data = folder_of_test.path().join("data");
    let (id, _) = folder(&data);
    let before = images(&Service::start(&data, &["--workers", "0"]), &id);
    std::fs::remove_dir_all(data.join("packs")).expect("the packs");
    let (output, findings) = scrub(&data, &["--rebuild"]);
    assert!(
        output.status.success(),
        "{findings} {}",
        String::from_utf8_lossy(&output.stderr)
    );
    let service = Service::start(&data, &["--workers", "0"]);
    assert_eq!(images(&service, &id), before);
}

/// Failure: scrub does not report unreferenced bytes, repair leaves them or removes others, or a start leaves the rest
/// of a backup.
#[test]
fn space_that_nobody_uses_is_reported_and_freed() {
    let folder_of_test = tempfile::tempdir().expect("a temporary folder");
    let data = folder_of_test.path().join("data");
    // The service dies between storing bytes and the commit, and the job is deleted.
    let fault = [("FATHOM_FAULTS", "commit.begun=abort@1")];
    let mut service = Service::start_with(&data, &["--workers", "1", "--slots", "1"], &fault);
    let _ = service.try_submit(&job("gone"), "key");
    while service.is_alive() {
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    service.kill();
    let unfinished = data.join("backups/.bak_0198c0ffee");
    std::fs::create_dir_all(&unfinished).expect("a folder");
    std::fs::write(unfinished.join("catalogue.sqlite"), [7; 100_000]).expect("a file");
    {
        let service = Service::start(&data, &["--workers", "0"]);
        assert!(!unfinished.exists(), "a start leaves the rest of a backup");
        let jobs = service.get("/v1/jobs").1;
        let id = jobs["items"][0]["id"].as_str().expect("a job").to_owned();
        assert_eq!(service.delete(&format!("/v1/jobs/{id}")).0, 200);
    }
    let (output, findings) = scrub(&data, &[]);
    assert!(output.status.success(), "no damage: {findings}");
    assert!(findings["unnamed"]["blobs"].as_u64() >= Some(2), "{findings}");
    std::fs::create_dir_all(&unfinished).expect("a folder");
    std::fs::write(unfinished.join("catalogue.sqlite"), [7; 100_000]).expect("a file");
    let (output, findings) = scrub(&data, &["--repair"]);
    assert!(output.status.success() && !unfinished.exists(), "{findings}");
    assert!(
        findings["unnamed"]["freed"].as_u64() > Some(100_000),
        "{findings}"
    );
    let (_, findings) = scrub(&data, &[]);
    assert_eq!(
        (&findings["unnamed"]["blobs"], &findings["blobs"]),
        (&json!(0), &json!(0)),
        "{findings}"
    );
}
