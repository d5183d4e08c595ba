//! User networks through the real binary and ONNX Runtime: a usable one and defective ones. Failure: an unusable
//! network is accepted, one is rejected without its defect, or the service is impaired afterwards.

#![allow(clippy::unwrap_used)]

use std::path::Path;

use fathom_tests::onnx::{
    Message, body, constant, elsewhere, file, from_image, graph, node, numbers, picture, scalar, yes,
};
use fathom_tests::{Service, root};
use serde_json::json;

/// Short, for the network that never ends; the others take milliseconds.
const TRIAL: &[(&str, &str)] = &[("FATHOM_STYLE_TRIAL_S", "10")];

fn start(data: &Path) -> Service {
    let runtime = root().join(".onnxruntime/libonnxruntime.so");
    let runtime = std::env::var("ORT_DYLIB_PATH").unwrap_or_else(|_| runtime.display().to_string());
    Service::start_with(data, &["--slots", "2", "--onnxruntime", &runtime], TRIAL)
}

/// Soft colors: any picture in, a finite one out.
fn good() -> Vec<u8> {
    from_image(&[node("Sigmoid", &["image"], &["styled"])], &[])
}

#[test]
fn a_network_of_a_user_is_tried_added_rendered_and_rendered_again() {
    let data = tempfile::tempdir().unwrap();
    let service = start(data.path());
    let (status, card) = service.form("/v1/styles", &[("name", b"soft"), ("model", &good())]);
    assert_eq!(status, 201, "{card}");
    let job = json!({
        "dataset": "soft", "count": 3, "scene": {"kind": "procedural", "family": "structure", "seed": 1},
        "camera": {"width": 48, "height": 32, "hfov_deg": 80}, "water": {"optics": "jerlov-3C", "style": "soft"}
    });
    let id = service.submit(&job);
    assert_eq!(service.finished(&id)["state"], "done");
    // The verifying process finds the style in the service's folder.
    let (status, verified) = service.post(&format!("/v1/images/{id}/1/verify"), &json!({"rerender": true}));
    assert_eq!(
        (status, &verified["reproduced"]),
        (200, &json!(true)),
        "{verified}"
    );
    // So does a copy of the service.
    let (status, copy) = service.post("/v1/backups", &json!({}));
    assert_eq!(status, 201, "{copy}");
    let copied = start(&root().join(copy["folder"].as_str().unwrap()));
    let (_, page) = copied.get("/v1/styles");
    assert!(
        page.to_string().contains(card["sha256"].as_str().unwrap()),
        "{page}"
    );
}

/// Three parts of the picture and one of noise.
fn noisy() -> Vec<u8> {
    let inputs = [picture("image", 3, ["h", "w"]), picture("noise", 1, ["h", "w"])];
    let outputs = [picture("styled", 3, ["h", "w"])];
    file(&graph(
        &[node("Mean", &["image", "image", "image", "noise"], &["styled"])],
        &[],
        &inputs,
        &outputs,
    ))
}

#[test]
fn a_network_that_takes_noise_is_told_apart_and_its_frames_are_rendered_again_byte_for_byte() {
    let data = tempfile::tempdir().unwrap();
    let service = start(data.path());
    for (name, model, takes_noise) in [("soft", good(), false), ("noisy", noisy(), true)] {
        let (status, card) = service.form("/v1/styles", &[("name", name.as_bytes()), ("model", &model)]);
        assert_eq!(
            (status, &card["takes_noise"]),
            (201, &json!(takes_noise)),
            "{card}"
        );
        let (_, page) = service.get("/v1/styles");
        assert!(page["items"].as_array().unwrap().contains(&card), "{page}");
    }
    let job = json!({
        "dataset": "noisy", "count": 3, "scene": {"kind": "procedural", "family": "structure", "seed": 1},
        "camera": {"width": 48, "height": 32, "hfov_deg": 80}, "water": {"style": "noisy"}, "metrics": []
    });
    let id = service.submit(&job);
    assert_eq!(service.finished(&id)["state"], "done");
    for frame in 0..3 {
        let path = format!("/v1/images/{id}/{frame}/verify");
        let (status, verified) = service.post(&path, &json!({"rerender": true}));
        assert_eq!(
            (status, &verified["reproduced"]),
            (200, &json!(true)),
            "{verified}"
        );
    }
}

#[test]
fn a_network_that_cannot_be_used_is_refused_by_what_it_does() {
    let data = tempfile::tempdir().unwrap();
    let service = start(data.path());
    let (_, before) = service.get("/v1/styles");
    for (name, onnx, says) in hostile() {
        let (status, problem) = service.form("/v1/styles", &[("name", name.as_bytes()), ("model", &onnx)]);
        assert_eq!(status, 422, "{name}: {problem}");
        let error = &problem["errors"][0];
        assert_eq!(error["pointer"], "/model", "{name}: {problem}");
        assert!(
            error["message"].as_str().unwrap().contains(says),
            "{name}: {problem}"
        );
    }
    assert_eq!(service.get("/v1/styles").1, before);
    let (status, card) = service.form("/v1/styles", &[("name", b"soft"), ("model", &good())]);
    assert_eq!(status, 201, "the service is as well as before: {card}");
}

/// A chain of 10^5 nodes.
fn crowded() -> Vec<u8> {
    let names: Vec<String> = (0..100_000).map(|number| format!("n{number}")).collect();
    let nodes: Vec<Message> = ["image"]
        .into_iter()
        .chain(names.iter().map(String::as_str))
        .zip(names.iter().map(String::as_str).chain(["styled"]))
        .map(|(input, output)| node("Identity", &[input], &[output]))
        .collect();
    from_image(&nodes, &[])
}

/// A name, the file, and the text of the refusal.
fn hostile() -> Vec<(&'static str, Vec<u8>, &'static str)> {
    let one_channel = graph(
        &[node("Sigmoid", &["image"], &["styled"])],
        &[],
        &[picture("image", 1, ["h", "w"])],
        &[picture("styled", 1, ["h", "w"])],
    );
    let pool = node("AveragePool", &["image"], &["styled"]).bytes(5, numbers("kernel_shape", &[3, 3]));
    let outside = |file: &str| {
        let add = node("Add", &["image", "weights"], &["styled"]);
        from_image(&[add], &[elsewhere("weights", file)])
    };
    // An output of 29 GB.
    let greedy = constant("shape", &[1, 3, 50_000, 50_000], true);
    let again = graph(
        &[
            node("Identity", &["go_on"], &["still"]),
            node("Identity", &["frame"], &["same"]),
        ],
        &[],
        &[
            scalar("turn", false),
            scalar("go_on", true),
            picture("frame", 3, ["h", "w"]),
        ],
        &[scalar("still", true), picture("same", 3, ["h", "w"])],
    );
    let endless = node("Loop", &["turns", "first", "image"], &["styled"]).bytes(5, body("body", &again));
    let endless_constants = [constant("turns", &[i64::MAX], false), yes("first")];
    vec![
        ("no_onnx", b"hello, world".to_vec(), "no ONNX file"),
        ("empty", Vec::new(), "no ONNX file"),
        ("cut", good()[..60].to_vec(), "no ONNX file"),
        ("one_channel", file(&one_channel), "[1, 3, height, width]"),
        (
            "beside",
            outside("weights.bin"),
            "`weights` is stored in another file",
        ),
        (
            "passwords",
            outside("/etc/passwd"),
            "`weights` is stored in another file",
        ),
        (
            "above",
            outside("../catalogue.sqlite"),
            "`weights` is stored in another file",
        ),
        (
            "unknown",
            from_image(&[node("Teleport", &["image"], &["styled"])], &[]),
            "Teleport",
        ),
        ("pool", from_image(&[pool], &[]), "1×1"),
        (
            "not_a_number",
            from_image(&[node("Acosh", &["image"], &["styled"])], &[]),
            "NaN",
        ),
        (
            "infinite",
            from_image(&[node("Log", &["image"], &["styled"])], &[]),
            "inf",
        ),
        (
            "dice",
            from_image(&[node("RandomUniformLike", &["image"], &["styled"])], &[]),
            "frame differ",
        ),
        (
            "greedy",
            from_image(&[node("Expand", &["image", "shape"], &["styled"])], &[greedy]),
            "memory",
        ),
        (
            "boundless",
            from_image(
                &[node("Sigmoid", &["image"], &["styled"])],
                &[Message::default()
                    .number(1, 1 << 60)
                    .number(2, 1)
                    .bytes(8, "weights")],
            ),
            "`weights` has the sides [1152921504606846976]",
        ),
        ("crowded", crowded(), "more than 20000 nodes"),
        (
            "endless",
            from_image(&[endless], &endless_constants),
            "longer than 10 s",
        ),
    ]
}
