//! A job posted over HTTP becomes stored, measured, queryable images.

use fathom_tests::{Service, run};
use serde_json::{Value, json};

fn job(dataset: &str) -> Value {
    json!({
        "dataset": dataset, "count": 6, "seed": 5,
        "scene": {"kind": "procedural", "family": "structure", "seed": {"int": [0, 99]}},
        "camera": {"width": 96, "height": 64, "hfov_deg": 80},
        "water": {"optics": {"grid": ["jerlov-IB", "jerlov-5C"]}},
        "enhance": ["hscm"], "artifacts": ["rgb", "range", "instances", "transmittance", "enhanced.hscm"],
        "labels": {"run": "first"}
    })
}

fn temporary() -> tempfile::TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

#[test]
fn a_job_becomes_images_that_can_be_asked_for_by_water_and_metric() {
    let data = temporary();
    let service = Service::start(data.path(), &["--workers", "1", "--slots", "2"]);
    let id = service.submit(&job("bay"));
    let done = service.finished(&id);
    assert_eq!(
        (done["state"].as_str(), done["done"].as_u64()),
        (Some("done"), Some(12)),
        "{done}"
    );

    let filter =
        "water.optics%20in%20(%22jerlov-5C/williamson2022%22)%20and%20labels.run%20%3D%20%22first%22";
    let (status, page) = service.get(&format!(
        "/v1/images?dataset=bay&filter={filter}&order_by=-uiqm&fields=frame,uiqm,hscm.uiqm,holes"
    ));
    assert_eq!(status, 200, "{page}");
    let rows = page["items"].as_array().expect("rows");
    assert_eq!(rows.len(), 6, "{page}");
    let uiqm: Vec<f64> = rows.iter().filter_map(|row| row["uiqm"].as_f64()).collect();
    assert!(uiqm.len() == 6 && uiqm.is_sorted_by(|a, b| a >= b), "{uiqm:?}");
    assert!(rows.iter().all(|row| row["hscm.uiqm"].is_f64()), "{page}");

    let (status, record) = service.get(&format!("/v1/images/{id}/3"));
    assert_eq!(status, 200, "{record}");
    let text = record.to_string();
    for part in [
        "plan",
        "timings_ms",
        "code_version",
        "cpu_features",
        "beam_attenuation",
        "veiling_light",
    ] {
        assert!(text.contains(part), "the record says nothing of {part}: {text}");
    }
    for (kind, magic) in [
        ("rgb", &b"\x89PNG"[..]),
        ("range", b"\x89PNG"),
        ("transmittance", b"\x93NUMPY"),
    ] {
        let (status, bytes) = service.get_bytes(&format!("/v1/images/{id}/3/artifacts/{kind}"));
        assert!(status == 200 && bytes.starts_with(magic), "{kind}: {status}");
    }
    let (status, stats) = service.get("/v1/datasets/bay/stats?metrics=uiqm&group_by=water.optics");
    assert_eq!(status, 200, "{stats}");
    assert_eq!(stats["groups"].as_array().map(Vec::len), Some(2), "{stats}");
}

#[test]
fn a_restarted_service_still_has_its_images_and_finishes_what_was_open() {
    let data = temporary();
    let mut large = job("restart");
    large["count"] = json!(40);
    let id = {
        let service = Service::start(data.path(), &["--workers", "1", "--slots", "1"]);
        let id = service.submit(&large);
        let (_, seen) = service.get(&format!("/v1/jobs/{id}?wait=20&since=1"));
        assert_ne!(seen["state"], "done", "{seen}");
        id
    };
    let service = Service::start(data.path(), &["--workers", "1", "--slots", "2"]);
    let done = service.finished(&id);
    assert_eq!(
        (done["state"].as_str(), done["done"].as_u64()),
        (Some("done"), Some(80)),
        "{done}"
    );
}

#[test]
fn ten_million_frames_are_accepted_at_once_and_cancelled() {
    let data = temporary();
    let service = Service::start(data.path(), &["--workers", "1", "--slots", "1"]);
    let mut huge = job("huge");
    huge["count"] = json!(5_000_000);
    let begun = std::time::Instant::now();
    let id = service.submit(&huge);
    assert!(
        begun.elapsed().as_secs() < 5,
        "accepting took {:?}",
        begun.elapsed()
    );
    let (status, body) = service.get(&format!("/v1/jobs/{id}"));
    assert_eq!(
        (status, body["frames"].as_u64()),
        (200, Some(10_000_000)),
        "{body}"
    );
    let (status, body) = service.post(&format!("/v1/jobs/{id}/cancel"), &json!({}));
    assert_eq!(status, 200, "{body}");
    assert_eq!(service.finished(&id)["state"], "cancelled");
}

#[test]
fn the_command_line_submits_waits_and_asks() {
    let data = temporary();
    let service = Service::start(data.path(), &["--workers", "1", "--slots", "2"]);
    let spec = data.path().join("spec.json");
    std::fs::write(&spec, job("shell").to_string()).expect("a writable folder");
    let spec = spec.to_str().expect("a path of text");
    let submitted = run(&["submit", spec, "--wait", "--server", &service.url]);
    assert!(
        submitted.status.success(),
        "{}",
        String::from_utf8_lossy(&submitted.stderr)
    );
    let asked = run(&[
        "query",
        "frame < 4",
        "--dataset",
        "shell",
        "--json",
        "--server",
        &service.url,
    ]);
    let rows = String::from_utf8(asked.stdout).expect("text");
    assert_eq!(rows.lines().count(), 4, "{rows}");
    let sheet = data.path().join("sheet.png");
    let drawn = run(&[
        "sheet",
        "shell",
        "--out",
        sheet.to_str().expect("a path of text"),
        "--server",
        &service.url,
    ]);
    assert!(
        drawn.status.success() && sheet.is_file(),
        "{}",
        String::from_utf8_lossy(&drawn.stderr)
    );
    let refused = run(&["query", "uiqn > 1", "--server", &service.url]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(
        String::from_utf8_lossy(&refused.stderr).contains("uiqm"),
        "the nearest column is named"
    );
    for (words, told) in [
        (
            ["query", "", "--order-by", "uiqmm"],
            "fathom: --order-by names the unknown column `uiqmm`",
        ),
        (
            ["query", "", "--fields", "uiqmm"],
            "fathom: --fields names the unknown column `uiqmm`",
        ),
        (
            ["stats", "shell", "--by", "uiqmm"],
            "fathom: --by names the unknown column `uiqmm`",
        ),
        (
            ["stats", "shell", "--by", "uiqm:0"],
            "fathom: --by has the width `0` for the bins of `uiqm`",
        ),
        (
            ["stats", "shell", "--metrics", "x"],
            "fathom: --metrics names the unknown column `x`",
        ),
        (
            ["stats", "shell", "--metrics", "site"],
            "fathom: --metrics names `site`, which is not a column of numbers",
        ),
    ] {
        let refused = run(&[&words[..], &["--server", &service.url]].concat());
        let complaint = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert!(
            refused.status.code() == Some(2) && complaint.starts_with(told),
            "{complaint}"
        );
        assert!(!complaint.contains("position"), "{complaint}");
    }
}

/// Failure: a dry run stores a job, hides a warning, or has no cost.
#[test]
fn a_dry_run_shows_the_cost_and_stores_nothing() {
    let data = temporary();
    let service = Service::start(data.path(), &["--workers", "0"]);
    let spec = data.path().join("spec.json");
    std::fs::write(&spec, job("shell").to_string()).expect("a writable folder");
    let spec = spec.to_str().expect("a path of text");
    let shown = run(&["submit", spec, "--dry-run", "--server", &service.url]);
    let text = String::from_utf8(shown.stdout).expect("text");
    assert!(
        shown.status.success() && text.contains("nothing was submitted"),
        "{text}"
    );
    assert!(
        text.contains("several times too low"),
        "nothing was measured: {text}"
    );
    let preview = run(&["submit", spec, "--dry-run", "--json", "--server", &service.url]);
    let preview: Value = serde_json::from_slice(&preview.stdout).expect("JSON");
    assert_eq!(preview["frames"], 12, "six of each of two waters");
    assert!(preview["estimate"]["seconds"].as_f64() > Some(0.0), "{preview}");
    assert_eq!(preview["estimate"]["measured"], false, "{preview}");
    assert_eq!(service.get("/v1/jobs").1["items"], json!([]));
    let both = run(&["submit", spec, "--dry-run", "--wait", "--server", &service.url]);
    assert_eq!(both.status.code(), Some(2));
}
