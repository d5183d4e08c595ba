//! Styles that the service has and a worker lacks.

use crate::common::worker::Real;
use crate::common::{Running, Setup, job, start, start_on, start_with};
use serde_json::json;
use style::Library;

#[test]
fn a_worker_fetches_a_style_that_it_lacks() {
    let embedded = Library::embedded().unwrap();
    let onnx = embedded.get("muddy").unwrap().onnx.to_vec();
    let library = embedded.with_model("harbour", onnx.clone(), None).unwrap();
    let service = start_with(Setup {
        library: Some(library),
        ..Setup::default()
    });
    let mut styled = job();
    styled["water"]["style"] = json!({"grid": ["harbour", "muddy"]});
    styled["count"] = json!(1);
    // Started before the job exists, with only the shipped styles.
    let _worker = Real::start(&service);
    let id = service.submit(&styled);
    let ended = service.get(&format!("/v1/jobs/{id}?wait=60")).json();
    assert_eq!(ended["state"], "done", "{ended}");
    let digest = |frame: u64| {
        let record = service.get(&format!("/v1/images/{id}/{frame}")).json();
        record["artifacts"][0]["digest"].as_str().unwrap().to_owned()
    };
    assert_eq!(digest(0), digest(1), "the same network under two names");
    let file = service.get("/v1/worker/styles/harbour");
    assert_eq!((file.status, file.body), (200, onnx));
    service.get("/v1/worker/styles/nowhere").problem(404, "not-found");
}

/// A service whose trial accepts every network.
pub(super) fn trusting() -> Setup {
    Setup {
        program: "/bin/true",
        ..Setup::default()
    }
}

pub(super) fn muddy() -> Vec<u8> {
    Library::embedded().unwrap().get("muddy").unwrap().onnx.to_vec()
}

pub(super) fn names(service: &Running, path: &str) -> Vec<String> {
    let page = service.get(path).json();
    let cards = page["items"].as_array().unwrap().iter();
    cards
        .map(|card| card["name"].as_str().unwrap().to_owned())
        .collect()
}

#[test]
fn an_added_style_is_available_immediately_and_after_a_restart() {
    let service = start_with(trusting());
    // With only the shipped styles.
    let worker = Real::start(&service);
    let mut styled = job();
    styled["water"]["style"] = json!("harbour");
    service.post("/v1/jobs", &styled).problem(422, "validation");
    let form: &[(&str, &[u8])] = &[
        ("name", b"harbour"),
        ("model", &muddy()),
        ("licence", b"CC0-1.0"),
        ("caveat", b"made for a test"),
    ];
    let added = service.form("/v1/styles", form);
    assert_eq!(added.status, 201, "{}", added.text());
    let card = added.json();
    assert_eq!(
        (&card["name"], &card["licence"]),
        (&json!("harbour"), &json!("CC0-1.0"))
    );
    let caveats = card["caveats"].to_string();
    assert!(
        caveats.contains("stability") && caveats.contains("made for a test"),
        "{card}"
    );
    assert!(
        service.get("/v1/styles").json()["items"]
            .as_array()
            .unwrap()
            .contains(&card)
    );
    assert_eq!(service.form("/v1/styles", form).status, 200, "the same again");

    let mut done = |service: &Running, dataset: &str| {
        styled["dataset"] = json!(dataset);
        let id = service.submit(&styled);
        let ended = service.get(&format!("/v1/jobs/{id}?wait=60")).json();
        assert_eq!(ended["state"], "done", "{ended}");
    };
    done(&service, "before");
    drop(worker);
    let restarted = start_on(service.stop(), trusting());
    assert!(
        restarted.get("/v1/styles").json()["items"]
            .as_array()
            .unwrap()
            .contains(&card)
    );
    let _worker = Real::start(&restarted);
    done(&restarted, "after");
}

#[test]
fn a_name_belongs_to_one_network() {
    let service = start_with(trusting());
    let atlantic = Library::embedded()
        .unwrap()
        .get("atlantic")
        .unwrap()
        .onnx
        .to_vec();
    let add =
        |name: &str, onnx: &[u8]| service.form("/v1/styles", &[("name", name.as_bytes()), ("model", onnx)]);
    assert_eq!(add("harbour", &muddy()).status, 201);
    add("harbour", &atlantic).problem(409, "name-taken");
    add("muddy", &atlantic).problem(409, "name-taken");
    assert_eq!(add("muddy", &muddy()).status, 200, "a shipped one");
    assert_eq!(add("dock", &muddy()).status, 201, "one network under two names");
    assert_eq!(
        names(&service, "/v1/styles")
            .iter()
            .filter(|name| *name == "harbour")
            .count(),
        1
    );
}

/// Form fields, pointer of the error, part of its message.
type Refused<'a> = (&'a [(&'a str, &'a [u8])], &'a str, &'a str);

#[test]
fn a_rejected_style_leaves_no_files() {
    let service = start();
    let before = names(&service, "/v1/styles");
    let onnx = muddy();
    let refused: [Refused; 9] = [
        (
            &[("name", b"harbour"), ("model", &onnx)],
            "/model",
            "exit status: 1",
        ),
        (&[("model", &onnx)], "/name", "missing"),
        (&[("name", b"harbour")], "/model", "missing"),
        (&[("name", b"../muddy"), ("model", &onnx)], "/name", "a-z, 0-9"),
        (&[("name", b"/etc/x"), ("model", &onnx)], "/name", "a-z, 0-9"),
        (&[("name", b""), ("model", &onnx)], "/name", "1 to 64"),
        (
            &[("name", b"a"), ("name", b"b"), ("model", &onnx)],
            "/name",
            "twice",
        ),
        (
            &[("name", b"a"), ("model", &onnx), ("license", b"MIT")],
            "/license",
            "licence",
        ),
        (
            &[("name", b"a"), ("model", &onnx), ("source", &[b'x'; 5000])],
            "/source",
            "4096",
        ),
    ];
    for (form, pointer, says) in refused {
        let problem = service.form("/v1/styles", form).problem(422, "validation");
        let error = &problem["errors"][0];
        assert_eq!(error["pointer"], pointer, "{problem}");
        assert!(error["message"].as_str().unwrap().contains(says), "{problem}");
    }
    let large = vec![0; 65 << 20];
    service
        .form("/v1/styles", &[("name", b"large"), ("model", &large)])
        .problem(413, "too-large");
    assert_eq!(names(&service, "/v1/styles"), before);
    assert!(!service.folder().join("added-styles").exists());
}

#[test]
fn a_damaged_style_is_left_out_and_the_service_still_starts() {
    let service = start_with(trusting());
    for name in ["harbour", "dock"] {
        let onnx = Library::embedded().unwrap();
        let onnx = onnx
            .get(if name == "dock" { "muddy" } else { "atlantic" })
            .unwrap();
        let added = service.form("/v1/styles", &[("name", name.as_bytes()), ("model", &onnx.onnx)]);
        assert_eq!(added.status, 201);
    }
    let page = service.get("/v1/styles").json();
    let mut items = page["items"].as_array().unwrap().iter();
    let digest = items.find(|card| card["name"] == "dock").unwrap()["sha256"].clone();
    let data = service.stop();
    let folder = data.path().join("added-styles");
    let file = folder.join(format!("{}.onnx", digest.as_str().unwrap()));
    let mut bytes = std::fs::read(&file).unwrap();
    bytes[1000] ^= 1;
    std::fs::write(&file, bytes).unwrap();
    std::fs::write(folder.join(".new-abc"), b"half").unwrap();
    let service = start_on(data, trusting());
    let names = names(&service, "/v1/styles");
    assert!(
        names.contains(&"harbour".to_owned()) && !names.contains(&"dock".to_owned()),
        "{names:?}"
    );
    assert!(!folder.join(".new-abc").exists());
}

#[test]
fn a_training_that_cannot_be_taken_is_refused_by_field() {
    let service = start_with(trusting());
    let refused: [Refused; 10] = [
        (&[("photo", b"p")], "/name", "1 to 64"),
        (&[("name", b"harbour")], "/photo", "missing"),
        (&[("name", b"Big Bay"), ("photo", b"p")], "/name", "a-z, 0-9"),
        (
            &[("name", b"a"), ("photo", b"p"), ("steps", b"0")],
            "/steps",
            "1..=5000",
        ),
        (
            &[("name", b"a"), ("photo", b"p"), ("steps", b"many")],
            "/steps",
            "many",
        ),
        (&[("name", b"a"), ("photo", b"p"), ("seed", b"-1")], "/seed", "-1"),
        (
            &[("name", b"a"), ("photo", b"p"), ("step", b"9")],
            "/step",
            "steps",
        ),
        (
            &[("name", b"a"), ("photo", b"p"), ("range", b"far")],
            "/range",
            "true or false",
        ),
        (
            &[("name", b"a"), ("name", b"b"), ("photo", b"p")],
            "/name",
            "twice",
        ),
        (
            &[("name", b"a"), ("photo", b"p"), ("licence", &[b'x'; 5000])],
            "/licence",
            "4096",
        ),
    ];
    for (form, pointer, says) in refused {
        let problem = service.form("/v1/styles/train", form).problem(422, "validation");
        let error = &problem["errors"][0];
        assert_eq!(error["pointer"], pointer, "{problem}");
        assert!(error["message"].as_str().unwrap().contains(says), "{problem}");
    }
    let many = [("photo", &b"p"[..]); 9];
    let problem = service.form("/v1/styles/train", &many).problem(422, "validation");
    assert!(problem["detail"].as_str().unwrap().contains("more than 8"));
    let shipped = [("name", &b"muddy"[..]), ("photo", b"p")];
    service
        .form("/v1/styles/train", &shipped)
        .problem(409, "name-taken");
    service
        .get("/v1/styles/trainings/trn_0")
        .problem(404, "not-found");
    service
        .get("/v1/styles/trainings/trn_0?wait=61")
        .problem(400, "invalid-query");
    service
        .delete("/v1/styles/trainings/trn_0")
        .problem(404, "not-found");
    assert!(!service.folder().join("added-styles").exists());
}

/// A process that succeeds without output.
#[test]
fn a_training_without_a_result_fails_with_a_reason() {
    let service = start_with(trusting());
    let taken = service.form("/v1/styles/train", &[("name", b"harbour"), ("photo", b"p")]);
    assert_eq!(taken.status, 202, "{}", taken.text());
    let training = service
        .get(&format!("{}?wait=30", taken.header("location")))
        .json();
    assert_eq!(training["state"], "failed", "{training}");
    assert!(
        training["error"].as_str().unwrap().contains("wrote no onnx"),
        "{training}"
    );
    assert!(!names(&service, "/v1/styles").contains(&"harbour".to_owned()));
}
