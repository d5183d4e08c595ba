//! A data folder of version 0.1 with finished, failed, cancelled, paused and waiting jobs: all are listed and served,
//! and never rendered again.

use std::fs::File;
use std::path::Path;

use fathom_tests::{Service, root, run};
use flate2::read::GzDecoder;
use serde_json::{Value, json};
use sha2::{Digest, Sha256};

const SENTENCE: &str = "the job is of version 0.1";

fn unpack(folder: &Path) {
    let packed = File::open(root().join("tests/proof/earlier/data.tar.gz")).expect("the packed folder");
    tar::Archive::new(GzDecoder::new(packed))
        .unpack(folder)
        .expect("it unpacks");
}

fn items(service: &Service, path: &str) -> Vec<Value> {
    let (status, page) = service.get(path);
    assert_eq!(status, 200, "{page}");
    page["items"].as_array().expect("a list").clone()
}

fn job_in(service: &Service, state: &str) -> String {
    let jobs = items(service, &format!("/v1/jobs?state={state}"));
    jobs[0]["id"].as_str().expect("an id").to_owned()
}

fn check_refusal((status, problem): (u16, Value), expected: u16) {
    assert_eq!(status, expected, "{problem}");
    assert!(
        problem["detail"]
            .as_str()
            .is_some_and(|detail| detail.contains(SENTENCE)),
        "{problem}"
    );
}

/// Failure: a job, an image or an artifact is not served, an artifact has other bytes, a frame of an earlier job is
/// rendered, a refusal lacks its reason, or a new job does not end.
#[test]
fn earlier_jobs_are_listed_and_served_but_not_rendered() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    unpack(folder.path());
    let service = Service::start(&folder.path().join("data"), &["--workers", "1"]);
    let jobs = items(&service, "/v1/jobs?limit=100");
    assert!(jobs.len() >= 12, "{} jobs", jobs.len());
    for job in &jobs {
        let id = job["id"].as_str().expect("an id");
        let (status, found) = service.get(&format!("/v1/jobs/{id}"));
        assert_eq!(status, 200, "{found}");
    }
    let (paused, waiting) = (job_in(&service, "paused"), job_in(&service, "queued"));
    for id in [&paused, &waiting] {
        let (_, found) = service.get(&format!("/v1/jobs/{id}"));
        assert!(found["warnings"].to_string().contains(SENTENCE), "{found}");
    }
    check_images(&service);
    check_requests(&service, &paused);

    let new = service.submit(&json!({
        "dataset": "new", "scene": {"kind": "procedural", "family": "structure"},
        "camera": {"width": 24, "height": 16}, "water": {"optics": "jerlov-1C"}
    }));
    assert_eq!(service.finished(&new)["state"], "done");
    let (_, found) = service.get(&format!("/v1/jobs/{waiting}"));
    assert_eq!(
        (&found["state"], &found["done"]),
        (&json!("queued"), &json!(0)),
        "{found}"
    );
    let (status, cancelled) = service.post(&format!("/v1/jobs/{paused}/cancel"), &json!({}));
    assert_eq!((status, &cancelled["state"]), (200, &json!("cancelled")));
}

/// Every image and artifact of the folder.
fn check_images(service: &Service) {
    let rows = items(service, "/v1/images?limit=1000");
    assert!(rows.len() > 40, "{} images", rows.len());
    for row in rows {
        let image = format!(
            "/v1/images/{}/{}",
            row["job"].as_str().expect("a job"),
            row["frame"]
        );
        let (status, record) = service.get(&image);
        assert_eq!(status, 200, "{record}");
        for artifact in record["artifacts"].as_array().expect("a list") {
            let kind = artifact["kind"].as_str().expect("a kind");
            let (status, bytes) = service.get_bytes(&format!("{image}/artifacts/{kind}"));
            let digest: String = Sha256::digest(&bytes)
                .iter()
                .map(|byte| format!("{byte:02x}"))
                .collect();
            assert_eq!(
                (status, json!(digest)),
                (200, artifact["digest"].clone()),
                "{image} {kind}"
            );
        }
    }
    let filter = "water.optics%20in%20(%22quay-7%22)%20and%20uiqm%20is%20not%20null";
    assert!(!items(service, &format!("/v1/images?filter={filter}")).is_empty());
}

/// Requests that would render a frame.
fn check_requests(service: &Service, paused: &str) {
    let failed = job_in(service, "done_with_failures");
    check_refusal(
        service.post(&format!("/v1/jobs/{paused}/resume"), &json!({})),
        409,
    );
    check_refusal(
        service.post(&format!("/v1/jobs/{failed}/retry-failed"), &json!({})),
        409,
    );
    let image = format!("/v1/images/{failed}/0/verify");
    let (status, found) = service.post(&image, &json!({}));
    assert_eq!((status, &found["intact"]), (200, &json!(true)), "{found}");
    check_refusal(service.post(&image, &json!({"rerender": true})), 422);
}

/// The pack of an earlier folder is also readable without a service.
#[test]
fn an_earlier_folder_passes_scrub() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    unpack(folder.path());
    let data = folder.path().join("data");
    let output = run(&["scrub", "--json", "--data", data.to_str().expect("text")]);
    let complaint = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{complaint}");
}
