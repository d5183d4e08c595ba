//! Export formats with malicious, vanishing and request-counting services.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};

use fathom_tests::{run, scripted};
use imaging::{Plane, codec};
use serde_json::{Value, json};
use spec::{ArtifactEntry, FrameRecord, sha256};
use tar::Header;

const JOB: &str = "job_0198c0ffee007000800000000000000a";
const FRAMES: u64 = 6;
/// Formats written by `fathom` without another program.
const FORMATS: [&str; 10] = [
    "folder",
    "webdataset",
    "coco",
    "yolo",
    "colmap",
    "transforms",
    "mcap",
    "tum",
    "euroc",
    "kitti",
];

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// An image of the service.
#[derive(Clone)]
struct Image {
    row: Value,
    record: Value,
    /// Files by name.
    files: BTreeMap<&'static str, Vec<u8>>,
}

/// A frame with one object of 2×2 pixels in a picture of 4×3.
fn image(frame: u64) -> Image {
    let mask = Plane::from_fn(4, 3, |x, y| u16::from(x < 2 && y < 2) * 300);
    let mask = codec::encode_png(&mask.into()).expect("a picture");
    let range = Plane::from_fn(4, 3, |x, _| 2000 + 100 * x as u16);
    let range = codec::encode_png(&range.into()).expect("a picture");
    let scene = json!({
        "world_from_camera": [[1.0, 0.0, 0.0, frame as f64], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]],
        "intrinsics": {"focal_px": 3.0, "cx": 1.5, "cy": 1.0},
        "instances": [{"number": 300, "category": "pile", "box": [0, 0, 2, 2], "pixels": 4, "visible": true}],
    });
    let files: BTreeMap<&'static str, Vec<u8>> = [
        ("rgb.png", format!("picture {frame}").into_bytes()),
        ("instances.png", mask),
        ("range.png", range),
        ("boxes.json", scene.to_string().into_bytes()),
    ]
    .into();
    let artifacts = files.iter().map(|(name, bytes)| ArtifactEntry {
        kind: name.split('.').next().unwrap_or_default().to_owned(),
        digest: sha256(bytes),
        bytes: bytes.len() as u64,
        media_type: "image/png".to_owned(),
    });
    let record = FrameRecord {
        frame,
        parameters: json!({"camera": {"width": 4, "height": 3}}),
        artifacts: artifacts.collect(),
        scene: serde_json::from_value(scene).expect("a scene"),
        ..FrameRecord::default()
    };
    let mut row = json!({
        "job": JOB, "frame": frame, "digest": record.digest(), "camera.width": 4, "camera.height": 3,
        "camera.path.frames": FRAMES, "camera.path.frame": frame, "camera.frames_per_s": 25.0
    });
    for artifact in &record.artifacts {
        row[format!("artifacts.{}", artifact.kind)] = artifact.digest.clone().into();
    }
    Image {
        row,
        record: serde_json::to_value(record).expect("JSON"),
        files,
    }
}

fn images() -> Vec<Image> {
    (0..FRAMES).map(image).collect()
}

/// Number of requests per frame.
type Asked = Arc<Mutex<BTreeMap<u64, u32>>>;

/// Serves the dataset `tour` up to frame `end`.
fn serve(images: Vec<Image>, asked: Asked, end: u64) -> String {
    let columns: BTreeSet<String> = images
        .iter()
        .flat_map(|image| image.row.as_object().expect("a row").keys().cloned())
        .collect();
    let columns: Vec<Value> = columns
        .iter()
        .map(|name| json!({"name": name, "kind": "text", "unit": null}))
        .collect();
    scripted::serve(move |path| {
        let (place, query) = path.split_once('?').unwrap_or((path, ""));
        let body = match place {
            "/v1/datasets/tour" => {
                json!({"name": "tour", "images": images.len(), "bytes": 1, "jobs": 1, "columns": columns})
            }
            "/v1/datasets/tour/stats" => json!({
                "groups": [{"group": {}, "metric": "frame", "count": images.len()}],
                "source": {"mirror": 0, "catalogue": images.len()}
            }),
            // The first frame is at the second position of the path.
            "/v1/images" if query.contains("camera.path.frame%20%3D%201") => json!({"items": [{"frame": 1}]}),
            "/v1/images" => {
                json!({"items": images.iter().map(|image| &image.row).collect::<Vec<_>>(), "next_cursor": null})
            }
            _ => return frame(&images, &asked, end, place, query),
        };
        (200, body.to_string().into_bytes())
    })
}

fn frame(images: &[Image], asked: &Asked, end: u64, place: &str, query: &str) -> scripted::Reply {
    let rest = place.strip_prefix(&format!("/v1/images/{JOB}/"));
    let Some(number) = rest.and_then(|rest| rest.split('/').next()?.parse::<u64>().ok()) else {
        return (404, Vec::new());
    };
    *asked.lock().expect("a count").entry(number).or_default() += 1;
    if number >= end {
        return (500, Vec::new());
    }
    let image = &images[number as usize];
    if !place.ends_with("/artifacts") {
        return (200, image.record.to_string().into_bytes());
    }
    let mut archive = tar::Builder::new(Vec::new());
    let mut add = |name: &str, bytes: &[u8]| {
        let mut header = Header::new_ustar();
        header.set_size(bytes.len() as u64);
        header.set_mode(0o644);
        archive.append_data(&mut header, name, bytes).expect("a member");
    };
    if query.contains("record=true") {
        add("record.json", image.record.to_string().as_bytes());
    }
    for (name, bytes) in &image.files {
        let kind = name.split('.').next().unwrap_or_default();
        if query.contains(kind) {
            add(name, bytes);
        }
    }
    (200, archive.into_inner().expect("an archive"))
}

fn export(url: &str, format: &str, out: &Path) -> std::process::Output {
    let out = out.to_str().expect("text");
    let sharded: &[&str] = match format {
        "webdataset" | "parquet" => &["--shard-size", "2"],
        _ => &[],
    };
    let usual = [
        "export", "tour", "--format", format, "--out", out, "--server", url,
    ];
    run(&[&usual[..], sharded].concat())
}

fn taken(asked: &Asked) -> BTreeMap<u64, u32> {
    std::mem::take(&mut *asked.lock().expect("a count"))
}

#[test]
fn every_format_asks_for_a_frame_once_and_for_none_that_is_there() {
    let asked = Asked::default();
    let url = serve(images(), Arc::clone(&asked), FRAMES);
    for format in FORMATS {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let first = export(&url, format, folder.path());
        assert!(first.status.success(), "{format}: {}", text(&first.stderr));
        let once: BTreeMap<u64, u32> = (0..FRAMES).map(|frame| (frame, 1)).collect();
        assert_eq!(taken(&asked), once, "{format}");
        let files = read_paths(folder.path());
        let again = export(&url, format, folder.path());
        assert!(again.status.success(), "{format}: {}", text(&again.stderr));
        assert!(text(&again.stdout).contains("(0 files fetched"), "{format}");
        assert_eq!(taken(&asked), BTreeMap::new(), "{format}");
        assert_eq!(read_paths(folder.path()), files, "{format}");
    }
}

#[test]
fn an_export_whose_service_vanished_goes_on_where_it_was() {
    for format in FORMATS {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let asked = Asked::default();
        let url = serve(images(), Arc::clone(&asked), 5);
        let first = export(&url, format, folder.path());
        assert_eq!(first.status.code(), Some(3), "{format}: {}", text(&first.stderr));
        assert!(!folder.path().join("SHA256SUMS").exists(), "{format}");
        taken(&asked);
        let url = serve(images(), Arc::clone(&asked), FRAMES);
        let second = export(&url, format, folder.path());
        assert!(second.status.success(), "{format}: {}", text(&second.stderr));
        let again = taken(&asked);
        // Shards and recordings are fetched whole; other formats may have had some frames in flight.
        assert!(
            again.contains_key(&5) && (format == "mcap" || !again.contains_key(&0)),
            "{format}: {again:?}"
        );
        if format == "webdataset" {
            assert_eq!(again, [(4, 1), (5, 1)].into(), "{format}");
        }
    }
}

/// All paths below a folder with the bytes of files.
fn read_paths(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in std::fs::read_dir(folder).expect("a readable folder") {
        let path = entry.expect("a readable folder").path();
        if path.is_dir() && !path.is_symlink() {
            found.extend(read_paths(&path));
        } else {
            found.insert(path.clone(), std::fs::read(&path).unwrap_or_default());
        }
    }
    found
}

#[test]
fn a_service_that_lies_about_records_masks_and_paths_completes_no_export() {
    let changed = |change: fn(&mut Image)| {
        let mut images = images();
        change(&mut images[1]);
        images
    };
    let lies: [(&str, Vec<Image>); 11] = [
        (
            "tum",
            changed(|image| image.row["camera.frames_per_s"] = json!(-1)),
        ),
        ("mcap", changed(|image| image.record = json!([]))),
        (
            "tum",
            changed(|image| relabel(image, "range.png", b"no picture".to_vec())),
        ),
        ("webdataset", changed(|image| image.record["frame"] = json!(7))),
        ("webdataset", changed(|image| image.record = json!([]))),
        (
            "webdataset",
            changed(|image| image.row["digest"] = json!("../../escape")),
        ),
        (
            "webdataset",
            changed(|image| image.row["job"] = json!("../../escape")),
        ),
        (
            "colmap",
            changed(|image| image.row["camera.path.frames"] = json!(0)),
        ),
        ("transforms", changed(|image| image.row["frame"] = json!("../0"))),
        (
            "coco",
            changed(|image| relabel(image, "boxes.json", b"[1, 2]".to_vec())),
        ),
        (
            "coco",
            changed(|image| relabel(image, "instances.png", b"no picture".to_vec())),
        ),
    ];
    for (index, (format, images)) in lies.into_iter().enumerate() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let out = folder.path().join("a").join("out");
        let output = export(&serve(images, Asked::default(), FRAMES), format, &out);
        assert_eq!(
            output.status.code(),
            Some(1),
            "lie {index}: {}",
            text(&output.stderr)
        );
        assert!(text(&output.stderr).contains("the service sent"), "lie {index}");
        for path in read_paths(folder.path()).keys() {
            assert!(path.starts_with(&out), "lie {index}: {}", path.display());
        }
        for name in ["SHA256SUMS", "metadata.jsonl", "annotations.json"] {
            assert!(!out.join(name).exists(), "lie {index}: {name}");
        }
    }
}

/// Replaces a file of an image and its digest.
fn relabel(image: &mut Image, name: &'static str, bytes: Vec<u8>) {
    let kind = name.split('.').next().unwrap_or_default();
    image.row[format!("artifacts.{kind}")] = sha256(&bytes).into();
    image.files.insert(name, bytes);
}
