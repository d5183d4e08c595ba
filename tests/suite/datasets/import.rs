//! Sets rendered without a service and shown by one: no data is copied, and the store is not trusted. The comment above
//! each test defines failure.

use std::fs;
use std::path::Path;
use std::process::Output;

use crate::datasets::sets::{Work, files, marker, text};
use fathom_tests::{Service, run};
use serde_json::{Value, json};

const KINDS: [&str; 3] = ["rgb", "range", "enhanced.hscm"];

/// Failure: the rows of a set lack the artifacts or metrics of one of the job's sites, so that its shards are refused.
#[test]
fn a_set_of_several_sites_is_imported() {
    let sites = json!([{"name": "near", "artifacts": ["rgb"]},
                       {"name": "far", "artifacts": ["rgb", "range"], "enhance": ["clahe"], "water": {"optics": "jerlov-3C"}}]);
    let work = Work::new(&json!({
        "dataset": "sites", "count": 8, "seed": 2, "site": {"choice": sites}, "metrics": ["entropy"],
        "scene": {"kind": "procedural", "family": "structure", "seed": 1}, "camera": {"width": 48, "height": 32}
    }));
    assert!(work.render(&[]).status.success());
    let row = imported(&work);
    assert_eq!((&row["state"], &row["done"]), (&json!("done"), &json!(8)));
    let sealed = run_on(&work, "seal", &[]);
    assert!(sealed.status.success(), "{}", text(&sealed.stderr));
}

/// Failure: a service over an imported set responds differently from one that has rendered the same job.
#[test]
fn an_imported_set_is_shown_as_if_the_service_had_rendered_it() {
    let work = Work::new(&job(30));
    let parts: Vec<_> = ["0/2", "1/2"]
        .map(|part| work.start(&["--shard", part, "--frames-per-shard", "7"], &[]))
        .into();
    for part in parts {
        let output = part.wait_with_output().expect("a child ends");
        assert!(output.status.success(), "{}", text(&output.stderr));
    }
    let before = content(&work.set());
    let row = imported(&work);
    assert_eq!(
        (&row["state"], &row["done"], &row["failed"]),
        (&json!("done"), &json!(30), &json!(0))
    );
    let importing = Service::start(&data(&work), &["--workers", "0"]);
    let rendering = Service::start(&work.folder().join("other"), &["--workers", "1", "--slots", "2"]);
    let remote = row["id"].as_str().expect("an id").to_owned();
    let current = rendering.submit(&job(30));
    let expected = rendering.finished(&current);
    for field in ["digest", "bytes", "dataset", "frames", "state"] {
        assert_eq!(row[field], expected[field], "{field}");
    }
    assert_eq!(row["set"], json!(work.set().canonicalize().expect("a set")));
    assert_eq!(importing.get(&format!("/v1/jobs/{remote}")).1, row);
    for path in QUESTIONS {
        let (status, expected) = rendering.get_bytes(&path.replace("JOB", &current));
        assert_eq!(status, 200, "{path}: {}", text(&expected));
        let (_, shown) = importing.get_bytes(&path.replace("JOB", &remote));
        assert_eq!(text(&shown).replace(&remote, &current), text(&expected), "{path}");
    }
    for frame in 0..30 {
        for kind in KINDS {
            let path = |job: &str| format!("/v1/images/{job}/{frame}/artifacts/{kind}");
            assert_eq!(
                importing.get_bytes(&path(&remote)),
                rendering.get_bytes(&path(&current)),
                "{frame} {kind}"
            );
        }
    }
    let preview = |job: &str| format!("/v1/images/{job}/3/preview");
    assert_eq!(
        importing.get_bytes(&preview(&remote)),
        rendering.get_bytes(&preview(&current))
    );
    let (_, found) = importing.post(
        &format!("/v1/images/{remote}/5/verify"),
        &json!({"rerender": true}),
    );
    assert_eq!(
        (&found["intact"], &found["reproduced"]),
        (&json!(true), &json!(true)),
        "{found}"
    );
    let out = work.folder().join("export");
    let out = out.to_str().expect("text");
    let exported = run(&[
        "export",
        "reef",
        "--kinds",
        "rgb,range",
        "--out",
        out,
        "--server",
        &importing.url,
    ]);
    assert!(
        text(&exported.stdout).starts_with("30 images"),
        "{}",
        text(&exported.stderr)
    );
    drop(importing);
    assert!(scrub(&work).status.success());
    assert_eq!(imported(&work), row, "another import changes nothing");
    assert_eq!(content(&work.set()), before, "the set stays as it is");
}

/// Failure: a byte of a damaged artifact is served, or `verify` and `scrub` miss it.
#[test]
fn damaged_tars_are_named_and_never_served() {
    let work = Work::new(&job(12));
    assert!(work.render(&["--frames-per-shard", "4"]).status.success());
    let id = imported(&work)["id"].as_str().expect("an id").to_owned();
    let tars = files(&work.set().join("shards"));
    let mut tar = fs::read(&tars[0]).expect("a tar");
    let begins = tar
        .windows(8)
        .position(|window| window == b"\x89PNG\r\n\x1a\n")
        .expect("a picture");
    tar[begins + 30] ^= 1;
    fs::write(&tars[0], tar).expect("a writable tar");
    fs::remove_file(&tars[1]).expect("a tar");
    let service = Service::start(&data(&work), &["--workers", "0"]);
    let shown = |frame: u64, kind: &str| {
        let (status, body) = service.get_bytes(&format!("/v1/images/{id}/{frame}/artifacts/{kind}"));
        let problem: Value = serde_json::from_slice(&body).unwrap_or_default();
        (status, problem["type"].as_str().unwrap_or_default().to_owned())
    };
    let changed = (410, "/problems/set-changed".to_owned());
    let damaged: Vec<&str> = KINDS
        .into_iter()
        .filter(|kind| shown(0, kind) == changed)
        .collect();
    assert_eq!(damaged.len(), 1, "one byte is in one artifact");
    for frame in 0..12 {
        for kind in KINDS {
            let is_there = frame / 4 != 1 && (frame > 0 || kind != damaged[0]);
            assert_eq!(shown(frame, kind) == changed, !is_there, "{frame} {kind}");
            assert_eq!(shown(frame, kind).0 == 200, is_there, "{frame} {kind}");
        }
    }
    for (frame, condition) in [(0, "corrupt"), (4, "missing"), (8, "good")] {
        let (_, found) = service.post(&format!("/v1/images/{id}/{frame}/verify"), &json!({}));
        assert_eq!(found["intact"], json!(condition == "good"), "{found}");
        let artifacts = found["artifacts"].as_array().expect("a list");
        assert!(
            artifacts.iter().any(|artifact| artifact["stored"] == condition),
            "{found}"
        );
    }
    drop(service);
    let output = scrub(&work);
    let findings: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(findings["imported"], json!(12 * KINDS.len()), "{findings}");
    assert_eq!(
        findings["damaged"].as_array().map(Vec::len),
        Some(1 + 4 * KINDS.len()),
        "{findings}"
    );
}

/// Failure: finished parts are not shown while the rest is rendered, the service renders the rest, or newly rendered
/// parts are not imported.
#[test]
fn a_set_that_grows_is_imported_bit_by_bit() {
    let work = Work::new(&job(20));
    let poison = [("FATHOM_FAULTS", "frame=panic#3")];
    let output = work.start(&["--frames-per-shard", "5", "--frames", "0..10"], &poison);
    assert_eq!(
        output.wait_with_output().expect("a child ends").status.code(),
        Some(1)
    );
    let row = imported(&work);
    let id = row["id"].as_str().expect("an id").to_owned();
    let counts = |row: &Value| (row["state"].clone(), row["done"].clone(), row["failed"].clone());
    assert_eq!(counts(&row), (json!("running"), json!(9), json!(1)));
    {
        let service = Service::start(&data(&work), &["--workers", "1"]);
        let (status, failures) = service.get_bytes(&format!("/v1/jobs/{id}/errors"));
        assert!(
            status == 200 && text(&failures).contains("broken on purpose"),
            "{}",
            text(&failures)
        );
        for change in ["cancel", "pause", "retry-failed"] {
            let (status, problem) = service.post(&format!("/v1/jobs/{id}/{change}"), &json!({}));
            assert_eq!(
                (status, &problem["type"]),
                (409, &json!("/problems/job-state")),
                "{change}"
            );
        }
        std::thread::sleep(std::time::Duration::from_secs(1));
        assert_eq!(
            service.get(&format!("/v1/jobs/{id}")).1,
            row,
            "its frames are rendered elsewhere"
        );
    }
    fs::remove_file(work.set().join("done/000000.json")).expect("a marker");
    let output = work.render(&[]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(run_on(&work, "gc", &["--older", "0s"]).status.success());
    let row = imported(&work);
    assert_eq!(counts(&row), (json!("done"), json!(20), json!(0)));
    let printed = text(&output.stdout);
    assert_eq!(
        printed.lines().find_map(|line| line.strip_prefix("digest ")),
        row["digest"].as_str()
    );
    assert!(
        scrub(&work).status.success(),
        "the tar that replaced another is read"
    );
    let service = Service::start(&data(&work), &["--workers", "0"]);
    let before = content(&work.set());
    assert_eq!(service.delete(&format!("/v1/jobs/{id}")).0, 200);
    assert_eq!(service.get("/v1/datasets").1["items"], json!([]));
    drop(service);
    assert_eq!(content(&work.set()), before, "the set stays as it is");
    assert_ne!(imported(&work)["id"], row["id"], "it can be imported again");
}

/// Failure: any part of a contradictory set is imported.
#[test]
fn a_set_that_contradicts_itself_is_refused() {
    let work = Work::new(&job(8));
    assert!(work.render(&["--frames-per-shard", "8"]).status.success());
    let good = marker(&work.set(), 0);
    let path = work.set().join("done/000000.json");
    let other = "0".repeat(64);
    let marks = [
        ("/images", json!(9), "9 images"),
        ("/images", json!(u64::MAX), "images"),
        ("/shard", json!(1), "it is of shard 1"),
        ("/attempt", json!("../../../etc/passwd"), "is no attempt"),
        ("/attempt", json!("x/../y"), "is no attempt"),
        (
            "/failed",
            json!([{"frame": 8, "error": "x"}]),
            "are not the 8 frames",
        ),
        ("/digest", json!(other), "digest"),
        ("/rows/sha256", json!(other), "SHA-256"),
        ("/rows/bytes", json!(7), "its marker says 7"),
        ("/tar/bytes", json!(7), "its marker says 7"),
    ];
    for (pointer, value, part) in marks {
        let mut wrong = good.clone();
        *wrong.pointer_mut(pointer).expect("a field") = value;
        fs::write(&path, wrong.to_string()).expect("a writable marker");
        refused(&work, part);
    }
    fs::write(&path, good.to_string()).expect("a writable marker");
    let rows = files(&work.set().join("rows")).remove(0);
    let whole = fs::read(&rows).expect("rows");
    for at in [4, whole.len() / 2, whole.len() - 6] {
        let mut wrong = whole.clone();
        wrong[at] ^= 0x55;
        fs::write(&rows, &wrong).expect("writable rows");
        refused(&work, "SHA-256");
        // A marker changed consistently with it.
        let mut marker = good.clone();
        marker["rows"]["sha256"] = json!(sha256(&wrong));
        fs::write(&path, marker.to_string()).expect("a writable marker");
        let output = run_on(&work, "import", &["--json", "--data", &text_of(&data(&work))]);
        match output.status.code() {
            Some(1) => {}
            // Imports ignore this column: they build images from the records, which have a digest.
            Some(0) if at < whole.len() - 6 => {
                let printed: Value = serde_json::from_slice(&output.stdout).expect("JSON");
                assert_eq!(printed["job"]["digest"], good["digest"], "{at}");
                fs::remove_dir_all(data(&work)).expect("a data folder");
            }
            code => panic!("{at}: {code:?} {}", text(&output.stderr)),
        }
        fs::write(&path, good.to_string()).expect("a writable marker");
    }
    fs::write(&rows, whole).expect("writable rows");
    fs::write(work.set().join("done/000001.json"), good.to_string()).expect("a writable set");
    refused(&work, "belongs to no shard");
    fs::remove_file(work.set().join("done/000001.json")).expect("a marker");
    assert_eq!(imported(&work)["state"], "done");
}

fn refused(work: &Work, part: &str) {
    let output = run_on(work, "import", &["--data", &text_of(&data(work))]);
    let printed = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{part}: {printed}");
    assert!(printed.contains(part), "{part} is not in: {printed}");
    let service = Service::start(&data(work), &["--workers", "0"]);
    assert_eq!(service.get("/v1/jobs").1["items"], json!([]), "{part}");
}

/// Requests to compare, without times, which differ between machines.
const QUESTIONS: [&str; 11] = [
    "/v1/images?dataset=reef&fields=frame,job,dataset,digest,warned,alpha,uiqm,hscm.uiqm,artifacts.rgb",
    "/v1/images?filter=uiqm%20%3E%200&order_by=-uiqm&fields=frame,uiqm,water.optics,camera.hfov_deg",
    "/v1/images?filter=frame%20between%203%20and%209&order_by=alpha&fields=frame,alpha,seed,code_version",
    "/v1/images?order_by=hscm.uiqm&fields=frame,scene.seed,warned",
    "/v1/images?filter=artifacts.range%20!%3D%20%22x%22&fields=frame,artifacts.range&limit=1000",
    "/v1/datasets",
    "/v1/datasets/reef/stats?metrics=uiqm,entropy,hscm.uiqm&group_by=water.optics",
    "/v1/datasets/reef/stats?metrics=alpha",
    "/v1/datasets/reef/histogram?column=uiqm&bins=5",
    "/v1/datasets/reef/histogram?column=alpha&bins=4",
    "/v1/jobs/JOB/errors",
];

fn job(count: u64) -> Value {
    json!({
        "dataset": "reef", "count": count, "seed": 11,
        "scene": {"kind": "procedural", "family": "structure", "seed": {"int": [0, 1_000_000]}},
        "camera": {"width": 48, "height": 32, "hfov_deg": {"uniform": [60, 90]}},
        "water": {"optics": {"choice": ["jerlov-3C", "jerlov-7C"]}, "style": "muddy"}, "alpha": {"uniform": [0.2, 0.8]},
        "enhance": ["hscm"], "metrics": ["entropy", "uiqm"], "artifacts": KINDS
    })
}

fn data(work: &Work) -> std::path::PathBuf {
    work.folder().join("data")
}

fn text_of(path: &Path) -> String {
    path.to_str().expect("a path of text").to_owned()
}

fn run_on(work: &Work, command: &str, more: &[&str]) -> Output {
    work.command(command, more)
}

/// Imports the available shards; returns the job.
fn imported(work: &Work) -> Value {
    let output = run_on(work, "import", &["--json", "--data", &text_of(&data(work))]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let printed: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    printed["job"].clone()
}

fn scrub(work: &Work) -> Output {
    run(&["scrub", "--json", "--data", &text_of(&data(work))])
}

/// The digest of every file below a folder.
fn content(folder: &Path) -> Vec<(std::path::PathBuf, String)> {
    let mut found = Vec::new();
    for path in files(folder) {
        if path.is_dir() {
            found.extend(content(&path));
        } else {
            let digest = sha256(&fs::read(&path).expect("a readable file"));
            found.push((path, digest));
        }
    }
    found
}

fn sha256(bytes: &[u8]) -> String {
    use sha2::{Digest, Sha256};
    Sha256::digest(bytes)
        .iter()
        .map(|byte| format!("{byte:02x}"))
        .collect()
}
