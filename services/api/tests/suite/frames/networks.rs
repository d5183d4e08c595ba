//! Enhancers and metric networks of users: uploads, roles and jobs that use them.

use super::styles::{muddy, names, trusting};
use crate::common::worker::Fake;
use crate::common::{Running, job, start_on, start_with};
use serde_json::{Value, json};

/// Adds a network; `fields` are further form fields.
fn add(service: &Running, name: &str, fields: &[(&str, &str)]) -> (u16, Value) {
    let onnx = muddy();
    let mut form = vec![("name", name.as_bytes()), ("model", onnx.as_slice())];
    form.extend(fields.iter().map(|(field, text)| (*field, text.as_bytes())));
    let added = service.form("/v1/styles", &form);
    (added.status, added.json())
}

const ENHANCER: &[(&str, &str)] = &[
    ("role", "enhancer"),
    ("input_scale", "-1..1"),
    ("layout", "NHWC"),
    ("size", "multiple of 32"),
];

#[test]
fn networks_are_listed_by_role_and_keep_their_declaration_after_a_restart() {
    let service = start_with(trusting());
    let (status, card) = add(&service, "clear", ENHANCER);
    assert_eq!(status, 201, "{card}");
    let declared = ["role", "input_scale", "layout", "size"].map(|field| card[field].clone());
    assert_eq!(
        json!(declared),
        json!(["enhancer", "-1..1", "NHWC", "multiple of 32"])
    );
    let (_, judge) = add(&service, "judge", &[("role", "metric")]);
    assert_eq!(
        (&judge["input_scale"], &judge["size"]),
        (&json!("0..1"), &json!("any"))
    );
    assert_eq!(add(&service, "clear", ENHANCER).0, 200, "the same again");
    let restarted = start_on(service.stop(), trusting());
    assert_eq!(names(&restarted, "/v1/styles?role=enhancer"), ["clear"]);
    assert_eq!(names(&restarted, "/v1/styles?role=metric"), ["judge"]);
    assert!(!names(&restarted, "/v1/styles?role=style").contains(&"clear".to_owned()));
    assert!(names(&restarted, "/v1/styles").contains(&"clear".to_owned()));
    restarted
        .get("/v1/styles?role=judge")
        .problem(400, "invalid-query");
    let page = restarted.get("/v1/styles").json();
    assert!(page["items"].as_array().unwrap().contains(&card), "{page}");
}

#[test]
fn a_name_belongs_to_one_role_and_one_declaration() {
    let service = start_with(trusting());
    assert_eq!(add(&service, "clear", ENHANCER).0, 201);
    let others: [&[(&str, &str)]; 3] = [&[], &[("role", "metric")], &[("role", "enhancer")]];
    for other in others {
        let (status, problem) = add(&service, "clear", other);
        assert_eq!(status, 409, "{problem}");
        assert!(
            problem["detail"]
                .as_str()
                .unwrap()
                .contains("the enhancer `clear` exists")
        );
    }
}

#[test]
fn fields_of_another_role_and_unknown_words_are_refused_together() {
    let service = start_with(trusting());
    let pointers = |fields: &[(&str, &str)]| {
        let (status, problem) = add(&service, "clear", fields);
        assert_eq!(status, 422, "{problem}");
        let errors = problem["errors"].as_array().unwrap().clone();
        let pointers: Vec<_> = errors
            .iter()
            .map(|error| error["pointer"].as_str().unwrap().to_owned())
            .collect();
        (pointers, problem.to_string())
    };
    let (found, text) = pointers(&[("layout", "NHWC"), ("size", "any")]);
    assert_eq!(found, ["/layout", "/size"], "{text}");
    assert!(text.contains("the role is `style`"), "{text}");
    let (found, text) = pointers(&[("role", "metric"), ("scale", "255"), ("alpha", "share")]);
    assert_eq!(found, ["/scale", "/alpha"], "{text}");
    let (found, text) = pointers(&[
        ("role", "judge"),
        ("input_scale", "0..2"),
        ("layout", "HWC"),
        ("size", "multiple of 0"),
    ]);
    assert_eq!(found, ["/role", "/input_scale", "/layout", "/size"], "{text}");
    assert!(text.contains("multiple of N") && text.contains("NCHW"), "{text}");
    assert!(!names(&service, "/v1/styles").contains(&"clear".to_owned()));
}

#[test]
fn a_job_with_a_network_needs_a_runtime_somewhere() {
    let service = start_with(trusting());
    add(&service, "clear", ENHANCER);
    add(&service, "judge", &[("role", "metric")]);
    let mut enhanced = job();
    enhanced["enhance"] = json!([{"name": "mine", "steps": [{"clahe": {}}, {"onnx": {"model": "clear"}}]}]);
    let mut measured = job();
    measured["metrics"] = json!(["net.judge"]);
    for body in [&enhanced, &measured] {
        let problem = service.post("/v1/jobs", body).problem(409, "runtime-missing");
        let detail = problem["detail"].as_str().unwrap();
        assert!(detail.contains("scripts/get-onnxruntime.sh"), "{problem}");
    }
    Fake::with_runtime(&service, Some("1.31.1"));
    service.submit(&enhanced);
    service.submit(&measured);
}

#[test]
fn a_model_in_the_place_of_another_role_is_refused_by_field() {
    let service = start_with(trusting());
    add(&service, "clear", ENHANCER);
    let mut body = job();
    body["water"]["style"] = json!("clear");
    body["enhance"] = json!([{"method": "onnx", "model": "muddy"}]);
    body["metrics"] = json!(["net.clear"]);
    let problem = service.post("/v1/jobs", &body).problem(422, "validation");
    let errors = problem["errors"].as_array().unwrap();
    let found = |pointer: &str| errors.iter().find(|error| error["pointer"] == pointer).unwrap();
    assert_eq!(
        found("/enhance/0/model")["allowed"],
        json!(["clear"]),
        "{problem}"
    );
    assert!(
        found("/water/style")["message"]
            .as_str()
            .unwrap()
            .contains("is an enhancer")
    );
    assert!(
        found("/metrics/0")["message"]
            .as_str()
            .unwrap()
            .contains("is an enhancer")
    );
}

#[test]
fn a_picture_is_not_enhanced_by_a_network() {
    let service = start_with(trusting());
    add(&service, "clear", ENHANCER);
    let picture = imaging::codec::encode_png(&imaging::Rgb8::from_fn(8, 8, |_, _| [9; 3]).into()).unwrap();
    let reply = service.form("/v1/enhance?method=onnx:model=clear", &[("picture", &picture)]);
    let problem = reply.problem(422, "validation");
    let error = &problem["errors"][0];
    assert_eq!(error["pointer"], "/method/model", "{problem}");
    assert!(
        error["message"]
            .as_str()
            .unwrap()
            .contains("networks run in jobs"),
        "{problem}"
    );
}
