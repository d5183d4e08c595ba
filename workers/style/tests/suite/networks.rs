//! Enhancers and metrics: what they get, and errors of unusable ones.

use imaging::Rgb8;
use serde_json::{Value, json};
use style::{Library, ModelRole, NetworkError, PictureNetwork, StyleModel, check};

use crate::onnx::{Attribute, Chain};
use crate::runtime;

const PLANES: [u64; 4] = [1, 3, 0, 0];
const PIXELS: [u64; 4] = [1, 0, 0, 3];

/// A chain of operators on planes of any size.
fn chain<'a>(operators: &'a [(&'a str, usize, &'a [Attribute<'a>])]) -> Chain<'a> {
    Chain {
        operators,
        input: PLANES,
        output: Some(&[1, 3, 0, 0]),
        unused: &[],
    }
}

/// The mean of all samples after another operator.
fn mean_after<'a>(operators: &'a [(&'a str, usize, &'a [Attribute<'a>])]) -> Chain<'a> {
    Chain {
        output: None,
        ..chain(operators)
    }
}

const TO_MEAN: (&str, usize, &[Attribute<'static>]) = ("ReduceMean", 1, &[Attribute::Integer("keepdims", 0)]);

/// A model with these fields in its card.
fn model(role: ModelRole, chain: &Chain<'_>, fields: &Value) -> StyleModel {
    let onnx = chain.bytes();
    let mut card = json!({"name": "net", "sha256": imaging::digest::sha256(&onnx), "role": role.name()});
    for (field, value) in fields.as_object().unwrap() {
        card[field] = value.clone();
    }
    let library = Library::embedded().unwrap();
    let library = library.with_model("net", onnx, Some(&card.to_string())).unwrap();
    library.get("net").unwrap().clone()
}

fn network(role: ModelRole, chain: &Chain<'_>, fields: &Value) -> Result<PictureNetwork, NetworkError> {
    runtime().picture_network(&model(role, chain, fields))
}

fn enhancer(chain: &Chain<'_>, fields: &Value) -> PictureNetwork {
    network(ModelRole::Enhancer, chain, fields).unwrap()
}

fn picture(width: usize, height: usize) -> Rgb8 {
    Rgb8::from_fn(width, height, |x, y| {
        [(7 * x) as u8, (11 * y) as u8, (x * y) as u8]
    })
}

fn invert(picture: &Rgb8) -> Rgb8 {
    let codes = picture.data().iter().map(|code| 255 - code);
    Rgb8::new(picture.width(), picture.height(), codes.collect()).unwrap()
}

/// Every defect of a model.
fn defects(role: ModelRole, chain: &Chain<'_>, fields: &Value) -> String {
    let model = model(role, chain, fields);
    check(&model, || Ok(runtime())).unwrap_err().to_string()
}

#[test]
fn each_scale_and_layout_gives_every_code_back() {
    let picture = picture(16, 9);
    for scale in ["0..1", "0..255", "-1..1"] {
        for (layout, shape) in [("NCHW", PLANES), ("NHWC", PIXELS)] {
            let identity = Chain {
                input: shape,
                output: Some(&shape),
                ..chain(&[("Identity", 1, &[])])
            };
            let mut identity = enhancer(&identity, &json!({"input_scale": scale, "layout": layout}));
            assert_eq!(identity.enhance(&picture).unwrap(), picture, "{scale} {layout}");
        }
    }
}

#[test]
fn the_scale_decides_what_a_network_computes() {
    let negative = chain(&[("Neg", 1, &[])]);
    let picture = picture(16, 9);
    let mut signed = enhancer(&negative, &json!({"input_scale": "-1..1"}));
    assert_eq!(signed.enhance(&picture).unwrap(), invert(&picture));
    let mut unit = enhancer(&negative, &json!({}));
    let black = unit.enhance(&picture).unwrap();
    assert!(black.data().iter().all(|&code| code == 0), "clamped");
}

#[test]
fn a_network_for_multiples_gets_a_padded_picture_and_returns_the_size_of_the_frame() {
    let in_blocks = [
        ("SpaceToDepth", 1, &[Attribute::Integer("blocksize", 8)][..]),
        ("DepthToSpace", 1, &[Attribute::Integer("blocksize", 8)][..]),
    ];
    let picture = picture(21, 13);
    let mut any = enhancer(&chain(&in_blocks), &json!({}));
    let error = any.enhance(&picture).unwrap_err().to_string();
    assert!(
        error.starts_with("network `net` failed") && error.contains("21×13"),
        "{error}"
    );
    let mut padded = enhancer(&chain(&in_blocks), &json!({"size": "multiple of 8"}));
    assert_eq!(padded.enhance(&picture).unwrap(), picture);
    let one = Rgb8::from_fn(1, 1, |_, _| [9, 8, 7]);
    assert_eq!(padded.enhance(&one).unwrap(), one);
}

#[test]
fn a_network_for_one_size_refuses_others() {
    let mut fixed = enhancer(&chain(&[("Identity", 1, &[])]), &json!({"size": "fixed 16x9"}));
    assert_eq!(fixed.enhance(&picture(16, 9)).unwrap(), picture(16, 9));
    let error = fixed.enhance(&picture(9, 16)).unwrap_err().to_string();
    assert!(error.contains("16×9 only") && error.contains("9×16"), "{error}");
    let empty = Rgb8::new(0, 0, Vec::new()).unwrap();
    assert!(
        fixed
            .enhance(&empty)
            .unwrap_err()
            .to_string()
            .contains("at least 1×1")
    );
}

#[test]
fn a_metric_is_one_number() {
    let mut mean = network(
        ModelRole::Metric,
        &mean_after(&[TO_MEAN]),
        &json!({"input_scale": "0..255"}),
    )
    .unwrap();
    let gray = Rgb8::from_fn(5, 3, |_, _| [30, 60, 90]);
    assert_eq!(mean.measure(&gray).unwrap(), 60.0);
    let by_column = [(
        "ReduceMean",
        1,
        &[
            Attribute::Integers("axes", &[1, 2]),
            Attribute::Integer("keepdims", 0),
        ][..],
    )];
    let mut five = network(ModelRole::Metric, &mean_after(&by_column), &json!({})).unwrap();
    let error = five.measure(&gray).unwrap_err().to_string();
    assert!(error.contains("[1, 5]; must be one number"), "{error}");
}

#[test]
fn a_usable_network_passes_the_check() {
    let identity = model(ModelRole::Enhancer, &chain(&[("Identity", 1, &[])]), &json!({}));
    assert!(check(&identity, || Ok(runtime())).is_ok());
    let mean = model(ModelRole::Metric, &mean_after(&[TO_MEAN]), &json!({}));
    assert!(check(&mean, || Ok(runtime())).is_ok());
    let fixed = json!({"size": "fixed 16x9"});
    let fixed = model(ModelRole::Enhancer, &chain(&[("Identity", 1, &[])]), &fixed);
    assert!(check(&fixed, || Ok(runtime())).is_ok());
}

/// Operators with their inputs and attributes, and a part of the reason why they are refused.
type Refusal<'a> = (&'a [(&'a str, usize, &'a [Attribute<'a>])], &'a str);

#[test]
fn an_enhancer_that_cannot_be_used_is_refused_by_what_it_does() {
    let smaller = [(
        "AveragePool",
        1,
        &[Attribute::Integers("kernel_shape", &[2, 2])][..],
    )];
    let refused: [Refusal; 5] = [
        (&smaller, "must have the shape [1, 3, 17, 33]"),
        (&[("Sub", 2, &[])], "of a 768×492 picture of all levels"),
        (&[("Acosh", 1, &[])], "a sample of NaN"),
        (&[("RandomUniformLike", 1, &[])], "must not draw random numbers"),
        (&[("Neg", 1, &[])], "another input scale may fit"),
    ];
    for (operators, expected) in refused {
        let found = defects(ModelRole::Enhancer, &chain(operators), &json!({}));
        assert!(found.contains(expected), "{expected}: {found}");
    }
}

#[test]
fn every_size_with_a_defect_is_named() {
    let found = defects(ModelRole::Enhancer, &chain(&[("Sub", 2, &[])]), &json!({}));
    assert!(found.contains("33×17") && found.contains("768×492"), "{found}");
}

#[test]
fn a_metric_that_cannot_be_used_is_refused_by_what_it_does() {
    let refused: [Refusal; 4] = [
        (&[("Identity", 1, &[])], "must be one float32 number"),
        (&[("Sub", 2, &[]), TO_MEAN], "must tell them apart"),
        (&[("Log", 1, &[]), TO_MEAN], "must be a finite number"),
        (
            &[("RandomUniformLike", 1, &[]), TO_MEAN],
            "must not draw random numbers",
        ),
    ];
    for (operators, expected) in refused {
        let found = defects(ModelRole::Metric, &mean_after(operators), &json!({}));
        assert!(found.contains(expected), "{expected}: {found}");
    }
}

#[test]
fn ports_that_do_not_fit_the_role_are_refused_together() {
    let pixels = Chain {
        input: PIXELS,
        output: Some(&PIXELS),
        ..chain(&[("Identity", 1, &[])])
    };
    let found = defects(ModelRole::Enhancer, &pixels, &json!({}));
    assert!(
        found.contains("`picture`") && found.contains("`result`") && found.contains("layout NCHW"),
        "{found}"
    );
    let two = Chain {
        unused: &["depth"],
        ..chain(&[("Identity", 1, &[])])
    };
    let found = defects(ModelRole::Enhancer, &two, &json!({}));
    assert!(
        found.contains("`depth`") && found.contains("must have one"),
        "{found}"
    );
    let picture = chain(&[("Identity", 1, &[])]);
    let found = defects(ModelRole::Metric, &picture, &json!({}));
    assert!(found.contains("must be one float32 number"), "{found}");
}

#[test]
fn a_style_is_no_enhancer() {
    let style = Library::embedded().unwrap().get("muddy").unwrap().clone();
    let error = runtime().picture_network(&style).err().unwrap().to_string();
    assert!(error.contains("use it as `water.style`"), "{error}");
}
