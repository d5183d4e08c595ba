//! Stored bytes over HTTP, previews, and direct renders.

use crate::common::worker::Fake;
use crate::common::{Running, job, start};
use imaging::codec::decode_picture;
use serde_json::{Value, json};

fn finished() -> (Running, String) {
    let service = start();
    let id = service.submit(&job());
    Fake::register(&service).work();
    (service, id)
}

#[test]
fn an_artifact_carries_its_digest_and_copies_are_recognized() {
    let (service, id) = finished();
    let path = format!("/v1/images/{id}/0/artifacts/rgb");
    let whole = service.get(&path);
    assert_eq!((whole.status, whole.header("content-type")), (200, "image/png"));
    assert!(whole.header("cache-control").contains("immutable"));
    let record = service.get(&format!("/v1/images/{id}/0")).json();
    assert_eq!(
        whole.header("etag"),
        format!("\"{}\"", record["artifacts"][0]["digest"].as_str().unwrap())
    );
    let copy = service.get_with(&path, &[("if-none-match", whole.header("etag"))]);
    assert_eq!((copy.status, copy.body.len()), (304, 0));

    let part = service.get_with(&path, &[("range", "bytes=1-3")]);
    assert_eq!((part.status, part.body.as_slice()), (206, &b"PNG"[..]));
    assert_eq!(
        part.header("content-range"),
        format!("bytes 1-3/{}", whole.body.len())
    );
    let beyond = service.get_with(&path, &[("range", "bytes=99999999-")]);
    beyond.problem(416, "range-not-satisfiable");
    assert_eq!(
        beyond.header("content-range"),
        format!("bytes */{}", whole.body.len())
    );
    service
        .get(&format!("/v1/images/{id}/0/artifacts/range"))
        .problem(404, "not-found");
}

#[test]
fn a_preview_is_a_png_that_fits() {
    let (service, id) = finished();
    let preview = service.get(&format!("/v1/images/{id}/0/preview"));
    assert_eq!(
        (preview.status, preview.header("content-type")),
        (200, "image/png")
    );
    let picture = decode_picture(&preview.body).unwrap();
    assert!(picture.width() <= 256 && picture.height() <= 256);
}

fn single_frame() -> Value {
    let mut one = job();
    one["count"] = json!(1);
    one.as_object_mut().unwrap().remove("dataset");
    one
}

#[test]
fn a_render_returns_the_image_or_the_record() {
    let service = start();
    let worker = Fake::register(&service);
    let json = ("content-type", "application/json");
    std::thread::scope(|scope| {
        scope.spawn(|| {
            for _ in 0..2 {
                let lease = worker.lease(60_000).expect("a frame");
                worker.finish(&lease).unwrap();
            }
        });
        let body = single_frame().to_string();
        let picture = service.post_with("/v1/renders", &[json, ("accept", "image/png")], body.as_bytes());
        assert_eq!(
            (picture.status, picture.header("content-type")),
            (200, "image/png"),
            "{}",
            picture.text()
        );
        assert!(decode_picture(&picture.body).is_ok());
        let record = service.post_with("/v1/renders", &[json], body.as_bytes());
        assert_eq!(
            (record.status, &record.json()["dataset"]),
            (200, &json!("renders")),
            "{}",
            record.text()
        );
        assert_eq!(
            (
                record.header("content-location"),
                picture.header("content-location")
            ),
            ("", "")
        );
    });
    assert_eq!(
        service.get("/v1/jobs").json()["items"],
        json!([]),
        "a render left its job"
    );
}

#[test]
fn a_render_with_a_dataset_or_a_key_is_kept() {
    let service = start();
    let worker = Fake::register(&service);
    let json = ("content-type", "application/json");
    let mut named = single_frame();
    named["dataset"] = json!("keep");
    std::thread::scope(|scope| {
        scope.spawn(|| {
            for _ in 0..2 {
                let lease = worker.lease(60_000).expect("a frame");
                worker.finish(&lease).unwrap();
            }
        });
        let key = ("idempotency-key", "once");
        let kept = service.post_with("/v1/renders", &[json], named.to_string().as_bytes());
        let keyed = service.post_with("/v1/renders", &[json, key], single_frame().to_string().as_bytes());
        for (answer, dataset) in [(kept, "keep"), (keyed, "renders")] {
            assert_eq!(answer.status, 200, "{}", answer.text());
            let image = service.get(answer.header("content-location"));
            assert_eq!(
                (image.status, &image.json()["dataset"]),
                (200, &json!(dataset)),
                "{}",
                image.text()
            );
        }
        let again = service.post_with("/v1/renders", &[json, key], single_frame().to_string().as_bytes());
        assert_eq!(again.status, 200, "the key finds the job that is there");
    });
}

#[test]
fn artifacts_of_an_image_come_in_one_archive() {
    let service = start();
    let worker = Fake::register(&service);
    let id = service.submit(&job());
    let lease = worker.lease(60_000).expect("a frame");
    worker.finish(&lease).unwrap();
    let image = format!("/v1/images/{id}/{}", lease.frames[0].frame);
    let record = service.get(&image).json();
    let artifacts = record["artifacts"].as_array().unwrap();
    let kinds: Vec<&str> = artifacts
        .iter()
        .map(|artifact| artifact["kind"].as_str().unwrap())
        .collect();
    let whole = service.get(&format!("{image}/artifacts"));
    assert_eq!(
        (whole.status, whole.header("content-type")),
        (200, "application/x-tar"),
        "{}",
        whole.text()
    );
    assert_eq!(whole.header("content-length"), whole.body.len().to_string());
    let mut archive = tar::Archive::new(&whole.body[..]);
    let mut found = Vec::new();
    for entry in archive.entries().unwrap() {
        let mut entry = entry.unwrap();
        let name = entry.path().unwrap().to_str().unwrap().to_owned();
        let mut bytes = Vec::new();
        std::io::Read::read_to_end(&mut entry, &mut bytes).unwrap();
        let kind = name.rsplit_once('.').unwrap().0.to_owned();
        assert_eq!(
            service.get(&format!("{image}/artifacts/{kind}")).body,
            bytes,
            "{name}"
        );
        found.push(kind);
    }
    assert_eq!(found, kinds);
    let single = service.get(&format!("{image}/artifacts?kinds={}", kinds[0]));
    assert_eq!(tar::Archive::new(&single.body[..]).entries().unwrap().count(), 1);
    let with_record = service.get(&format!("{image}/artifacts?kinds={}&record=true", kinds[0]));
    assert_eq!(
        with_record.header("content-length"),
        with_record.body.len().to_string()
    );
    let mut archive = tar::Archive::new(&with_record.body[..]);
    let mut entries = archive.entries().unwrap().map(Result::unwrap);
    let first = entries.next().unwrap();
    assert_eq!(first.path().unwrap().to_str(), Some("record.json"));
    assert_eq!(serde_json::from_reader::<_, Value>(first).unwrap(), record);
    assert_eq!(entries.count(), 1);
    let problem = service
        .get(&format!("{image}/artifacts?kinds={},nothing", kinds[0]))
        .problem(404, "not-found");
    assert!(
        problem["detail"].as_str().unwrap().contains(kinds[0]),
        "{problem}"
    );
}

#[test]
fn a_render_that_exceeds_the_wait_becomes_a_job() {
    let service = start();
    let headers = [("content-type", "application/json"), ("prefer", "wait=0")];
    let accepted = service.post_with("/v1/renders", &headers, single_frame().to_string().as_bytes());
    assert_eq!(accepted.status, 202, "{}", accepted.text());
    let id = accepted.json()["id"].as_str().unwrap().to_owned();
    assert_eq!(accepted.header("location"), format!("/v1/jobs/{id}"));
    let headers = [("content-type", "application/json"), ("prefer", "wait=soon")];
    service
        .post_with("/v1/renders", &headers, single_frame().to_string().as_bytes())
        .problem(400, "invalid-header");
    let problem = service.post("/v1/renders", &job()).problem(422, "validation");
    assert_eq!(problem["errors"][0]["pointer"], "/count");
}

#[test]
fn a_failed_render_reports_the_reason() {
    let service = start();
    let worker = Fake::register(&service);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let lease = worker.lease(60_000).expect("a frame");
            worker.fail(&lease, "the lens is fogged");
        });
        let problem = service
            .post("/v1/renders", &single_frame())
            .problem(422, "render-failed");
        assert_eq!(problem["detail"], "the lens is fogged");
        assert!(problem["job"].is_null(), "the job is gone: {problem}");
    });
    assert_eq!(service.get("/v1/jobs").json()["items"], json!([]));
}

#[test]
fn the_same_scene_twice_is_one_scene() {
    let service = start();
    let picture = crate::common::bytes::png(16, 12);
    let range = crate::common::bytes::range_png(16, 12);
    let fields: [(&str, &[u8]); 5] = [
        ("rgb", &picture),
        ("z_depth", &range),
        ("unit_m", b"0.001"),
        ("invalid_code", b"0"),
        ("hfov_deg", b"80"),
    ];
    let first = service.upload(&fields);
    assert_eq!(first.status, 201, "{}", first.text());
    let again = service.upload(&fields);
    assert_eq!((again.status, &again.json()["id"]), (200, &first.json()["id"]));
    let other = service.upload(&fields[..1]);
    assert_eq!(other.status, 201);
    let listed = service.get("/v1/scenes").json();
    assert_eq!(listed["items"].as_array().unwrap().len(), 2, "{listed}");
    let mut uses = single_frame();
    uses["scene"] = json!({"kind": "uploaded", "id": first.json()["id"]});
    uses.as_object_mut().unwrap().remove("camera");
    service.submit(&uses);
}
