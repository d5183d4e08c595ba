//! Commands without a service, and their exit status.

use fathom_tests::{root, run, run_lab};
use serde_json::{Value, json};

fn temporary() -> tempfile::TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn no_service_exits_with_three_and_says_how_to_start_one() {
    let output = run(&["query", "", "--server", "http://127.0.0.1:9"]);
    assert_eq!(output.status.code(), Some(3));
    assert!(
        text(&output.stderr).contains("fathom serve"),
        "{}",
        text(&output.stderr)
    );
}

#[test]
fn a_bad_job_exits_with_two_and_lists_every_error() {
    let folder = temporary();
    let spec = folder.path().join("bad.json");
    let bad =
        json!({"scene": {"kind": "procedural", "family": "structur", "seed": 1}, "alpha": 1.2, "cuont": 3});
    std::fs::write(&spec, bad.to_string()).expect("a writable folder");
    let out = folder.path().join("out");
    let output = run(&[
        "render",
        spec.to_str().expect("text"),
        "--out",
        out.to_str().expect("text"),
    ]);
    assert_eq!(output.status.code(), Some(2));
    let printed = text(&output.stderr);
    for part in ["/scene/family", "structure", "/alpha", "1.2", "/cuont", "count"] {
        assert!(printed.contains(part), "{part} is not in:\n{printed}");
    }
    assert!(!out.exists(), "nothing may be written for a job that is refused");
}

#[test]
fn a_missing_runtime_exits_with_four_and_everything_else_still_renders() {
    let folder = temporary();
    let spec = folder.path().join("job.json");
    let out = folder.path().join("out");
    let mut job = json!({"scene": {"kind": "procedural", "family": "structure", "seed": 1},
        "camera": {"width": 48, "height": 32, "hfov_deg": 80},
        "water": {"optics": "jerlov-3C", "style": "foreign"}});
    let styles = folder.path().join("styles");
    std::fs::create_dir(&styles).expect("a writable folder");
    std::fs::write(styles.join("foreign.onnx"), b"a network of another form").expect("a writable folder");
    let nothing = folder.path().join("no-such-library.so");
    let arguments = |out: &std::path::Path| {
        [
            "render",
            spec.to_str().expect("text"),
            "--out",
            out.to_str().expect("text"),
            "--onnxruntime",
            nothing.to_str().expect("text"),
            "--styles",
            styles.to_str().expect("text"),
        ]
        .map(str::to_owned)
    };
    let call = |out: &std::path::Path| {
        let arguments = arguments(out);
        run(&arguments.each_ref().map(String::as_str))
    };
    std::fs::write(&spec, job.to_string()).expect("a writable folder");
    let output = call(&out);
    assert_eq!(output.status.code(), Some(4), "{}", text(&output.stderr));
    assert!(
        text(&output.stderr).contains("scripts/get-onnxruntime.sh"),
        "{}",
        text(&output.stderr)
    );
    for (index, water) in [json!({"optics": "jerlov-3C"}), json!({"style": "muddy"})]
        .into_iter()
        .enumerate()
    {
        job["water"] = water;
        std::fs::write(&spec, job.to_string()).expect("a writable folder");
        let output = call(&folder.path().join(format!("out{index}")));
        assert!(output.status.success(), "{}", text(&output.stderr));
    }
}

#[test]
fn a_picture_is_enhanced_and_measured() {
    let folder = temporary();
    let input = root().join("workers/enhance/tests/vectors/enhancement/hazed_160x120.input.png");
    let input = input.to_str().expect("text");
    let output_path = folder.path().join("better.png");
    let better = output_path.to_str().expect("text");
    let output = run(&["enhance", "hscm", input, "--out", better]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("hscm: not measured against its authors' results"));
    let help = run(&["enhance", "--help"]);
    assert!(text(&help.stdout).contains("45 of the 45 results published"));
    let output = run(&["measure", input, better, "--json"]);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let rows: Vec<Value> = text(&output.stdout)
        .lines()
        .map(|line| serde_json::from_str(line).expect("JSON lines"))
        .collect();
    assert_eq!(rows.len(), 2);
    let expected =
        std::fs::read_to_string(root().join("workers/enhance/tests/vectors/enhancement/expected.json"))
            .expect("expected values");
    let expected: Value = serde_json::from_str(&expected).expect("JSON");
    let uiqm = expected["hazed_160x120"]["metrics"]["panetta"]["uiqm"]
        .as_f64()
        .expect("a number");
    let measured = rows[0]["metrics"]["uiqm"].as_f64().expect("a number");
    assert!((measured - uiqm).abs() < 1e-9, "{measured} against {uiqm}");
    let unknown = run(&["enhance", "hscn", input, "--out", better]);
    assert_eq!(unknown.status.code(), Some(2));
}

#[test]
fn the_waters_carry_their_source_and_the_styles_their_digest() {
    let waters: Value = serde_json::from_slice(&run(&["waters", "--json"]).stdout).expect("JSON");
    let names: Vec<&str> = waters
        .as_array()
        .expect("a list")
        .iter()
        .filter_map(|w| w["name"].as_str())
        .collect();
    for name in [
        "jerlov-IB/williamson2022",
        "jerlov-5C/williamson2022",
        "jerlov-9C/solonenko2015",
    ] {
        assert!(names.contains(&name), "{names:?}");
    }
    assert!(
        waters
            .as_array()
            .expect("a list")
            .iter()
            .all(|w| w["source"].as_str().is_some_and(|s| !s.is_empty()))
    );
    let styles: Value = serde_json::from_slice(&run(&["styles", "--json"]).stdout).expect("JSON");
    assert_eq!(styles.as_array().map(Vec::len), Some(4));
    assert!(
        styles
            .as_array()
            .expect("a list")
            .iter()
            .all(|s| s["sha256"].as_str().map(str::len) == Some(64))
    );
}

#[test]
fn a_wrong_experiment_gets_one_message_with_every_mistake() {
    let refused = |words: &[&str]| {
        let output = run_lab(words);
        assert_eq!(output.status.code(), Some(2), "{words:?}");
        text(&output.stderr).to_owned()
    };
    let unknown = refused(&["experiment", "chrat"]);
    assert!(
        unknown.contains("no experiment `chrat`") && unknown.contains("campaign"),
        "{unknown}"
    );
    let message = refused(&["experiment", "campaign", "--set", "frames=-1", "--set", "sed=2"]);
    assert!(
        message.contains("`frames` is -1; must be a number from 0"),
        "{message}"
    );
    assert!(message.contains("no parameter `sed`"), "{message}");
    let list = run_lab(&["experiment"]);
    assert!(list.status.success() && text(&list.stdout).contains("sites"));
}

#[test]
fn every_list_is_printed_as_a_table_and_as_json() {
    let lists = run(&["list", "--json"]);
    let lists: Vec<Value> = serde_json::from_slice(&lists.stdout).expect("JSON");
    assert!(lists.len() > 10);
    for list in &lists {
        let name = list["name"].as_str().expect("a name");
        let known = run(&["list", name, "--json", "--server", "http://127.0.0.1:9"]);
        let is_stored = ["scenes", "collections", "datasets", "jobs"].contains(&name);
        assert_eq!(known.status.code(), Some(if is_stored { 3 } else { 0 }), "{name}");
        if is_stored {
            continue;
        }
        let entries: Vec<Value> = serde_json::from_slice(&known.stdout).expect("JSON");
        let table = text(&run(&["list", name]).stdout);
        for entry in &entries {
            let entry = entry["name"].as_str().expect("a name");
            assert!(
                table.lines().any(|line| line.split("  ").next() == Some(entry)),
                "{name}: {entry}"
            );
        }
    }
    let unknown = run(&["list", "metric"]);
    assert_eq!(unknown.status.code(), Some(2));
    assert!(
        text(&unknown.stderr).contains("metrics"),
        "{}",
        text(&unknown.stderr)
    );
}

/// Failure: `--frames` renders other frames, a sharded dataset is not continued without options or is cut, or a new job goes elsewhere.
#[test]
fn frames_are_rendered_as_named_and_datasets_are_continued() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = |name: &str| folder.path().join(name).to_str().expect("text").to_owned();
    let job = run(&["new", "tank"]);
    let mut job: serde_json::Value = spec::read_json(&job.stdout).expect("a job on standard output");
    job["count"] = 6.into();
    job["camera"] = serde_json::json!({"width": 48, "height": 32});
    std::fs::write(path("job.json"), job.to_string()).expect("a writable folder");
    let render = |out: &str, options: &[&str]| {
        let usual = ["render", &path("job.json"), "--out", &path(out)].map(str::to_owned);
        let words: Vec<&str> = usual
            .iter()
            .map(String::as_str)
            .chain(options.iter().copied())
            .collect();
        run(&words)
    };
    assert!(render("plain", &["--frames", "2..4"]).status.success());
    let frames: Vec<bool> = (0..6)
        .map(|frame| folder.path().join(format!("plain/{frame}")).exists())
        .collect();
    assert_eq!(frames, [false, false, true, true, false, false]);
    for (frames, reason) in [
        ("4..9", "the job has 6 frames"),
        ("3", "--frames: `3` is not A..B"),
    ] {
        let refused = render("plain", &["--frames", frames]);
        let told = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert!(
            refused.status.code() == Some(2) && told.contains(reason),
            "{told}"
        );
    }
    assert!(render("shards", &["--shard", "0/3"]).status.success());
    let cut = render("shards", &["--frames", "1..3"]);
    assert!(String::from_utf8_lossy(&cut.stderr).contains("give 0..4"));
    let rest = render("shards", &[]);
    assert!(String::from_utf8_lossy(&rest.stdout).starts_with("2 shards with 4 frames"));
    let digest = |output: &[u8]| {
        let text = String::from_utf8_lossy(output).into_owned();
        text.lines()
            .find(|line| line.starts_with("digest"))
            .map(str::to_owned)
    };
    let whole = digest(&render("whole", &[]).stdout);
    assert!(whole.is_some() && digest(&rest.stdout) == whole);
}
