//! Enhancers and metric networks through the real binary and ONNX Runtime. Failure: an unusable network is accepted, a frame is not
//! that of its network, a metric cannot be queried, or a frame is not reproduced.

#![allow(clippy::unwrap_used)]

use std::path::Path;
use std::process::Command;

use fathom_tests::onnx::{Message, file, floats, from_image, graph, node, numbers, picture, whole};
use fathom_tests::{Service, fathom, root};
use imaging::codec::decode_picture;
use serde_json::{Value, json};

fn runtime() -> String {
    let runtime = root().join(".onnxruntime/libonnxruntime.so");
    std::env::var("ORT_DYLIB_PATH").unwrap_or_else(|_| runtime.display().to_string())
}

fn start(data: &Path) -> Service {
    Service::start_with(data, &["--slots", "2", "--onnxruntime", &runtime()], &[])
}

/// The negative of a picture whose black is -1.
fn negative() -> Vec<u8> {
    from_image(&[node("Neg", &["image"], &["styled"])], &[])
}

/// The mean of all samples after some operators that end in `last`.
fn mean(before: &[Message], last: &str) -> Vec<u8> {
    let mean = node("ReduceMean", &[last], &["value"]).bytes(5, whole("keepdims", 0));
    let nodes: Vec<Message> = before.iter().cloned().chain([mean]).collect();
    let inputs = [picture("image", 3, ["h", "w"])];
    file(&graph(&nodes, &[], &inputs, &[floats("value")]))
}

fn add(service: &Service, name: &str, onnx: &[u8], fields: &[(&str, &str)]) -> (u16, Value) {
    let mut form = vec![("name", name.as_bytes()), ("model", onnx)];
    form.extend(fields.iter().map(|(field, text)| (*field, text.as_bytes())));
    service.form("/v1/styles", &form)
}

const SIGNED: [(&str, &str); 2] = [("role", "enhancer"), ("input_scale", "-1..1")];

#[test]
fn networks_enhance_and_measure_frames_that_are_reproduced() {
    let data = tempfile::tempdir().unwrap();
    let service = start(data.path());
    assert_eq!(add(&service, "negative", &negative(), &SIGNED).0, 201);
    let metric = [("role", "metric"), ("input_scale", "0..255")];
    let (status, card) = add(&service, "mean", &mean(&[], "image"), &metric);
    assert_eq!((status, &card["role"]), (201, &json!("metric")), "{card}");
    let job = json!({
        "dataset": "nets", "count": 3, "scene": {"kind": "procedural", "family": "structure", "seed": {"int": [1, 9]}},
        "camera": {"width": 48, "height": 32}, "water": {"optics": "jerlov-3C"},
        "enhance": [{"method": "onnx", "model": "negative", "name": "mine"}],
        "metrics": ["net.mean"], "artifacts": ["rgb", "enhanced.mine"], "encode": {"format": "png"},
    });
    let id = service.submit(&job);
    assert_eq!(service.finished(&id)["state"], "done");
    for frame in 0..3 {
        let (_, record) = service.get(&format!("/v1/images/{id}/{frame}"));
        let of = |subject: &str| record["measurements"][subject]["net.mean"].as_f64().unwrap();
        assert!((of("rgb") + of("mine") - 255.0).abs() < 1e-3, "{record}");
        assert_eq!(record["provenance"]["inputs"]["metric.mean"], card["sha256"]);
        let (status, verified) = service.post(
            &format!("/v1/images/{id}/{frame}/verify"),
            &json!({"rerender": true}),
        );
        assert_eq!(
            (status, &verified["reproduced"]),
            (200, &json!(true)),
            "{verified}"
        );
    }
    let (status, page) = service.get(
        "/v1/images?dataset=nets&filter=mine.net.mean%20%3E%200&fields=frame,net.mean&order_by=-net.mean",
    );
    assert_eq!(status, 200, "{page}");
    let means: Vec<f64> = page["items"]
        .as_array()
        .unwrap()
        .iter()
        .map(|row| row["net.mean"].as_f64().unwrap())
        .collect();
    assert!(means.len() == 3 && means.is_sorted_by(|a, b| a >= b), "{page}");
}

#[test]
fn an_unusable_network_is_refused_by_what_it_does() {
    let data = tempfile::tempdir().unwrap();
    let service = start(data.path());
    let pool = node("AveragePool", &["image"], &["styled"]).bytes(5, numbers("kernel_shape", &[2, 2]));
    let zero = node("Sub", &["image", "image"], &["zero"]);
    let dice = node("RandomUniformLike", &["image"], &["dice"]);
    let refused = [
        ("enhancer", from_image(&[pool], &[]), "must have the shape"),
        (
            "enhancer",
            from_image(&[node("Sub", &["image", "image"], &["styled"])], &[]),
            "must keep the scene",
        ),
        (
            "enhancer",
            from_image(&[node("Acosh", &["image"], &["styled"])], &[]),
            "NaN",
        ),
        ("enhancer", negative(), "another input scale"),
        ("metric", negative(), "one float32 number"),
        ("metric", mean(&[zero], "zero"), "must tell them apart"),
        ("metric", mean(&[dice], "dice"), "must not draw random numbers"),
        ("enhancer", b"hello".to_vec(), "no ONNX file"),
    ];
    for (role, onnx, says) in refused {
        let (status, problem) = add(&service, "net", &onnx, &[("role", role)]);
        let error = &problem["errors"][0];
        assert_eq!(
            (status, &error["pointer"]),
            (422, &json!("/model")),
            "{says}: {problem}"
        );
        assert!(
            error["message"].as_str().unwrap().contains(says),
            "{says}: {problem}"
        );
    }
    let (_, page) = service.get("/v1/styles?role=enhancer");
    assert_eq!(page["items"], json!([]));
}

/// A folder with `negative` as an enhancer and `mean` as a metric.
fn write_networks(folder: &Path) {
    let networks = [
        (
            "negative",
            negative(),
            json!({"role": "enhancer", "input_scale": "-1..1", "size": "multiple of 8"}),
        ),
        (
            "mean",
            mean(&[], "image"),
            json!({"role": "metric", "input_scale": "0..255"}),
        ),
    ];
    for (name, onnx, mut card) in networks {
        card["name"] = json!(name);
        card["sha256"] = json!(imaging::digest::sha256(&onnx));
        std::fs::write(folder.join(format!("{name}.onnx")), onnx).unwrap();
        std::fs::write(folder.join(format!("{name}.card.json")), card.to_string()).unwrap();
    }
}

#[test]
fn the_commands_for_pictures_use_networks_of_a_folder() {
    let folder = tempfile::tempdir().unwrap();
    write_networks(folder.path());
    let styles = folder.path().to_str().unwrap();
    let [input, output] = ["in.png", "out.png"].map(|name| folder.path().join(name));
    let picture = imaging::Rgb8::from_fn(21, 13, |x, y| [(9 * x) as u8, (7 * y) as u8, 50]);
    std::fs::write(
        &input,
        imaging::codec::encode_png(&picture.clone().into()).unwrap(),
    )
    .unwrap();
    let [input, output] = [&input, &output].map(|path| path.to_str().unwrap());
    let places = ["--styles", styles, "--onnxruntime", &runtime()].map(str::to_owned);
    let run = |arguments: &[&str]| {
        Command::new(fathom())
            .args(arguments)
            .args(&places)
            .output()
            .unwrap()
    };
    let done = run(&["enhance", "onnx:model=negative", input, "--out", output]);
    assert!(done.status.success(), "{done:?}");
    let enhanced = decode_picture(&std::fs::read(output).unwrap()).unwrap().to_rgb8();
    let negative: Vec<u8> = picture.data().iter().map(|code| 255 - code).collect();
    assert_eq!(enhanced.data(), negative);
    let measured = run(&[
        "measure",
        input,
        output,
        "--metrics",
        "entropy,net.mean",
        "--json",
    ]);
    assert!(measured.status.success(), "{measured:?}");
    let lines = String::from_utf8(measured.stdout).unwrap();
    let means: Vec<f64> = lines
        .lines()
        .map(|line| {
            serde_json::from_str::<Value>(line).unwrap()["metrics"]["net.mean"]
                .as_f64()
                .unwrap()
        })
        .collect();
    assert!((means[0] + means[1] - 255.0).abs() < 1e-3, "{lines}");
    for (arguments, says) in [
        (
            &["enhance", "onnx:model=mean", input, "--out", output][..],
            "is a metric",
        ),
        (
            &["enhance", "onnx:model=x", input, "--out", output],
            "there is negative",
        ),
        (&["measure", input, "--metrics", "net.negative"], "net.mean"),
    ] {
        let refused = run(arguments);
        let text = String::from_utf8_lossy(&refused.stderr).into_owned();
        assert_eq!(refused.status.code(), Some(2), "{text}");
        assert!(text.contains(says), "{text}");
    }
}
