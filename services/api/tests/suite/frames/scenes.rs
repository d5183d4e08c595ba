//! Parts of an uploaded scene, and requests that need them.

use imaging::Plane;
use imaging::codec::encode_png;
use serde_json::{Value, json};

use crate::common::bytes::{png, range_npy};
use crate::common::worker::Real;
use crate::common::{Running, start};
use crate::rejections::bad_input::nothing_changes;

/// Objects 1, 2 and 3 next to each other, and background below them.
pub(crate) fn mask(width: usize, height: usize) -> Vec<u8> {
    let object = |x: usize, y: usize| {
        if 2 * y < height {
            (1 + 3 * x / width) as u8
        } else {
            0
        }
    };
    encode_png(&Plane::from_fn(width, height, object).into()).unwrap()
}

fn uploaded(service: &Running, fields: &[(&str, &[u8])]) -> Value {
    let answer = service.upload(fields);
    assert_eq!(answer.status, 201, "{}", answer.text());
    answer.json()
}

fn job_over(scene: &Value, fields: Value) -> Value {
    let mut job = json!({"dataset": "own", "scene": {"kind": "uploaded", "id": scene["id"]}, "metrics": []});
    for (name, value) in fields.as_object().unwrap() {
        job[name] = value.clone();
    }
    job
}

#[test]
fn a_job_that_needs_a_missing_part_of_its_scene_is_rejected_by_every_endpoint() {
    let lamp = json!({"kind": "point", "position_m": [0, 0, 0], "intensity": [1, 1, 1]});
    nothing_changes(|service| {
        let scene = service.get("/v1/scenes").json()["items"][0].clone();
        let asked = job_over(
            &scene,
            json!({"water": {"optics": "jerlov-1C"}, "lights": [lamp], "artifacts": ["rgb", "boxes", "normals"], "alpha": 3}),
        );
        for path in ["/v1/jobs", "/v1/jobs/preview", "/v1/renders"] {
            let problem = service.post(path, &asked).problem(422, "validation");
            let errors = problem["errors"].as_array().unwrap();
            let pointers: Vec<_> = errors
                .iter()
                .map(|error| error["pointer"].as_str().unwrap())
                .collect();
            assert_eq!(pointers, ["/alpha", "/artifacts/1", "/artifacts/2"], "{path}");
            assert_eq!(errors[1]["value"], "boxes");
            assert!(
                errors[1]["allowed"].as_array().unwrap().contains(&json!("clean")),
                "{problem}"
            );
        }
    });
}

#[test]
fn a_distribution_that_needs_a_part_in_some_frames_causes_a_warning() {
    let service = start();
    let scene = uploaded(&service, &[("rgb", &png(16, 12))]);
    let job = job_over(&scene, json!({"water": {"grid": [{}, {"optics": "jerlov-1C"}]}}));
    let warns = |answer: Value| {
        answer["warnings"]
            .to_string()
            .contains("/water/grid/1/optics needs a range")
    };
    let accepted = service.post("/v1/jobs", &job);
    assert_eq!(accepted.status, 202);
    assert!(warns(accepted.json()), "{}", accepted.text());
    let preview = service.post("/v1/jobs/preview", &job);
    assert!(warns(preview.json()), "{}", preview.text());
}

#[test]
fn objects_get_their_classes_from_the_upload_to_the_record() {
    let service = start();
    let (picture, mask) = (png(48, 32), mask(48, 32));
    let range = range_npy(48, 32, |x, _| 1.0 + x as f32 / 24.0);
    let files: [(&str, &[u8]); 4] = [
        ("rgb", &picture),
        ("range", &range),
        ("instances", &mask),
        ("classes", br#"{"1": "pile", "3": "chain"}"#),
    ];
    let scene = uploaded(&service, &files);
    let id = scene["id"].as_str().unwrap();
    assert_eq!(
        scene["classes"],
        json!({"categories": [{"id": 2, "name": "pile"}, {"id": 128, "name": "chain"}],
               "segments_info": [{"id": 1, "category_id": 2}, {"id": 3, "category_id": 128}]})
    );
    // Only the response to the upload has a summary.
    let mut stored = scene.clone();
    assert!(stored.as_object_mut().unwrap().remove("summary").is_some());
    assert_eq!(service.get(&format!("/v1/scenes/{id}")).json(), stored);
    service.get("/v1/scenes/scn_gone").problem(404, "not-found");
    // Different classes make another scene; another format of the same classes does not.
    let bare = uploaded(&service, &files[..3]);
    assert_eq!(
        (bare["classes"].is_null(), bare["id"] == scene["id"]),
        (true, false)
    );
    let long = scene["classes"].to_string();
    let same = service.upload(&[files[0], files[1], files[2], ("classes", long.as_bytes())]);
    assert_eq!((same.status, &same.json()["id"]), (200, &scene["id"]));

    let asked = json!({"water": {"optics": "jerlov-1C"}, "artifacts": ["semantics", "boxes"]});
    let job = service.submit(&job_over(&scene, asked.clone()));
    let unnamed = service.submit(&job_over(&bare, asked));
    let _worker = Real::start(&service);
    let record = |job: &str| {
        let ended = service.get(&format!("/v1/jobs/{job}?wait=60")).json();
        assert_eq!(ended["state"], "done", "{ended}");
        service.get(&format!("/v1/images/{job}/0")).json()
    };
    let found = record(&job);
    let categories: Vec<_> = found["scene"]["instances"]
        .as_array()
        .unwrap()
        .iter()
        .map(|i| &i["category"])
        .collect();
    assert_eq!(categories, ["pile", "unlabeled", "chain"]);
    assert_eq!(
        found["scene"]["categories"][1],
        json!({"id": 128, "name": "chain"})
    );
    assert!(
        found["provenance"]["inputs"]["scene.classes"].is_string(),
        "{found}"
    );
    let names = record(&unnamed)["scene"]["categories"].clone();
    assert_eq!(names, json!([{"id": 255, "name": "unlabeled"}]));
    let rows = service
        .get("/v1/images?filter=instances.count%20%3D%203&fields=job")
        .json();
    assert_eq!(rows["items"].as_array().unwrap().len(), 2, "{rows}");
}

#[test]
fn classes_that_are_wrong_are_refused_with_their_place() {
    let (picture, mask) = (png(16, 12), mask(16, 12));
    nothing_changes(|service| {
        let refused = |classes: &[u8], pointer: &str, said: &str| {
            let fields: [(&str, &[u8]); 3] = [("rgb", &picture), ("instances", &mask), ("classes", classes)];
            let problem = service.upload(&fields).problem(422, "validation");
            assert_eq!(problem["errors"][0]["pointer"], pointer, "{problem}");
            assert!(
                problem["errors"][0]["message"].as_str().unwrap().contains(said),
                "{problem}"
            );
        };
        refused(br#"{"1": " "}"#, "/classes/1", "1 to 64 printable characters");
        refused("{\"1\": \"a\u{202e}b\"}".as_bytes(), "/classes/1", "printable");
        refused(br#"{"one": "pile"}"#, "/classes/one", "instance mask");
        refused(
            br#"{"4": "pile", "9": "pile"}"#,
            "/classes",
            "has the numbers 4, 9",
        );
        refused(b"not JSON", "/classes", "not valid JSON");
        let without = service.upload(&[("rgb", &picture), ("classes", br#"{"1": "pile"}"#)]);
        assert_eq!(
            without.problem(422, "validation")["errors"][0]["pointer"],
            "/classes"
        );
    });
}

#[test]
fn a_job_over_a_collection_keeps_the_scenes_that_it_had() {
    let service = start();
    let add = |name: &str, width: usize| {
        let picture = png(width, 12);
        let fields: [(&str, &[u8]); 3] = [
            ("rgb", &picture),
            ("collection", b"dock"),
            ("name", name.as_bytes()),
        ];
        let answer = service.upload(&fields);
        assert!([200, 201].contains(&answer.status), "{}", answer.text());
        answer.json()["id"].clone()
    };
    let (second, first) = (add("b", 20), add("a", 16));
    assert_eq!(
        service.get("/v1/collections").json()["items"],
        json!([{"name": "dock", "scenes": 2}])
    );
    let members = service.get("/v1/collections/dock").json()["items"].clone();
    assert_eq!(
        members,
        json!([{"name": "a", "id": first, "width": 16, "height": 12, "range_kind": null, "instances": false},
               {"name": "b", "id": second, "width": 20, "height": 12, "range_kind": null, "instances": false}])
    );
    service.get("/v1/collections/quay").problem(404, "not-found");

    let body = json!({"dataset": "own", "scene": {"kind": "collection", "name": "dock"}, "metrics": []});
    let id = service.submit(&body);
    // An existing name replaces a scene, a new name adds one: the job does not change.
    add("a", 24);
    add("c", 28);
    assert_eq!(service.get("/v1/collections").json()["items"][0]["scenes"], 3);
    let later = service.submit(&body);
    let _worker = Real::start(&service);
    let widths = |job: &str| {
        let ended = service.get(&format!("/v1/jobs/{job}?wait=60")).json();
        assert_eq!(ended["state"], "done", "{ended}");
        let frames = 0..ended["frames"].as_u64().unwrap();
        let width = |frame| {
            service.get(&format!("/v1/images/{job}/{frame}")).json()["parameters"]["camera"]["width"].clone()
        };
        frames.map(width).collect::<Vec<_>>()
    };
    assert_eq!(widths(&id), [16, 20]);
    assert_eq!(widths(&later), [24, 20, 28]);
    let rows = service
        .get("/v1/images?filter=scene.name%20%3D%20%22dock%22&fields=scene.id&limit=10")
        .json();
    assert_eq!(rows["items"].as_array().unwrap().len(), 5, "{rows}");
    // Missing parts of such a scene are reported at submission.
    let mut ranged = body;
    ranged["artifacts"] = json!(["rgb", "range"]);
    let problem = service.post("/v1/jobs", &ranged).problem(422, "validation");
    assert_eq!(problem["errors"][0]["pointer"], "/artifacts/1");
    assert!(
        problem["errors"][0]["message"].as_str().unwrap().contains("scn_"),
        "{problem}"
    );
    let bad: [(&str, &[u8]); 3] = [("rgb", &png(8, 8)), ("collection", b"Dock"), ("name", b"a\nb")];
    assert_eq!(
        service.upload(&bad).problem(422, "validation")["errors"]
            .as_array()
            .unwrap()
            .len(),
        2
    );
}

#[test]
fn a_scene_goes_when_no_job_uses_it_and_leaves_its_collections() {
    let service = start();
    let add = |name: &str, width: usize| {
        let (picture, range) = (png(width, 12), range_npy(width, 12, |_, _| 2.0));
        let fields: [(&str, &[u8]); 4] = [
            ("rgb", &picture),
            ("range", &range),
            ("collection", b"dock"),
            ("name", name.as_bytes()),
        ];
        let answer = service.upload(&fields);
        assert_eq!(answer.status, 201, "{}", answer.text());
        answer.json()["id"].as_str().unwrap().to_owned()
    };
    let (first, second) = (add("a", 16), add("b", 20));
    let body = json!({"dataset": "own", "scene": {"kind": "collection", "name": "dock"}, "metrics": []});
    let job = service.submit(&body);
    let problem = service
        .delete(&format!("/v1/scenes/{first}"))
        .problem(409, "in-use");
    let sent = problem["detail"].as_str().unwrap();
    assert!(sent.contains(&first) && sent.contains(&job), "{sent}");
    assert_eq!(service.get("/v1/collections").json()["items"][0]["scenes"], 2);

    assert_eq!(service.delete(&format!("/v1/jobs/{job}")).status, 200);
    assert_eq!(service.delete(&format!("/v1/scenes/{first}")).status, 204);
    service
        .get(&format!("/v1/scenes/{first}"))
        .problem(404, "not-found");
    service
        .delete(&format!("/v1/scenes/{first}"))
        .problem(404, "not-found");
    let left = service.get("/v1/collections/dock").json()["items"].clone();
    assert_eq!(
        (left.as_array().unwrap().len(), &left[0]["id"]),
        (1, &json!(second))
    );
    let gone = json!({"dataset": "own", "scene": {"kind": "uploaded", "id": first}, "metrics": []});
    let problem = service.post("/v1/jobs", &gone).problem(422, "validation");
    assert_eq!(problem["errors"][0]["pointer"], "/scene/id");
    assert_eq!(service.post("/v1/jobs", &body).json()["frames"], 1);

    assert_eq!(service.delete("/v1/collections/dock").status, 204);
    service.delete("/v1/collections/dock").problem(404, "not-found");
    assert_eq!(service.get(&format!("/v1/scenes/{second}")).status, 200);
    // The same image with other parts is another scene.
    assert_ne!(add("a", 16), first);
}
