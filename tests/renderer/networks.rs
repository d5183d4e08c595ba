//! Enhancers and metrics of the user in frames. Needs ONNX Runtime.

use std::path::Path;
use std::sync::Arc;

use imaging::Rgb8;
use imaging::codec::decode_picture;
use renderer::{Engine, Rendered, SceneSource, Slot};
use serde_json::{Value, json};
use spec::{FieldError, Invalid, Job};
use style::Library;

use crate::common::{file, installed_runtime};
use crate::onnx::{Attribute, Chain};

/// The shipped styles, `invert` and `small` as enhancers, `mean` as a metric.
fn library() -> Library {
    let (negative, mean) = (NEGATIVE.bytes(), MEAN.bytes());
    let added = [
        (
            "invert",
            &negative,
            json!({"role": "enhancer", "input_scale": "-1..1", "size": "multiple of 32"}),
        ),
        (
            "small",
            &negative,
            json!({"role": "enhancer", "input_scale": "-1..1", "size": "fixed 40x30"}),
        ),
        ("mean", &mean, json!({"role": "metric", "input_scale": "0..255"})),
    ];
    added
        .into_iter()
        .fold(Library::embedded().unwrap(), |library, (name, onnx, mut card)| {
            card["name"] = name.into();
            card["sha256"] = imaging::digest::sha256(onnx).into();
            library
                .with_model(name, onnx.clone(), Some(&card.to_string()))
                .unwrap()
        })
}

/// The negative of a picture.
const NEGATIVE: Chain<'_> = Chain {
    operators: &[("Neg", 1, &[])],
    input: [1, 3, 0, 0],
    output: Some(&[1, 3, 0, 0]),
    unused: &[],
};

/// The mean of all samples.
const MEAN: Chain<'_> = Chain {
    operators: &[("ReduceMean", 1, &[Attribute::Integer("keepdims", 0)])],
    output: None,
    ..NEGATIVE
};

fn engine() -> Arc<Engine> {
    Arc::new(Engine::new(library(), installed_runtime().as_deref()))
}

fn description(fields: &Value) -> Value {
    let mut description = json!({
        "scene": {"kind": "procedural", "family": "structure", "seed": 3}, "water": {"optics": "jerlov-1C"},
        "camera": {"width": 50, "height": 34}, "artifacts": ["rgb"], "metrics": [],
    });
    for (name, value) in fields.as_object().unwrap() {
        description[name] = value.clone();
    }
    description
}

fn parse(fields: &Value) -> Result<Job, Invalid> {
    let vocabulary = renderer::vocabulary(&library(), false);
    Job::parse(description(fields).to_string().as_bytes(), &vocabulary)
}

fn render(fields: &Value) -> Rendered {
    let job = parse(fields).unwrap_or_else(|invalid| panic!("{invalid}"));
    let mut slot = Slot::new(&engine());
    slot.render(&job.resolve(0).unwrap(), &SceneSource::Local)
        .unwrap()
}

fn picture(rendered: &Rendered, kind: &str) -> Rgb8 {
    decode_picture(file(rendered, kind)).unwrap().to_rgb8()
}

fn invert(picture: &Rgb8) -> Rgb8 {
    let codes = picture.data().iter().map(|code| 255 - code);
    Rgb8::new(picture.width(), picture.height(), codes.collect()).unwrap()
}

fn mean(picture: &Rgb8) -> f64 {
    let sum: f64 = picture.data().iter().map(|&code| f64::from(code)).sum();
    sum / picture.data().len() as f64
}

fn errors(fields: &Value) -> Vec<FieldError> {
    parse(fields).unwrap_err().0
}

#[test]
fn a_network_enhances_the_frame_and_its_digest_is_in_the_record() {
    let rendered = render(&json!({
        "enhance": [{"method": "onnx", "model": "invert", "name": "my-net"}],
        "artifacts": ["rgb", "enhanced.my-net"],
    }));
    assert_eq!(
        picture(&rendered, "enhanced.my-net"),
        invert(&picture(&rendered, "rgb"))
    );
    let provenance = &rendered.record.provenance;
    let digest = library().get("invert").unwrap().card.sha256.clone();
    assert_eq!(provenance.inputs.get("enhancer.invert"), Some(&digest));
    assert!(provenance.onnx_runtime.is_some());
}

#[test]
fn a_network_is_a_step_of_a_chain_with_a_mask() {
    let rendered = render(&json!({
        "enhance": [
            {"name": "before", "steps": [{"gray_world": {}}]},
            {"name": "mine", "steps": [{"gray_world": {}}, {"onnx": {"model": "invert"}}],
             "mask": {"circle": {"radius": 0.2}}},
        ],
        "artifacts": ["enhanced.before", "enhanced.mine", "enhanced.mine.1", "enhanced.mine.mask"],
    }));
    let before = picture(&rendered, "enhanced.before");
    assert_eq!(picture(&rendered, "enhanced.mine.1"), before);
    let mask = picture(&rendered, "enhanced.mine.mask");
    let expected = invert(&before);
    let (result, kept) = (
        picture(&rendered, "enhanced.mine"),
        mask.pixels().filter(|&[k, ..]| k > 0),
    );
    assert!((10..50 * 34 - 10).contains(&kept.count()));
    for ((pixel, whole), [kept, ..]) in result.pixels().zip(expected.pixels()).zip(mask.pixels()) {
        assert_eq!(pixel, if kept == 0 { [0; 3] } else { whole });
    }
}

#[test]
fn a_metric_network_measures_every_picture_and_a_masked_one_with_black_outside() {
    let rendered = render(&json!({
        "enhance": [
            {"method": "onnx", "model": "invert", "name": "my-net"},
            {"method": "clahe", "name": "part", "mask": {"circle": {"radius": 0.2}}, "metrics_over": "mask"},
        ],
        "metrics": ["entropy", "net.mean"],
        "artifacts": ["rgb", "enhanced.my-net", "enhanced.part"],
    }));
    for (subject, kind) in [
        ("rgb", "rgb"),
        ("my-net", "enhanced.my-net"),
        ("part", "enhanced.part"),
    ] {
        let values = &rendered.record.measurements[subject];
        let expected = mean(&picture(&rendered, kind));
        assert!(
            (values["net.mean"] - expected).abs() < 1e-3,
            "{subject}: {values:?} {expected}"
        );
        assert!(values.contains_key("entropy"));
    }
    let inputs = &rendered.record.provenance.inputs;
    assert!(inputs.contains_key("metric.mean") && inputs.contains_key("enhancer.invert"));
}

#[test]
fn features_of_a_previous_frame_are_found_in_its_enhanced_picture() {
    let rendered = |frame: u64| {
        let fields = json!({
            "count": 2, "camera": {"width": 200, "height": 150, "path": {"frames": 2}},
            "enhance": [{"method": "onnx", "model": "invert", "name": "my-net"}], "metrics": ["matches"],
        });
        let job = parse(&fields).unwrap_or_else(|invalid| panic!("{invalid}"));
        let mut slot = Slot::new(&engine());
        slot.render(&job.resolve(frame).unwrap(), &SceneSource::Local)
            .unwrap()
    };
    let measured = &rendered(1).record.measurements;
    assert!(
        measured["rgb"]["matches"] > 0.0 && measured["my-net"]["matches"] > 0.0,
        "{measured:?}"
    );
}

#[test]
fn a_model_of_another_role_is_refused_with_the_names_that_work() {
    let onnx = |model: &str| json!({"enhance": [{"method": "onnx", "model": model}]});
    let cases = [
        (
            onnx("muddy"),
            "/enhance/0/model",
            "is a style",
            &["invert", "small"][..],
        ),
        (
            onnx("mean"),
            "/enhance/0/model",
            "\"net.mean\"",
            &["invert", "small"],
        ),
        (
            onnx("nothing"),
            "/enhance/0/model",
            "is not a known enhancer",
            &["invert", "small"],
        ),
        (
            json!({"water": {"style": "invert"}}),
            "/water/style",
            "is an enhancer",
            &["atlantic", "atlantic-range", "mediterranean", "muddy"],
        ),
    ];
    for (fields, pointer, message, allowed) in cases {
        let error = &errors(&fields)[0];
        assert_eq!(error.pointer, pointer, "{error:?}");
        assert!(error.message.contains(message), "{error:?}");
        assert_eq!(error.allowed, allowed, "{error:?}");
    }
    for (name, message) in [
        ("net.invert", "is an enhancer"),
        ("mean", "\"net.mean\""),
        ("net.x", "not a known metric"),
    ] {
        let error = &errors(&json!({"metrics": [name]}))[0];
        assert_eq!(error.pointer, "/metrics/0");
        assert!(error.message.contains(message), "{error:?}");
        assert!(error.allowed.contains(&"net.mean".to_owned()), "{error:?}");
    }
    let error = &errors(&json!({"enhance": ["onnx"]}))[0];
    assert!(error.message.contains("needs a model"), "{error:?}");
}

#[test]
fn a_model_can_be_named_by_its_digest() {
    let digest = library().get("mean").unwrap().card.sha256.clone();
    let error = &errors(&json!({"enhance": [{"method": "onnx", "model": digest}]}))[0];
    assert!(error.message.contains("is a metric"), "{error:?}");
    let onnx = library().get("small").unwrap().card.sha256.clone();
    let job = parse(&json!({
        "camera": {"width": 40, "height": 30},
        "enhance": [{"method": "onnx", "model": onnx}],
    }));
    let model = &job.unwrap().enhancers()[0];
    assert!(
        ["invert", "small"].contains(&model.as_str()),
        "one file under two names"
    );
}

#[test]
fn a_network_of_one_size_is_refused_unless_every_frame_has_it() {
    let fields = |camera: Value| json!({"camera": camera, "enhance": [{"name": "mine", "steps": [{"clahe": {}}, {"onnx": {"model": "small"}}]}]});
    assert!(parse(&fields(json!({"width": 40, "height": 30}))).is_ok());
    for camera in [
        json!({"width": 40, "height": 31}),
        json!({"width": {"choice": [40, 80]}, "height": 30}),
        json!({"width": {"int": [30, 40]}, "height": 30}),
    ] {
        let error = &errors(&fields(camera))[0];
        assert_eq!(error.pointer, "/enhance/0/steps/1/onnx/model", "{error:?}");
        assert!(error.message.contains("set the camera to 40×30"), "{error:?}");
    }
}

#[test]
fn without_the_runtime_a_network_fails_for_good_and_names_the_script() {
    let engine = Arc::new(Engine::new(
        library(),
        Some(Path::new("/nowhere/libonnxruntime.so")),
    ));
    for fields in [
        json!({"enhance": [{"method": "onnx", "model": "invert"}]}),
        json!({"metrics": ["net.mean"]}),
    ] {
        let frame = parse(&fields).unwrap().resolve(0).unwrap();
        let error = Slot::new(&engine)
            .render(&frame, &SceneSource::Local)
            .unwrap_err();
        assert!(!error.retryable());
        assert!(
            error.to_string().contains("scripts/get-onnxruntime.sh"),
            "{error}"
        );
    }
}
