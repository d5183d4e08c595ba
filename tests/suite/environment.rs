//! A proxy in the environment, folders with another owner, a locked catalogue, and messages that name the next step.

#![allow(clippy::unwrap_used)]

use std::path::Path;
use std::process::{Command, Output, Stdio};

use fathom_tests::{Service, fathom, root, run, small_job};
use imaging::codec::{encode_npy_plane, encode_png};
use imaging::{Plane, Rgb8};
use serde_json::{Value, json};

/// An address at which nothing listens.
const PROXY: [(&str, &str); 2] = [
    ("http_proxy", "http://127.0.0.1:9"),
    ("all_proxy", "http://127.0.0.1:9"),
];

fn run_with(arguments: &[&str], environment: &[(&str, &str)]) -> Output {
    let command = Command::new(fathom())
        .args(arguments)
        .env_remove("FATHOM_TOKEN")
        .env_remove("FATHOM_SERVER")
        .envs(environment.iter().copied())
        .current_dir(root())
        .output();
    command.unwrap()
}

fn error(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

#[test]
fn a_proxy_of_the_environment_serves_no_loopback_address() {
    let data = tempfile::tempdir().unwrap();
    let service = Service::start_with(data.path(), &["--workers", "1", "--slots", "2"], &PROXY);
    let job = service.submit(&small_job("proxied"));
    assert_eq!(service.finished(&job)["state"], "done");
    let port = service.url.rsplit(':').next().unwrap();
    for server in [
        service.url.clone(),
        format!("localhost:{port}"),
        format!("127.0.0.1:{port}"),
    ] {
        let jobs = run_with(&["jobs", "--server", &server], &PROXY);
        assert!(jobs.status.success(), "{server}: {}", error(&jobs));
    }
    let away = run_with(&["jobs", "--server", "http://fathom.invalid:7311"], &PROXY);
    assert_eq!(away.status.code(), Some(3));
    assert!(
        error(&away).contains("through the proxy 127.0.0.1:9"),
        "{}",
        error(&away)
    );
    let direct = [PROXY[0], PROXY[1], ("no_proxy", "10.0.0.0/8, .invalid")];
    let direct = run_with(&["jobs", "--server", "http://fathom.invalid:7311"], &direct);
    assert!(!error(&direct).contains("proxy"), "{}", error(&direct));
    let wrong = [("http_proxy", "127.0.0.1:port")];
    let wrong = run_with(&["jobs", "--server", "http://fathom.invalid:7311"], &wrong);
    assert_eq!(wrong.status.code(), Some(2));
    assert!(
        error(&wrong).contains("the proxy `127.0.0.1:port` of the environment is not a URL"),
        "{}",
        error(&wrong)
    );
    let socks = [("ALL_PROXY", "socks5://127.0.0.1:9")];
    let socks = run_with(&["jobs", "--server", "http://fathom.invalid:7311"], &socks);
    assert_eq!(socks.status.code(), Some(2));
    assert!(error(&socks).contains("uses SOCKS"), "{}", error(&socks));
}

fn local_job(count: u64) -> Value {
    json!({"scene": {"kind": "procedural", "family": "structure", "seed": {"int": [0, 9999]}}, "camera": {"width": 64, "height": 48},
           "water": {"optics": "jerlov-3C"}, "count": count, "seed": 3, "artifacts": ["rgb"], "metrics": ["uiqm"]})
}

fn spawn_render(spec: &Path, out: &Path) -> std::process::Child {
    let command = Command::new(fathom())
        .args([
            "render",
            spec.to_str().unwrap(),
            "--out",
            out.to_str().unwrap(),
            "--slots",
            "1",
        ])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn();
    command.unwrap()
}

#[test]
fn one_of_two_renders_owns_the_folder_and_another_job_is_described() {
    let place = tempfile::tempdir().unwrap();
    let (spec, out) = (place.path().join("job.json"), place.path().join("f"));
    std::fs::write(&spec, local_job(60).to_string()).unwrap();
    let children = [spawn_render(&spec, &out), spawn_render(&spec, &out)];
    let ended = children.map(|child| child.wait_with_output().unwrap());
    let mut codes = ended.each_ref().map(|output| output.status.code());
    codes.sort_unstable();
    assert_eq!(
        codes,
        [Some(0), Some(5)],
        "{} {}",
        error(&ended[0]),
        error(&ended[1])
    );
    assert!(
        ended
            .iter()
            .any(|output| error(output).contains("another process renders into"))
    );
    let records = std::fs::read_to_string(out.join("records.jsonl")).unwrap();
    assert_eq!(records.lines().count(), 60);
    let again = spawn_render(&spec, &out).wait_with_output().unwrap();
    let first = ended.iter().find(|output| output.status.success()).unwrap();
    let digest = |output: &Output| {
        String::from_utf8_lossy(&output.stdout)
            .lines()
            .last()
            .unwrap()
            .to_owned()
    };
    assert_eq!(digest(&again), digest(first));
    std::fs::write(&spec, local_job(61).to_string()).unwrap();
    let other = spawn_render(&spec, &out).wait_with_output().unwrap();
    assert!(
        error(&other).contains("`count` is 60 there and 61 here"),
        "{}",
        error(&other)
    );
}

/// Holds the catalogue as a database browser with an unsaved change does.
const HOLD: &str = "import sqlite3, sys, time
c = sqlite3.connect(sys.argv[1], isolation_level=None)
c.execute('begin immediate')
print('held', flush=True)
time.sleep(float(sys.argv[2]))";

#[test]
fn a_catalogue_that_another_program_holds_is_reported_and_waited_for() {
    let data = tempfile::tempdir().unwrap();
    let service = Service::start(data.path(), &["--workers", "0"]);
    let catalogue = data.path().join("catalogue.sqlite");
    let mut holder = Command::new("python3")
        .args(["-c", HOLD, catalogue.to_str().unwrap(), "9"])
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut line = String::new();
    std::io::BufRead::read_line(
        &mut std::io::BufReader::new(holder.stdout.as_mut().unwrap()),
        &mut line,
    )
    .unwrap();
    assert_eq!(line.trim(), "held");
    let (status, problem) = service.post("/v1/jobs", &small_job("held"));
    assert_eq!(status, 503, "{problem}");
    assert!(
        problem["detail"]
            .as_str()
            .unwrap()
            .contains("another program holds the catalogue locked"),
        "{problem}"
    );
    let spec = data.path().join("job.json");
    std::fs::write(&spec, small_job("held").to_string()).unwrap();
    let submitted = run(&["submit", spec.to_str().unwrap(), "--server", &service.url]);
    assert!(submitted.status.success(), "{}", error(&submitted));
    holder.wait().unwrap();
}

#[test]
fn messages_name_what_the_interface_takes() {
    let place = tempfile::tempdir().unwrap();
    let service = Service::start(&place.path().join("data"), &["--workers", "0"]);
    let write = |name: &str, bytes: &[u8]| {
        let path = place.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path.display().to_string()
    };
    let job = [
        b"\xef\xbb\xbf".to_vec(),
        small_job("marked").to_string().into_bytes(),
    ]
    .concat();
    let submitted = run(&["submit", &write("bom.json", &job), "--server", &service.url]);
    assert!(submitted.status.success(), "{}", error(&submitted));
    let picture = Rgb8::from_fn(12, 8, |x, y| [(x * 20) as u8, (y * 30) as u8, 90]);
    let picture = write("base.png", &encode_png(&picture.into()).unwrap());
    let upload =
        |options: &[&str]| run(&[&["upload", &picture, "--server", &service.url][..], options].concat());
    let meters = write("depth.npy", &encode_npy_plane(&Plane::filled(12, 8, 2.0f32)));
    let refused = error(&upload(&["--z-depth", &meters]));
    assert!(
        refused.contains("--focal-px or --hfov-deg") && !refused.contains("intrinsics"),
        "{refused}"
    );
    let millimeters = write(
        "millimeters.npy",
        &encode_npy_plane(&Plane::filled(12, 8, 2345.0f32)),
    );
    let refused = error(&upload(&["--range", &millimeters]));
    assert!(refused.contains("give --unit-m"), "{refused}");
    assert!(
        upload(&["--range", &millimeters, "--unit-m", "0.001"])
            .status
            .success()
    );
    let bright = write(
        "bright.npy",
        &imaging::codec::encode_npy_rgb(&imaging::Rgb::from_fn(12, 8, |_, _| [200.0f32; 3])),
    );
    let refused = run(&["upload", &bright, "--server", &service.url]);
    assert!(error(&refused).contains("give --scale"), "{}", error(&refused));
}

#[test]
fn frames_that_nobody_can_want_are_warned_of_and_counted() {
    let place = tempfile::tempdir().unwrap();
    let picture = Rgb8::from_fn(32, 24, |x, y| [(x * 7) as u8, (y * 9) as u8, 90]);
    let (rgb, range) = (place.path().join("rgb.png"), place.path().join("range.npy"));
    std::fs::write(&rgb, encode_png(&picture.into()).unwrap()).unwrap();
    std::fs::write(&range, encode_npy_plane(&Plane::filled(32, 24, 4000.0f32))).unwrap();
    let scene = json!({"kind": "files", "rgb": rgb, "range": range});
    let job = json!({"count": 3, "scene": scene, "water": {"optics": "jerlov-3C"}, "artifacts": ["rgb"], "metrics": ["uiqm"]});
    let spec = place.path().join("job.json");
    std::fs::write(&spec, job.to_string()).unwrap();
    let out = place.path().join("out");
    let rendered = run(&["render", spec.to_str().unwrap(), "--out", out.to_str().unwrap()]);
    assert!(rendered.status.success(), "{}", error(&rendered));
    let warning = "3 of 3 frames: no pixel has a transmittance above 0.001";
    assert!(error(&rendered).contains(warning), "{}", error(&rendered));
    let service = Service::start(&place.path().join("data"), &["--workers", "1", "--slots", "2"]);
    let form: [(&str, &[u8]); 3] = [
        ("rgb", &std::fs::read(&rgb).unwrap()),
        ("range", &std::fs::read(&range).unwrap()),
        ("unit_m", b"1"),
    ];
    let (status, uploaded) = service.form("/v1/scenes", &form);
    assert_eq!(status, 201, "{uploaded}");
    let mut job = job;
    job["scene"] = json!({"kind": "uploaded", "id": uploaded["id"]});
    let id = service.submit(&job);
    assert_eq!(service.finished(&id)["state"], "done");
    let (_, warnings) = service.get(&format!("/v1/jobs/{id}/warnings"));
    assert_eq!(warnings["items"][0]["frames"], 3, "{warnings}");
    let waited = run(&["wait", &id, "--server", &service.url]);
    assert!(
        error(&waited).contains("3 of 3 frames, first 0: "),
        "{}",
        error(&waited)
    );
}
