//! A malicious service cannot write outside of the folder of an export; splits keep scenes together.

use std::collections::BTreeSet;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use fathom_tests::{Service, run, scripted};
use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use tar::{EntryType, Header};

const JOB: &str = "job_0198c0ffee007000800000000000000a";
const PICTURE: &[u8] = b"not a picture, but bytes with a digest";

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn digest(bytes: &[u8]) -> String {
    Sha256::digest(bytes)
        .iter()
        .map(|byte| format!("{byte:02x}"))
        .collect()
}

/// A malicious response.
struct Lie {
    row: Value,
    archive: Vec<u8>,
}

/// An archive with one entry under any name.
fn archive(name: &str, kind: EntryType, bytes: &[u8]) -> Vec<u8> {
    let mut header = Header::new_ustar();
    header.as_old_mut().name[..name.len()].copy_from_slice(name.as_bytes());
    header.set_entry_type(kind);
    header.set_mode(0o777);
    header.set_size(bytes.len() as u64);
    if kind == EntryType::Symlink {
        header.set_link_name("/etc").expect("a name");
    }
    header.set_cksum();
    let mut archive = [header.as_bytes(), bytes].concat();
    archive.resize(archive.len().next_multiple_of(512) + 1024, 0);
    archive
}

fn honest() -> Lie {
    Lie {
        row: json!({"job": JOB, "frame": 0, "artifacts.rgb": digest(PICTURE), "alpha": 0.5}),
        archive: archive("rgb.png", EntryType::Regular, PICTURE),
    }
}

/// Serves a dataset `lies` of one image.
fn serve(lie: Lie) -> String {
    scripted::serve(move |path| {
        let columns = ["job", "frame", "artifacts.rgb", "alpha", "mask_file_name"]
            .map(|name| json!({"name": name, "kind": "text", "unit": null}));
        let dataset = json!({"name": "lies", "images": 1, "bytes": 1, "jobs": 1, "columns": columns});
        let groups = json!([{"group": {}, "metric": "frame", "count": 1}]);
        let body = match path.split('?').next() {
            Some("/v1/datasets/lies") => dataset,
            Some("/v1/datasets/lies/stats") => {
                json!({"groups": groups, "source": {"mirror": 0, "catalogue": 1}})
            }
            Some("/v1/images") => json!({"items": [lie.row], "next_cursor": null}),
            _ => return (200, lie.archive.clone()),
        };
        (200, body.to_string().into_bytes())
    })
}

/// All paths below a folder.
fn list_paths(folder: &Path) -> BTreeSet<PathBuf> {
    let mut found = BTreeSet::new();
    for entry in std::fs::read_dir(folder).expect("a readable folder") {
        let path = entry.expect("a readable folder").path();
        if path.is_dir() && !path.is_symlink() {
            found.extend(list_paths(&path));
        }
        found.insert(path);
    }
    found
}

fn export(url: &str, dataset: &str, out: &Path, more: &[&str]) -> std::process::Output {
    let out = out.to_str().expect("text");
    run(&[&["export", dataset, "--out", out, "--server", url], more].concat())
}

#[test]
fn a_lying_service_writes_nothing_outside_of_the_folder_and_no_file_with_another_name() {
    let with_row = |member: &str, value: Value| {
        let mut lie = honest();
        lie.row[member] = value;
        lie
    };
    let with_archive = |archive: Vec<u8>| Lie { archive, ..honest() };
    let lies = [
        with_row("job", json!("../../escape")),
        with_row("job", json!("/tmp/escape")),
        with_row("job", json!(format!("{JOB}/../../.."))),
        with_row("job", json!(".")),
        with_row("frame", json!("../0")),
        with_row("frame", json!(-1)),
        with_row(
            "artifacts.rgb",
            json!(format!("{}\n{}  ../escape", digest(PICTURE), digest(PICTURE))),
        ),
        with_row("artifacts.rgb", json!(digest(b"other bytes"))),
        with_archive(archive("../rgb.png", EntryType::Regular, PICTURE)),
        with_archive(archive("/tmp/rgb.png", EntryType::Regular, PICTURE)),
        with_archive(archive("rgb.sh", EntryType::Regular, PICTURE)),
        with_archive(archive("range.png", EntryType::Regular, PICTURE)),
        with_archive(archive("rgb.png", EntryType::Symlink, b"")),
        with_archive(archive("rgb.png", EntryType::Directory, b"")),
        with_archive(archive("rgb.png", EntryType::Regular, b"other bytes")),
        with_archive(archive("rgb.png", EntryType::Regular, PICTURE)[..600].to_vec()),
        with_archive(Vec::new()),
        with_archive(b"{\"not\": \"an archive\"}".to_vec()),
    ];
    for (index, lie) in lies.into_iter().enumerate() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let out = folder.path().join("a").join("out");
        let row = lie.row.clone();
        let output = export(&serve(lie), "lies", &out, &[]);
        assert_eq!(
            output.status.code(),
            Some(1),
            "lie {index} {row}: {}",
            text(&output.stderr)
        );
        let frame = out.join(JOB);
        let allowed: BTreeSet<PathBuf> = [
            folder.path().join("a"),
            out.clone(),
            out.join("export.json"),
            out.join(".metadata.jsonl.part"),
            out.join(".SHA256SUMS.part"),
            frame.clone(),
            frame.join("0"),
        ]
        .into();
        let written = list_paths(folder.path());
        assert!(written.is_subset(&allowed), "lie {index} {row}: {written:?}");
    }
    assert!(!Path::new("/tmp/escape").exists() && !Path::new("/tmp/rgb.png").exists());
}

#[test]
fn columns_of_a_service_do_not_say_where_files_are() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("out");
    let mut lie = honest();
    lie.row["file_name"] = json!("../../secret.png");
    lie.row["mask_file_name"] = json!("../../secret.png");
    let url = serve(lie);
    let output = export(&url, "lies", &out, &[]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let metadata = std::fs::read_to_string(out.join("metadata.jsonl")).expect("metadata");
    let row: Value = serde_json::from_str(&metadata).expect("one line");
    let expected = json!({"job": JOB, "frame": 0, "artifacts.rgb": digest(PICTURE), "alpha": 0.5,
        "file_name": format!("{JOB}/0/rgb.png")});
    assert_eq!(row, expected);

    // A symbolic link in the folder is not followed: its target is unchanged.
    let secret = folder.path().join("secret");
    std::fs::write(&secret, b"mine").expect("a writable folder");
    for name in ["rgb.png", "../../metadata.jsonl", "../../.SHA256SUMS.part"] {
        let path = out.join(JOB).join("0").join(name);
        // The draft does not exist.
        let _ = std::fs::remove_file(&path);
        symlink(&secret, path).expect("a link");
    }
    assert!(export(&url, "lies", &out, &[]).status.success());
    assert_eq!(std::fs::read(&secret).expect("the file"), b"mine");
    assert_eq!(
        std::fs::read(out.join(JOB).join("0/rgb.png")).expect("the file"),
        PICTURE
    );
    std::fs::remove_dir_all(out.join(JOB)).expect("a folder");
    symlink(folder.path(), out.join(JOB)).expect("a link");
    let output = export(&url, "lies", &out, &[]);
    assert_eq!(output.status.code(), Some(2), "{}", text(&output.stderr));
    assert!(!folder.path().join("0").exists(), "a link was followed");
}

#[test]
fn a_growing_dataset_keeps_its_parts_apart_by_scene() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let service = Service::start(&folder.path().join("data"), &["--workers", "1", "--slots", "2"]);
    let render = |optics: &str, scenes: u64| {
        let job = json!({"dataset": "tour", "labels": {"run": optics},
            "scene": {"kind": "procedural", "family": "structure", "seed": {"grid": (0..scenes).collect::<Vec<_>>()}},
            "camera": {"width": 32, "height": 24, "hfov_deg": 80}, "water": {"optics": optics}, "metrics": [],
            "artifacts": ["rgb", "boxes"]});
        let id = service.submit(&job);
        assert_eq!(service.finished(&id)["state"], "done");
    };
    let parts = |out: &Path| {
        let export = export(
            &service.url,
            "tour",
            out,
            &["--kinds", "rgb,boxes", "--split", "train=.5,test=.5"],
        );
        assert!(export.status.success(), "{}", text(&export.stderr));
        ["train", "test"].map(|part| {
            let folder = out.join(part);
            let metadata = std::fs::read_to_string(folder.join("metadata.jsonl")).expect("metadata");
            let rows = metadata
                .lines()
                .map(|line| serde_json::from_str::<Value>(line).expect("JSON"));
            let scene = |row: Value| {
                assert!(
                    row["labels.run"]
                        .as_str()
                        .is_some_and(|run| run.starts_with("jerlov")),
                    "{row}"
                );
                let boxes =
                    std::fs::read(folder.join(row["boxes"].as_str().expect("a path"))).expect("a file");
                assert!(
                    row["boxes"]
                        .as_str()
                        .is_some_and(|path| path.ends_with("boxes.json")),
                    "{row}"
                );
                assert!(serde_json::from_slice::<Value>(&boxes).is_ok(), "boxes are JSON");
                (
                    row["job"].to_string(),
                    row["scene.seed"].as_u64().expect("a seed"),
                )
            };
            rows.map(scene).collect::<BTreeSet<_>>()
        })
    };
    let out = folder.path().join("parts");
    render("jerlov-3C", 12);
    let [train, test] = parts(&out);
    assert_eq!(train.len() + test.len(), 12);
    render("jerlov-IB", 20);
    let [more_train, more_test] = parts(&out);
    assert_eq!(more_train.len() + more_test.len(), 32);
    assert!(
        train.is_subset(&more_train) && test.is_subset(&more_test),
        "an image changed its part"
    );
    let seeds = |part: &BTreeSet<(String, u64)>| part.iter().map(|(_, seed)| *seed).collect::<BTreeSet<_>>();
    let (train, test) = (seeds(&more_train), seeds(&more_test));
    assert!(
        train.is_disjoint(&test) && !train.is_empty() && !test.is_empty(),
        "{train:?} {test:?}"
    );
}

/// Failure: an export that follows a cursor without an end, or lists many more images than were counted.
#[test]
fn an_endless_list_ends_the_export() {
    let cursors: [fn(u64) -> Value; 2] = [|_| json!("same"), |number| json!(number.to_string())];
    for next in cursors {
        let pages = Arc::new(AtomicU64::new(0));
        let read = Arc::clone(&pages);
        let url = scripted::serve(move |path| {
            let columns = ["job", "frame", "artifacts.rgb", "alpha"]
                .map(|name| json!({"name": name, "kind": "text", "unit": null}));
            let groups = json!([{"group": {}, "metric": "frame", "count": 3}]);
            let body = match path.split('?').next() {
                Some("/v1/datasets/lies") => {
                    json!({"name": "lies", "images": 3, "bytes": 1, "jobs": 1, "columns": columns})
                }
                Some("/v1/datasets/lies/stats") => {
                    json!({"groups": groups, "source": {"mirror": 0, "catalogue": 3}})
                }
                Some("/v1/images") => {
                    let page = read.fetch_add(1, Ordering::SeqCst);
                    let rows: Vec<Value> = (0..50)
                        .map(|row| {
                            let mut image = honest().row;
                            image["frame"] = json!(page * 50 + row);
                            image
                        })
                        .collect();
                    json!({"items": rows, "next_cursor": next(page)})
                }
                _ => return (200, honest().archive),
            };
            (200, body.to_string().into_bytes())
        });
        let folder = tempfile::tempdir().expect("a temporary folder");
        let output = export(&url, "lies", &folder.path().join("out"), &[]);
        let complaint = String::from_utf8_lossy(&output.stderr);
        assert!(
            !output.status.success() && complaint.contains("check the address"),
            "{complaint}"
        );
        let read = pages.load(Ordering::SeqCst);
        assert!(read < 20, "{read} pages");
    }
}
