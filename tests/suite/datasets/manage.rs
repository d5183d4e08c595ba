//! Commands that manage a service's content, and their output to a closed pipe.

use std::path::Path;
use std::process::{Command, Output, Stdio};

use fathom_tests::{Service, fathom, muddy_photo, root, run};
use serde_json::{Value, json};

fn temporary() -> tempfile::TempDir {
    tempfile::tempdir().expect("a temporary folder")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// Runs a command against a service.
fn call(service: &Service, words: &[&str]) -> Output {
    run(&[words, &["--server", &service.url]].concat())
}

fn printed(service: &Service, words: &[&str]) -> String {
    let output = call(service, words);
    assert!(output.status.success(), "{words:?}: {}", text(&output.stderr));
    text(&output.stdout)
}

fn lines(service: &Service, words: &[&str]) -> Vec<Value> {
    let printed = printed(service, words);
    let lines = printed.lines();
    lines
        .map(|line| serde_json::from_str(line).expect("JSON lines"))
        .collect()
}

fn job(dataset: &str, count: u64) -> Value {
    json!({"dataset": dataset, "count": count, "scene": {"kind": "procedural", "family": "structure", "seed": {"int": [1, 5]}},
        "camera": {"width": 32, "height": 24, "hfov_deg": 80}, "water": {"optics": "jerlov-3C"}})
}

#[test]
fn a_job_is_listed_controlled_waited_for_and_removed() {
    let folder = temporary();
    // Without a worker nothing is rendered, and the states are fixed.
    let service = Service::start(&folder.path().join("data"), &["--workers", "0"]);
    let id = service.submit(&job("tour", 3));
    let listed = lines(&service, &["jobs", "--json", "--dataset", "tour"]);
    assert_eq!((listed.len(), &listed[0]["id"]), (1, &json!(id)), "{listed:?}");
    assert!(printed(&service, &["jobs"]).contains("0/3"));
    assert!(printed(&service, &["pause", &id]).contains("paused · 0 of 3 frames"));
    assert_eq!(lines(&service, &["jobs", "--json", "--state", "paused"]).len(), 1);
    assert_eq!(lines(&service, &["resume", &id, "--json"])[0]["state"], "queued");
    assert!(printed(&service, &["errors", &id]).contains("0 frames"));
    assert!(printed(&service, &["cancel", &id]).contains("cancelled"));
    let waited = call(&service, &["wait", &id]);
    assert_eq!(waited.status.code(), Some(1), "a cancelled job lacks frames");
    assert!(
        text(&waited.stderr).contains("cancelled with 0 of 3"),
        "{}",
        text(&waited.stderr)
    );

    let asked = call(&service, &["rm", &id]);
    assert_eq!(asked.status.code(), Some(2), "nobody can be asked");
    assert!(text(&asked.stderr).contains("--yes"), "{}", text(&asked.stderr));
    assert!(printed(&service, &["rm", &id, "--yes"]).contains(&format!("deleted job {id}")));
    assert_eq!(lines(&service, &["jobs", "--json"]).len(), 0);
}

#[test]
fn frames_that_failed_are_listed_with_reasons_and_tried_again() {
    let folder = temporary();
    let service = Service::start_with(
        &folder.path().join("data"),
        &["--workers", "1", "--slots", "1"],
        &[("FATHOM_FAULTS", "scene.nan=flag")],
    );
    let id = service.submit(&job("faults", 2));
    let waited = call(&service, &["wait", &id]);
    assert_eq!(waited.status.code(), Some(1), "{}", text(&waited.stderr));
    assert!(
        text(&waited.stderr).contains("2 of 2 frames failed"),
        "{}",
        text(&waited.stderr)
    );
    let failed = lines(&service, &["errors", &id, "--json"]);
    assert_eq!(failed.len(), 2, "{failed:?}");
    assert!(
        failed
            .iter()
            .all(|failure| failure["error"].as_str().is_some_and(|error| !error.is_empty()))
    );
    assert!(printed(&service, &["errors", &id]).contains("frame 1, given up after"));
    assert_eq!(lines(&service, &["retry", &id, "--json"])[0]["failed"], 0);
}

#[test]
fn a_dataset_is_sealed_verified_compared_and_unsealed() {
    let folder = temporary();
    let service = Service::start(&folder.path().join("data"), &["--workers", "1", "--slots", "2"]);
    let done = |job: &Value| service.finished(&service.submit(job))["id"].clone();
    let id = done(&job("tour", 4));
    let sealed = printed(&service, &["seal", "tour"]);
    assert!(sealed.starts_with("tour@1 · 4 images of 1 job"), "{sealed}");
    let root = sealed
        .lines()
        .nth(1)
        .and_then(|line| line.strip_prefix("root "))
        .expect("a root");
    let verified = printed(&service, &["verify", "tour@1", "--bytes"]);
    assert!(
        verified.contains("4 records and the bytes of 4 artifacts read"),
        "{verified}"
    );
    assert!(verified.contains(&format!("computed root {root}")), "{verified}");

    // Submitting the job again reports its existing images; another job makes the dataset grow.
    let spec = folder.path().join("job.json");
    std::fs::write(&spec, job("tour", 4).to_string()).expect("a writable folder");
    let again = call(&service, &["submit", spec.to_str().expect("text"), "--json"]);
    let told = text(&again.stderr);
    assert!(
        told.contains("has every image of this description already"),
        "{told}"
    );
    assert_eq!(
        serde_json::from_slice::<Value>(&again.stdout).expect("JSON")["id"],
        id
    );
    let _more = done(&job("tour", 6));
    assert!(printed(&service, &["seal", "tour"]).starts_with("tour@2 · 10 images of 2 jobs"));
    assert!(printed(&service, &["datasets", "tour"]).contains(root));
    assert_eq!(
        lines(&service, &["query", "--dataset", "tour@1", "--json"]).len(),
        4
    );
    let out = folder.path().join("out");
    let out = out.to_str().expect("text");
    let exported = printed(&service, &["export", "tour@1", "--kinds", "rgb", "--out", out]);
    assert!(Path::new(out).join("metadata.jsonl").is_file(), "{exported}");
    let metadata = std::fs::read_to_string(Path::new(out).join("metadata.jsonl")).expect("metadata");
    assert_eq!(metadata.lines().count(), 4);

    let beside = printed(
        &service,
        &[
            "stats",
            "tour@1",
            "tour@2",
            "--metrics",
            "uiqm",
            "--by",
            "frame:4",
        ],
    );
    let cells: Vec<Vec<&str>> = beside
        .lines()
        .skip(2)
        .map(|line| line.split_whitespace().collect())
        .collect();
    assert_eq!((cells[0][2], cells[0][6]), ("4", "8"), "{beside}");
    assert_eq!((cells[1][2], cells[1][6]), ("–", "2"), "{beside}");

    let refused = call(&service, &["rm", "tour", "--yes"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(
        text(&refused.stderr).contains("`fathom rm tour@"),
        "{}",
        text(&refused.stderr)
    );
    let unsealed = printed(&service, &["rm", "tour@1", "tour@2", "--yes"]);
    assert!(
        unsealed.contains("deleted the seal of tour@1 (its 4 images stay)"),
        "{unsealed}"
    );
    assert!(printed(&service, &["rm", "tour", "--yes"]).contains("10 images"));
    for (words, said) in [
        (&["seal", "tour@1"][..], "name of a version"),
        (
            &["verify", "tour"],
            "a set is written with a slash, such as ./tour",
        ),
        (&["verify", "tour@1"], "no sealed version `tour@1`"),
    ] {
        let output = call(&service, words);
        assert_eq!(output.status.code(), Some(2), "{words:?}");
        assert!(
            text(&output.stderr).contains(said),
            "{words:?}: {}",
            text(&output.stderr)
        );
    }
}

#[test]
fn unknown_names_exit_with_two_and_name_the_nearest() {
    let folder = temporary();
    let service = Service::start(&folder.path().join("data"), &["--workers", "0"]);
    let id = service.submit(&job("tour", 1));
    let out = folder.path().join("out");
    let out = out.to_str().expect("text");
    for words in [
        &["query", "", "--dataset", "tuor"][..],
        &["jobs", "--dataset", "tuor"],
        &["sheet", "tuor", "--out", "tuor.png"],
        &["export", "tuor", "--out", out],
        &["rm", "tuor", "--yes"],
    ] {
        let output = call(&service, words);
        let told = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{words:?}: {told}");
        assert!(told.contains("did you mean `tour`?"), "{words:?}: {told}");
    }
    for command in ["wait", "cancel", "pause", "resume", "retry", "errors"] {
        let changed = format!("{}g", &id[..id.len() - 1]);
        let output = call(&service, &[command, &changed]);
        let told = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{command}: {told}");
        assert!(
            told.contains(&format!("did you mean `{id}`?")),
            "{command}: {told}"
        );
    }
    assert!(
        !Path::new(out).exists(),
        "nothing is written for a dataset that is not there"
    );
    // The beginning of an id is enough.
    let paused = call(&service, &["pause", &id[..12]]);
    assert!(paused.status.success() && text(&paused.stdout).contains(&id[..16]));
}

#[test]
fn waters_and_styles_are_added_to_a_service_and_listed_from_it() {
    let folder = temporary();
    let service = Service::start(&folder.path().join("data"), &["--workers", "0"]);
    let water = folder.path().join("quay.json");
    let described = json!({"name": "quay-7", "source": "our transmissometer", "wavelength_nm": [650, 532, 450],
        "absorption_per_m": [0.42, 0.2, 0.5], "scattering_per_m": [1.0, 1.1, 1.3], "diffuse_attenuation_per_m": [0.6, 0.4, 0.8]});
    std::fs::write(&water, described.to_string()).expect("a writable folder");
    assert_eq!(
        printed(&service, &["waters", "add", water.to_str().expect("text")]).trim(),
        "quay-7"
    );
    let table = printed(&service, &["waters"]);
    assert!(
        table.contains("quay-7") && table.contains("0.42 0.2 0.5"),
        "{table}"
    );
    let own = text(&run(&["waters"]).stdout);
    assert!(!own.contains("quay-7") && own.contains("jerlov-3C"), "{own}");
    let again = call(&service, &["waters", "add", water.to_str().expect("text")]);
    assert_eq!(again.status.code(), Some(2), "the name is taken");

    let photo = muddy_photo(folder.path());
    let photo = photo.to_str().expect("text");
    let models = folder.path().join("models");
    let models = models.to_str().expect("text");
    let train = [
        "train",
        photo,
        "--name",
        "bay",
        "--steps",
        "1",
        "--out",
        models,
        "--licence",
        "CC0-1.0",
    ];
    let trained = printed(&service, &train);
    assert!(trained.contains("may name the style `bay`"), "{trained}");
    let (status, _) = service.post(
        "/v1/jobs/preview",
        &json!({"scene": {"kind": "procedural", "family": "structure"}, "water": {"style": "bay"}}),
    );
    assert_eq!(status, 200, "a job may name the style at once");
    let model = format!("{models}/bay.onnx");
    assert_eq!(
        printed(&service, &["styles", "add", &model, "--name", "bay-2"]).trim(),
        "bay-2"
    );
    let cards = printed(&service, &["styles", "--json"]);
    let cards: Value = serde_json::from_str(&cards).expect("JSON");
    let licence = |name: &str| {
        cards
            .as_array()
            .and_then(|all| all.iter().find(|card| card["name"] == name))?["licence"]
            .as_str()
    };
    assert_eq!(
        (licence("bay"), licence("bay-2")),
        (Some("CC0-1.0"), Some("CC0-1.0")),
        "{cards}"
    );
}

#[test]
fn a_reader_who_leaves_ends_no_command_with_a_panic() {
    let folder = temporary();
    let service = Service::start(&folder.path().join("data"), &["--workers", "1", "--slots", "1"]);
    let id = service.submit(&job("tour", 2));
    assert_eq!(service.finished(&id)["state"], "done");
    let out = folder.path().join("out");
    let pages = folder.path().join("man");
    let (out, pages) = (out.to_str().expect("text"), pages.to_str().expect("text"));
    let server = ["--server", &service.url];
    let remote: [&[&str]; 12] = [
        &["query", "", "--dataset", "tour"],
        &["query", "--json"],
        &["jobs"],
        &["jobs", "--json"],
        &["wait", &id],
        &["errors", &id],
        &["datasets"],
        &["scenes"],
        &["waters"],
        &["styles"],
        &["export", "tour", "--out", out],
        &["submit", "examples/tour.json"],
    ];
    let local: [&[&str]; 7] = [
        &["--help"],
        &["waters"],
        &["waters", "--json"],
        &["styles"],
        &["completions", "bash"],
        &["man", pages],
        &[
            "measure",
            "workers/enhance/tests/vectors/enhancement/hazed_160x120.input.png",
        ],
    ];
    let remote = remote.iter().map(|words| [words, &server[..]].concat());
    for words in remote.chain(local.iter().map(|words| words.to_vec())) {
        let mut child = Command::new(fathom())
            .args(&words)
            .current_dir(root())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the binary starts");
        drop(child.stdout.take());
        let ended = child.wait_with_output().expect("an end");
        assert!(
            ended.status.success(),
            "{words:?}: {} {}",
            ended.status,
            text(&ended.stderr)
        );
        assert!(
            !text(&ended.stderr).contains("panicked"),
            "{words:?}: {}",
            text(&ended.stderr)
        );
    }
    for page in ["fathom.1", "fathom-jobs.1"] {
        assert!(Path::new(pages).join(page).is_file(), "{page}");
    }
}

#[test]
fn the_log_has_no_colors_in_a_file_and_reads_are_no_news() {
    let folder = temporary();
    let data = folder.path().join("data");
    let mut child = Command::new(fathom())
        .args(["serve", "--listen", "127.0.0.1:0", "--workers", "0", "--data"])
        .arg(&data)
        .env_remove("FATHOM_TOKEN")
        .env("FATHOM_LOG", "info")
        .stderr(Stdio::piped())
        .spawn()
        .expect("the binary starts");
    let log = std::io::BufReader::new(child.stderr.take().expect("stderr is piped"));
    let mut log = std::io::BufRead::lines(log).map_while(Result::ok);
    let mut seen = Vec::new();
    let url = loop {
        let line = log.next().expect("the service listens");
        if let Some(url) = line.strip_prefix("fathom listens on ") {
            break url.to_owned();
        }
        seen.push(line);
    };
    let submit = ["submit", "examples/tour.json", "--server", &url];
    assert!(run(&["datasets", "--server", &url]).status.success());
    assert!(run(&submit).status.success());
    let stopped = Command::new("kill")
        .args(["-TERM", &child.id().to_string()])
        .status();
    assert!(stopped.is_ok_and(|status| status.success()));
    seen.extend(log);
    child.wait().expect("an end");
    let seen = seen.join("\n");
    assert!(!seen.contains('\u{1b}'), "{seen}");
    assert!(
        seen.contains("method=POST path=\"/v1/jobs\"") && !seen.contains("method=GET"),
        "{seen}"
    );
}
