//! `fathom train`: its products, and unsuitable photos.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use fathom_tests::{fathom, muddy_photo, run};
use serde_json::Value;

fn temporary() -> tempfile::TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

fn text(path: &Path) -> String {
    path.to_str().expect("text").to_owned()
}

fn train(photo: &Path, out: &Path, more: &[&str]) -> std::process::Output {
    let (photo, out) = (text(photo), text(out));
    let arguments = ["train", &photo, "--name", "harbour", "--out", &out];
    run(&[&arguments[..], more].concat())
}

fn card(out: &Path) -> Value {
    let bytes = std::fs::read(out.join("harbour.card.json")).expect("a card");
    serde_json::from_slice(&bytes).expect("JSON")
}

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).expect("a folder");
    let name = |entry: std::io::Result<std::fs::DirEntry>| {
        entry.expect("an entry").file_name().into_string().expect("text")
    };
    let mut names: Vec<String> = entries.map(name).collect();
    names.sort();
    names
}

const PRODUCTS: [&str; 3] = ["harbour.card.json", "harbour.onnx", "harbour.sheet.png"];

#[test]
fn a_photo_becomes_a_style_that_renders_without_any_library_and_the_threads_change_no_byte() {
    let folder = temporary();
    let photo = muddy_photo(folder.path());
    let outs = ["one", "four"].map(|name| folder.path().join(name));
    for (out, threads) in outs.iter().zip(["1", "4"]) {
        let output = train(
            &photo,
            out,
            &["--steps", "3", "--seed", "9", "--threads", threads],
        );
        assert!(
            output.status.success(),
            "{}",
            String::from_utf8_lossy(&output.stderr)
        );
        assert_eq!(names(out), PRODUCTS);
    }
    for product in PRODUCTS {
        let [one, four] = outs
            .each_ref()
            .map(|out| std::fs::read(out.join(product)).expect("a file"));
        assert!(one == four, "{product}");
    }
    let training = &card(&outs[0])["training"];
    assert_eq!(
        (&training["seed"], &training["kept_step"]),
        (&Value::from(9), &Value::from(3))
    );

    let job = folder.path().join("job.json");
    let spec = serde_json::json!({"scene": {"kind": "procedural", "family": "structure", "seed": 1},
        "camera": {"width": 48, "height": 32, "hfov_deg": 80}, "water": {"style": "harbour"}, "metrics": []});
    std::fs::write(&job, spec.to_string()).expect("a writable folder");
    let rendered = folder.path().join("rendered");
    let (job, rendered, styles) = (text(&job), text(&rendered), text(&outs[0]));
    let nothing = text(&folder.path().join("no-such-library.so"));
    let output = run(&[
        "render",
        &job,
        "--out",
        &rendered,
        "--styles",
        &styles,
        "--onnxruntime",
        &nothing,
    ]);
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
}

#[test]
fn photos_that_cannot_be_learned_from_are_refused_with_the_reason_and_nothing_is_written() {
    let folder = temporary();
    let encode = |picture: imaging::Rgb8| imaging::codec::encode_png(&picture.into()).expect("a picture");
    let encode_square =
        |side, pixel: fn(usize, usize) -> [u8; 3]| encode(imaging::Rgb8::from_fn(side, side, pixel));
    let cases = [
        ("black", encode_square(100, |_, _| [0; 3]), "flat"),
        ("flat", encode_square(100, |_, _| [9, 120, 180]), "flat"),
        ("dot", encode_square(1, |_, _| [9; 3]), "1×1"),
        ("text", b"not a picture".to_vec(), "picture"),
        ("nothing", Vec::new(), "picture"),
    ];
    let out = folder.path().join("out");
    for (name, bytes, part) in cases {
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).expect("a writable folder");
        let output = train(&path, &out, &["--steps", "2"]);
        let printed = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{name}: {printed}");
        assert!(printed.contains(name), "the file is named: {printed}");
        assert!(part == "picture" || printed.contains(part), "{name}: {printed}");
    }
    let photo = muddy_photo(folder.path());
    let output = run(&["train", &text(&photo), "--name", "Big Bay", "--out", &text(&out)]);
    assert_eq!(output.status.code(), Some(2));
    assert!(!out.exists());
}

#[test]
fn gray_deep_and_huge_photos_are_taken() {
    let folder = temporary();
    let deep: Vec<u16> = (0..100 * 80u32).map(|at| (at * 7919 % 65_536) as u16).collect();
    let deep = imaging::Raster::new(
        100,
        80,
        imaging::Channels::Gray,
        imaging::Samples::U16(deep),
        None,
    );
    let huge = imaging::Rgb8::from_fn(3000, 1600, |x, y| {
        [(x / 20) as u8, (y / 9) as u8, (x * y % 251) as u8]
    });
    let pictures = [
        ("deep.png", deep.expect("as many samples")),
        ("huge.png", huge.into()),
    ];
    for (name, picture) in pictures {
        let path = folder.path().join(name);
        std::fs::write(&path, imaging::codec::encode_png(&picture).expect("a picture"))
            .expect("a writable folder");
        let out = folder.path().join(format!("{name}.out"));
        let output = train(&path, &out, &["--steps", "1"]);
        assert!(
            output.status.success(),
            "{name}: {}",
            String::from_utf8_lossy(&output.stderr)
        );
        assert_eq!(names(&out), PRODUCTS);
    }
}

/// The color transfer is written before the first step; an interrupt keeps the best result so far.
#[test]
fn an_interrupted_training_leaves_whole_files_and_says_so_on_the_card() {
    let folder = temporary();
    let (photo, out) = (muddy_photo(folder.path()), folder.path().join("out"));
    let mut child = Command::new(fathom())
        .args([
            "train",
            "--no-add",
            &text(&photo),
            "--name",
            "harbour",
            "--steps",
            "100000",
            "--out",
            &text(&out),
        ])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .expect("the binary starts");
    let start = Instant::now();
    while !out.join(PRODUCTS[0]).exists() {
        assert!(
            start.elapsed() < Duration::from_secs(120),
            "the preview comes first"
        );
        std::thread::sleep(Duration::from_millis(50));
    }
    assert_eq!(card(&out)["training"]["kept_step"], 0);
    let interrupt = Command::new("kill")
        .args(["-INT", &child.id().to_string()])
        .status();
    assert!(interrupt.expect("kill runs").success());
    assert!(child.wait().expect("it ends").success());
    assert_eq!(names(&out), PRODUCTS);
    assert_eq!(card(&out)["training"]["steps"], 100_000);
}

/// A read-only folder is detected before the first step, and no partial file remains.
#[test]
fn a_full_disk_is_an_error_and_leaves_nothing_behind() {
    let folder = temporary();
    let photo = muddy_photo(folder.path());
    let out = folder.path().join("out");
    // A folder at the path of a product: its last rename fails as a full disk's write does.
    std::fs::create_dir_all(out.join("harbour.sheet.png/in-the-way")).expect("a writable folder");
    let output = train(&photo, &out, &["--steps", "2"]);
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(names(&out), ["harbour.sheet.png"]);
    // Every file may have 4 KiB, as on a disk that fills while it is written.
    let bounded = folder.path().join("bounded");
    let script = "trap '' XFSZ; ulimit -f 8; exec \"$@\"";
    let mut command = Command::new("sh");
    command
        .args(["-c", script, "sh"])
        .arg(fathom())
        .args(["train", "--no-add"])
        .arg(&photo);
    command
        .args(["--name", "harbour", "--steps", "2", "--out"])
        .arg(&bounded);
    let output = command.output().expect("a shell");
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("File too large"), "{said}");
    assert!(names(&bounded).is_empty());
    let full = Path::new("/dev/full/out");
    assert_eq!(train(&photo, full, &["--steps", "2"]).status.code(), Some(1));
}
