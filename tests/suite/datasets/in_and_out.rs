//! A user's picture becomes a scene; a dataset is exported to a folder.

use std::path::Path;
use std::process::Command;

use fathom_tests::{Service, root, run};
use serde_json::{Value, json};

fn temporary() -> tempfile::TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// A range map as written by NumPy: float32, meters, one hole.
fn range_map(width: usize, height: usize) -> Vec<u8> {
    let mut header = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({height}, {width}), }}");
    while (10 + header.len() + 1) % 64 != 0 {
        header.push(' ');
    }
    header.push('\n');
    let mut file = b"\x93NUMPY\x01\x00".to_vec();
    file.extend(u16::try_from(header.len()).expect("a short header").to_le_bytes());
    file.extend(header.as_bytes());
    for pixel in 0..width * height {
        let meters = if pixel == 5 {
            f32::NAN
        } else {
            1.0 + pixel as f32 * 1e-4
        };
        file.extend(meters.to_le_bytes());
    }
    file
}

fn export(service: &Service, out: &Path, more: &[&str]) -> String {
    let out = out.to_str().expect("text");
    let usual = [
        "export",
        "own",
        "--kinds",
        "rgb,range",
        "--out",
        out,
        "--server",
        &service.url,
    ];
    let output = run(&[&usual[..], more].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    text(&output.stdout)
}

fn rows(out: &Path) -> Vec<Value> {
    let metadata = std::fs::read_to_string(out.join("metadata.jsonl")).expect("metadata");
    metadata
        .lines()
        .map(|line| serde_json::from_str(line).expect("JSON lines"))
        .collect()
}

#[test]
fn an_uploaded_picture_becomes_a_dataset_and_the_dataset_a_folder() {
    let folder = temporary();
    let service = Service::start(&folder.path().join("data"), &["--workers", "1", "--slots", "2"]);
    let picture = root().join("workers/enhance/tests/vectors/enhancement/hazed_160x120.input.png");
    let range = folder.path().join("range.npy");
    std::fs::write(&range, range_map(160, 120)).expect("a writable folder");
    let upload = || {
        let (picture, range) = (picture.to_str().expect("text"), range.to_str().expect("text"));
        let output = run(&[
            "upload",
            picture,
            "--range",
            range,
            "--hfov-deg",
            "60",
            "--server",
            &service.url,
        ]);
        assert!(output.status.success(), "{}", text(&output.stderr));
        text(&output.stdout).trim().to_owned()
    };
    let scene = upload();
    assert_eq!(upload(), scene, "the same picture is the same scene");

    let id = service.submit(&json!({
        "dataset": "own", "scene": {"kind": "uploaded", "id": scene},
        "water": {"optics": {"grid": ["jerlov-I", "jerlov-3C", "jerlov-9C"]}},
        "artifacts": ["rgb", "range"]
    }));
    let done = service.finished(&id);
    assert_eq!(
        (done["state"].as_str(), done["done"].as_u64()),
        (Some("done"), Some(3)),
        "{done}"
    );

    let out = folder.path().join("out");
    assert!(export(&service, &out, &[]).contains("6 files fetched"));
    let all = rows(&out);
    assert_eq!(all.len(), 3);
    for row in &all {
        assert_eq!(
            (row["holes"].as_u64(), row["camera.width"].as_u64()),
            (Some(1), Some(160)),
            "{row}"
        );
        // The camera is that of the upload, not the default of a job.
        let hfov = row["camera.hfov_deg"].as_f64().expect("a number");
        assert!((hfov - 60.0).abs() < 1e-9, "{row}");
        for column in ["file_name", "range"] {
            let file = out.join(row[column].as_str().expect("a path"));
            let bytes = std::fs::read(&file).expect("a file that the metadata names");
            assert!(bytes.starts_with(b"\x89PNG"), "{}", file.display());
        }
    }
    let sums = Command::new("sha256sum")
        .args(["--check", "--quiet", "SHA256SUMS"])
        .current_dir(&out)
        .status();
    assert!(
        sums.is_ok_and(|status| status.success()),
        "the digests of the list do not hold"
    );

    // Resumed: missing and damaged files are fetched, the rest is kept.
    std::fs::remove_file(out.join(all[0]["file_name"].as_str().expect("a path"))).expect("a file");
    std::fs::write(out.join(all[1]["range"].as_str().expect("a path")), b"torn").expect("a file");
    assert!(export(&service, &out, &[]).contains("2 files fetched"));
    assert_eq!(rows(&out), all);

    let some = folder.path().join("some");
    let filter = "water.optics in (\"jerlov-9C/solonenko2015\", \"jerlov-9C/williamson2022\")";
    export(&service, &some, &["--filter", filter]);
    assert_eq!(rows(&some).len(), 1);
}

#[test]
fn a_folder_of_pictures_is_uploaded_with_what_belongs_to_them() {
    let folder = temporary();
    let service = Service::start(&folder.path().join("data"), &["--workers", "0"]);
    let pictures = folder.path().join("pictures");
    std::fs::create_dir(&pictures).expect("a writable folder");
    let vectors = root().join("workers/enhance/tests/vectors/enhancement");
    for (from, to) in [
        ("hazed_160x120.input.png", "a.png"),
        ("noise_64x64.input.png", "b.png"),
    ] {
        std::fs::copy(vectors.join(from), pictures.join(to)).expect("a vector");
    }
    std::fs::write(pictures.join("a.range.npy"), range_map(160, 120)).expect("a writable folder");
    std::fs::write(pictures.join("broken.png"), b"\x89PNG\r\n\x1a\n").expect("a writable folder");
    let upload = || {
        run(&[
            "upload",
            pictures.to_str().expect("text"),
            "--hfov-deg",
            "60",
            "--server",
            &service.url,
        ])
    };
    let output = upload();
    assert_eq!(output.status.code(), Some(2), "a broken picture must be told");
    assert!(
        text(&output.stderr).contains("broken.png"),
        "{}",
        text(&output.stderr)
    );
    let printed = text(&output.stdout);
    assert_eq!(printed.lines().count(), 2, "{printed}");
    let (_, scenes) = service.get("/v1/scenes");
    let with_range = scenes["items"]
        .as_array()
        .expect("a list")
        .iter()
        .filter(|s| !s["range_digest"].is_null())
        .count();
    assert_eq!(
        (scenes["items"].as_array().map(Vec::len), with_range),
        (Some(2), 1),
        "{scenes}"
    );
    std::fs::remove_file(pictures.join("broken.png")).expect("a file");
    let again = upload();
    assert!(
        again.status.success() && text(&again.stdout) == printed,
        "{}",
        text(&again.stderr)
    );
}

/// A gray PNG with 8 bits a pixel.
fn mask(codes: impl Fn(usize, usize) -> u8) -> Vec<u8> {
    let mask = imaging::Plane::from_fn(64, 64, codes);
    imaging::codec::encode_png(&mask.into()).expect("a picture")
}

#[test]
fn classes_go_from_a_folder_to_the_export_with_the_same_codes_for_every_picture() {
    let folder = temporary();
    let service = Service::start(&folder.path().join("data"), &["--workers", "1"]);
    let pictures = folder.path().join("pictures");
    std::fs::create_dir(&pictures).expect("a writable folder");
    let write =
        |name: &str, bytes: &[u8]| std::fs::write(pictures.join(name), bytes).expect("a writable folder");
    let vector = root().join("workers/enhance/tests/vectors/enhancement/noise_64x64.input.png");
    for name in ["a.png", "b.png", "c.png"] {
        std::fs::copy(&vector, pictures.join(name)).expect("a vector");
    }
    // Both cameras see one object; each of the others is visible to one.
    write("a.instances.png", &mask(|x, _| if x < 32 { 1 } else { 2 }));
    write("b.instances.png", &mask(|_, y| if y < 32 { 2 } else { 3 }));
    write("c.instances.png", &mask(|_, _| 9));
    write("c.classes.json", br#"{"9": "pile"}"#);
    let classes = folder.path().join("classes.json");
    std::fs::write(&classes, br#"{"1": "rope", "2": "pile", "3": "chain"}"#).expect("a writable folder");
    let (pictures, classes) = (pictures.to_str().expect("text"), classes.to_str().expect("text"));
    let output = run(&["upload", pictures, "--classes", classes, "--server", &service.url]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let printed = text(&output.stdout);
    let ids: Vec<&str> = printed
        .lines()
        .filter_map(|line| line.split(' ').next())
        .collect();
    assert_eq!(ids.len(), 3, "{printed}");

    let id = service.submit(&json!({
        "dataset": "own", "scene": {"kind": "uploaded", "id": {"grid": ids}}, "metrics": [],
        "artifacts": ["rgb", "semantics", "boxes"]
    }));
    assert_eq!(service.finished(&id)["state"], "done");
    let out = folder.path().join("out");
    let kinds = [
        "export",
        "own",
        "--kinds",
        "rgb,semantics,boxes",
        "--out",
        out.to_str().expect("text"),
    ];
    let output = run(&[&kinds[..], &["--server", &service.url]].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    let json_of = |path: &Path| -> Value {
        serde_json::from_slice(&std::fs::read(path).expect("a file")).expect("JSON")
    };
    let categories = json_of(&out.join("categories.json"));
    let expected =
        json!([{"id": 2, "name": "pile"}, {"id": 128, "name": "chain"}, {"id": 129, "name": "rope"}]);
    assert_eq!(categories, expected, "{}", text(&output.stderr));
    let mut seen = Vec::new();
    for row in rows(&out) {
        let boxes = json_of(&out.join(row["boxes"].as_str().expect("a path")));
        for instance in boxes["instances"].as_array().expect("a list") {
            seen.push(format!("{} {}", instance["number"], instance["category"]));
        }
    }
    seen.sort();
    assert_eq!(
        seen,
        [
            "1 \"rope\"",
            "2 \"pile\"",
            "2 \"pile\"",
            "3 \"chain\"",
            "9 \"pile\""
        ]
    );
}

#[test]
fn a_folder_becomes_a_collection_and_every_scene_of_it_frames() {
    let folder = temporary();
    let service = Service::start(&folder.path().join("data"), &["--workers", "1", "--slots", "2"]);
    let shots = folder.path().join("shots");
    std::fs::create_dir(&shots).expect("a writable folder");
    let pictures = ["hazed_160x120.input.png", "beams_160x120.input.png"];
    let vectors = root().join("workers/enhance/tests/vectors/enhancement");
    for (picture, name) in pictures.iter().zip(["berth", "crane"]) {
        std::fs::copy(vectors.join(picture), shots.join(format!("{name}.png"))).expect("a picture");
        std::fs::write(shots.join(format!("{name}.range.npy")), range_map(160, 120)).expect("a range");
    }
    let call = |words: &[&str]| {
        let output = run(&[words, &["--server", &service.url]].concat());
        (output.status.code(), text(&output.stdout), text(&output.stderr))
    };
    let shots = shots.to_str().expect("text");
    let (status, ids, told) = call(&["upload", shots, "--collection", "dock"]);
    assert_eq!(status, Some(0), "{told}");
    assert_eq!(call(&["list", "collections"]).1, "dock\n");
    let members = call(&["scenes", "--collection", "dock"]).1;
    let listed: Vec<&str> = members.lines().skip(2).take(2).collect();
    for ((line, uploaded), name) in listed.iter().zip(ids.lines()).zip(["berth", "crane"]) {
        assert!(
            line.starts_with(&uploaded[..36]) && line.ends_with(name),
            "{members}"
        );
    }
    let (status, _, told) = call(&["scenes", "--collection", "dok"]);
    assert_eq!(status, Some(2));
    assert!(
        told.contains("no collection `dok` (did you mean `dock`?)"),
        "{told}"
    );

    let job = folder.path().join("job.json");
    let described = json!({"dataset": "dock", "count": 2, "scene": {"kind": "collection", "name": "dock", "each": true},
        "water": {"optics": "jerlov-3C", "style": "muddy"}, "artifacts": ["rgb", "range"], "alpha": {"uniform": [0, 1]}});
    std::fs::write(&job, described.to_string()).expect("a writable folder");
    let job = job.to_str().expect("text");
    let (status, printed, told) = call(&["submit", job, "--wait"]);
    assert_eq!(status, Some(0), "{told}");
    assert!(printed.contains("done · 4 of 4 frames"), "{printed}");
    let (_, rows, _) = call(&[
        "query",
        "scene.name = 'dock'",
        "--fields",
        "frame,scene.id,scene.name",
        "--order-by",
        "frame",
        "--json",
    ]);
    let rows: Vec<Value> = rows
        .lines()
        .map(|line| serde_json::from_str(line).expect("JSON lines"))
        .collect();
    let scenes: Vec<&str> = rows
        .iter()
        .map(|row| row["scene.id"].as_str().expect("an id"))
        .collect();
    let ids: Vec<&str> = ids.lines().map(|line| &line[..36]).collect();
    assert_eq!(scenes, [ids[0], ids[1], ids[0], ids[1]]);

    // Without a service there is no collection; and a scene in use stays.
    let local = run(&[
        "render",
        job,
        "--out",
        folder.path().join("out").to_str().expect("text"),
    ]);
    assert_eq!(local.status.code(), Some(2));
    assert!(
        text(&local.stderr).contains("needs a service"),
        "{}",
        text(&local.stderr)
    );
    let (status, _, told) = call(&["rm", ids[0], "--yes"]);
    assert_eq!(status, Some(2));
    assert!(told.contains("is used by job job_"), "{told}");
    assert_eq!(call(&["rm", "dock", "--yes"]).0, Some(0));
    let (_, printed, _) = call(&["rm", ids[0], "--yes", "--collection", "dock"]);
    assert!(
        printed.contains(&format!("deleted scene {}", ids[0])),
        "{printed}"
    );
    assert!(
        printed.contains("deleted collection dock (its 2 scenes stay)"),
        "{printed}"
    );
    assert_eq!(call(&["scenes", "--json"]).1.lines().count(), 1);
}
