//! Rejected distributions.

use serde_json::{Value, json};

use crate::common::{document_with, errors, only_error};

fn alpha(law: Value) -> spec::FieldError {
    only_error(json!({"alpha": law, "water": {"style": "muddy"}}))
}

#[test]
fn a_law_of_the_wrong_form_is_refused_at_its_place() {
    let refused = [
        (
            json!({"uniform": [1, 0]}),
            "`alpha`: `uniform` has a = 1 above b = 0",
        ),
        (
            json!({"uniform": [0]}),
            "`alpha`: `uniform` must be two numbers [a, b]",
        ),
        (
            json!({"uniform": 0.5}),
            "`alpha`: `uniform` must be two numbers [a, b]",
        ),
        (
            json!({"uniform": ["0", "1"]}),
            "`alpha`: `uniform` must be two numbers [a, b]",
        ),
        (
            json!({"log_uniform": [0, 1]}),
            "`alpha`: `log_uniform` has a = 0; must be above 0",
        ),
        (
            json!({"int": [0, 0.5]}),
            "`alpha`: `int` must be two whole numbers [a, b]",
        ),
        (json!({"int": [1, 0]}), "`alpha`: `int` has a = 1 above b = 0"),
        (
            json!({"normal": [0.5, -1], "clip": [0, 1]}),
            "`alpha`: `normal` has sd = -1; must be 0 or more",
        ),
        (
            json!({"normal": [0.5, 1]}),
            "`alpha`: `normal` needs `clip`: [a, b], the limits of its values",
        ),
        (
            json!({"normal": [0.5, 1], "clip": [1, 0]}),
            "`alpha`: `clip` has a = 1 above b = 0",
        ),
        (
            json!({"normal": [0.5, 1], "clip": [0]}),
            "`alpha`: `clip` must be two numbers [a, b]",
        ),
        (
            json!({"normal": [0.5], "clip": [0, 1]}),
            "`alpha`: `normal` must be two numbers [mean, sd]",
        ),
        (
            json!({"choice": []}),
            "`alpha`: `choice` is empty; must have at least one value",
        ),
        (
            json!({"choice": 1}),
            "`alpha`: `choice` must be a list of values, but is 1",
        ),
        (
            json!({"grid": []}),
            "`alpha`: `grid` is empty; must have at least one value",
        ),
        (
            json!({"choice": [0, 1], "weights": [1]}),
            "`alpha`: `weights` has 1 numbers; must have 2, one per value",
        ),
        (
            json!({"choice": [0, 1], "weights": [1, -1]}),
            "`alpha`: `weights` has a negative number; must be 0 or more",
        ),
        (
            json!({"choice": [0, 1], "weights": [0, 0]}),
            "`alpha`: `weights` are all 0; at least one must be above 0",
        ),
        (
            json!({"choice": [0, 1], "weights": [1e308, 1e308]}),
            "`alpha`: `weights` have an infinite sum; use smaller numbers",
        ),
        (
            json!({"choice": [0, 1], "weights": ["1", 1]}),
            "`alpha`: `weights` must be a list of numbers, but is a list of 2",
        ),
    ];
    for (law, message) in refused {
        let error = alpha(law.clone());
        assert_eq!(
            (error.pointer.as_str(), error.message.as_str()),
            ("/alpha", message),
            "{law}"
        );
    }
}

#[test]
fn keys_next_to_a_distribution_are_rejected() {
    let error = alpha(json!({"uniform": [0, 1], "clip": [0, 1]}));
    assert_eq!(
        (error.pointer.as_str(), error.allowed.as_slice()),
        ("/alpha/clip", &["uniform".to_owned()][..])
    );
    assert!(
        alpha(json!({"uniform": [0, 1], "int": [0, 1]}))
            .message
            .contains("has two distributions")
    );
    let error = alpha(json!({"choice": [0, 1], "weigths": [1, 1]}));
    assert_eq!(error.did_you_mean.as_deref(), Some("weights"));
    let error = alpha(json!({"unifrom": [0, 1]}));
    assert_eq!(
        (error.pointer.as_str(), error.did_you_mean.as_deref()),
        ("/alpha", Some("uniform"))
    );
}

#[test]
fn all_that_a_law_can_yield_must_be_within_the_limits() {
    let refused = [
        (json!({"uniform": [0, 1.1]}), "/alpha", json!(1.1)),
        (json!({"uniform": [-0.1, 1]}), "/alpha", json!(-0.1)),
        (json!({"log_uniform": [0.1, 2]}), "/alpha", json!(2.0)),
        (json!({"int": [0, 2]}), "/alpha", json!(2)),
        (
            json!({"normal": [0.5, 0.1], "clip": [0, 2]}),
            "/alpha",
            json!(2.0),
        ),
        (json!({"choice": [0, 1, 2]}), "/alpha/choice/2", json!(2)),
        (json!({"grid": [0, -1]}), "/alpha/grid/1", json!(-1)),
        (
            json!({"choice": [0, {"uniform": [0, 3]}]}),
            "/alpha/choice/1",
            json!(3.0),
        ),
    ];
    for (law, pointer, value) in refused {
        let error = alpha(law.clone());
        assert_eq!(
            (error.pointer.as_str(), error.value.as_ref()),
            (pointer, Some(&value)),
            "{law}"
        );
        assert_eq!(error.limit.as_deref(), Some("0..=1"));
    }
    let scale = only_error(json!({"water": {"optics": "jerlov-1C", "range_scale": {"uniform": [0, 2]}}}));
    assert_eq!(scale.pointer, "/water/range_scale");
}

#[test]
fn numbers_are_no_strings_and_fractions_no_whole_numbers() {
    let style = only_error(json!({"water": {"style": {"uniform": [0, 1]}}}));
    assert_eq!(
        style.message,
        "`water.style`: `uniform` yields a number, but the field must be a string"
    );
    let width = only_error(json!({"camera": {"width": {"uniform": [100, 200]}}}));
    assert!(
        width.message.contains("use `int`, `choice` or `grid`"),
        "{}",
        width.message
    );
    let water = only_error(json!({"water": {"int": [0, 1]}}));
    assert!(water.message.contains("must be an object"), "{}", water.message);
}

#[test]
fn intervals_wider_than_doubles_are_refused() {
    let light = |size: Value| json!({"lights": [{"kind": "haze", "x": 0, "y": 0, "size": size}]});
    assert!(
        only_error(light(json!({"uniform": [-1.7e308, 1.7e308]})))
            .message
            .contains("infinite width")
    );
    let wide = json!({"labels": {"n": {"int": [-9_007_199_254_740_992_i64, 9_007_199_254_740_992_i64]}}});
    assert!(only_error(wide).message.contains("2^53"));
}

#[test]
fn grids_with_count_stay_within_the_limit_of_frames() {
    let axis = json!({"grid": (0..1000).collect::<Vec<_>>()});
    let error = only_error(json!({"count": 1000, "labels": {"a": axis, "b": axis}}));
    assert_eq!(
        error.message,
        "`count` is 1000 and the grid has 1000000 cells; must be at most 100000000 frames in total"
    );
    let axes: serde_json::Map<_, _> = (0..32).map(|i| (format!("l{i}"), axis.clone())).collect();
    assert!(
        only_error(json!({"labels": axes}))
            .message
            .contains("more than 2^64 cells")
    );
}

#[test]
fn laws_of_camera_sides_are_judged_by_their_greatest_product() {
    let side = json!({"int": [1, 16_384]});
    assert_eq!(
        only_error(json!({"camera": {"width": side, "height": side}})).pointer,
        "/camera"
    );
    let pairs = json!({"choice": [{"width": 16_384, "height": 100}, {"width": 100, "height": 16_384}]});
    crate::common::job_with(json!({"camera": pairs}));
}

#[test]
fn every_bad_value_of_a_choice_is_reported() {
    let found = errors(&document_with(
        json!({"water": {"style": {"choice": ["a", "muddy", "b"]}}}),
    ));
    let pointers: Vec<_> = found.iter().map(|error| error.pointer.as_str()).collect();
    assert_eq!(pointers, ["/water/style/choice/0", "/water/style/choice/2"]);
}
