//! Models of other architectures than the shipped ones: accepted shapes, and errors of rejected ones.

use imaging::{Plane, Rgb};
use style::{ModelInputs, Repainted, Session, StyleError};

use crate::onnx::{DOUBLE, FLOAT, Graph};
use crate::{model_of, runtime};

const IMAGE: (&str, u64, u64) = ("image", FLOAT, 3);
const NOISE: (&str, u64, u64) = ("noise", FLOAT, 1);
const RANGE: (&str, u64, u64) = ("range", FLOAT, 1);

/// A session of a model of a user's folder.
fn session_of(onnx: &[u8]) -> Result<Session, StyleError> {
    runtime().session(&model_of(onnx))
}

/// A session of a graph that is expected to work.
fn session(graph: &Graph) -> Session {
    session_of(&graph.bytes()).unwrap()
}

fn unary(operator: &str) -> Graph<'_> {
    Graph {
        operator,
        attribute: None,
        inputs: &[IMAGE],
        operands: &[0],
        output: "styled",
    }
}

fn with_noise(noise: &Plane<f32>) -> ModelInputs<'_> {
    ModelInputs {
        noise: Some(noise),
        range: None,
    }
}

fn frame() -> Rgb<f32> {
    Rgb::from_fn(4, 3, |x, y| [0.1 * x as f32, 0.2 * y as f32, 0.5])
}

#[test]
fn an_only_input_and_a_first_output_may_have_any_name() {
    let graph = Graph {
        inputs: &[("x", FLOAT, 3)],
        output: "y",
        ..unary("Identity")
    };
    assert_eq!(
        session(&graph).apply(&frame(), ModelInputs::default()).unwrap(),
        frame()
    );
}

#[test]
fn noise_reaches_a_model_that_asks_for_it_and_is_zero_when_it_is_not_given() {
    let graph = Graph {
        operator: "Add",
        inputs: &[NOISE, IMAGE],
        operands: &[0, 1],
        ..unary("Add")
    };
    let mut session = session(&graph);
    assert_eq!(session.apply(&frame(), ModelInputs::default()).unwrap(), frame());
    let noise = Plane::filled(4, 3, 0.25f32);
    assert_eq!(
        session.apply(&frame(), with_noise(&noise)).unwrap(),
        frame().map(|v| v + 0.25)
    );
    let error = session
        .apply(&frame(), with_noise(&Plane::filled(3, 4, 0.0)))
        .unwrap_err();
    assert_eq!(
        error.to_string(),
        "style `test`: noise is 3×4 but the frame is 4×3"
    );
}

#[test]
fn samples_that_a_network_returns_out_of_range_are_clamped_and_counted() {
    let graph = Graph {
        operator: "Add",
        inputs: &[NOISE, IMAGE],
        operands: &[0, 1],
        ..unary("Add")
    };
    let noise = Plane::filled(4, 3, 0.75f32);
    let Repainted { picture, clamped } = session(&graph).repaint(&frame(), with_noise(&noise)).unwrap();
    // Red is above 1 in the last column, green in the last row, blue everywhere.
    assert_eq!(clamped, 3 + 4 + 12);
    assert_eq!(picture, frame().map(|v| (v + 0.75).min(1.0)));
}

#[test]
fn the_range_reaches_a_model_that_asks_for_it_and_is_needed() {
    let graph = Graph {
        operator: "Sum",
        inputs: &[RANGE, IMAGE, NOISE],
        operands: &[0, 1, 2],
        ..unary("Sum")
    };
    let model = model_of(&graph.bytes());
    assert!(model.card.takes_range && model.card.takes_noise);
    let mut session = runtime().session(&model).unwrap();
    assert!(session.takes_range() && session.takes_noise());
    let error = session.apply(&frame(), ModelInputs::default()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "style `test`: it needs the range of each pixel, but the frame has none"
    );
    let (range, noise) = (Plane::filled(4, 3, 0.125f32), Plane::filled(4, 3, 0.25f32));
    let ranged = |noise| ModelInputs {
        noise,
        range: Some(&range),
    };
    let shown = session.apply(&frame(), ranged(None)).unwrap();
    assert_eq!(shown, frame().map(|v| v + 0.125));
    let shown = session.apply(&frame(), ranged(Some(&noise))).unwrap();
    assert_eq!(shown, frame().map(|v| v + 0.375));
    let wrong = Plane::filled(4, 3, f32::NAN);
    let beside = ModelInputs {
        noise: None,
        range: Some(&wrong),
    };
    let error = session.apply(&frame(), beside).unwrap_err();
    assert_eq!(
        error.to_string(),
        "style `test`: range is NaN at pixel (0, 0); must be finite"
    );
}

#[test]
fn a_model_without_noise_does_not_look_at_it() {
    let noise = Plane::filled(1, 1, f32::NAN);
    assert_eq!(
        session(&unary("Identity"))
            .apply(&frame(), with_noise(&noise))
            .unwrap(),
        frame()
    );
}

#[test]
fn an_answer_that_was_padded_is_cropped_from_the_top_left() {
    for axis in [2, 3] {
        let graph = Graph {
            attribute: Some(("axis", axis)),
            operands: &[0, 0],
            ..unary("Concat")
        };
        assert_eq!(
            session(&graph).apply(&frame(), ModelInputs::default()).unwrap(),
            frame(),
            "axis {axis}"
        );
    }
}

#[test]
fn an_answer_out_of_the_unit_interval_is_clamped() {
    let styled = session(&unary("Neg"))
        .apply(&frame(), ModelInputs::default())
        .unwrap();
    assert!(
        styled
            .planes()
            .iter()
            .all(|plane| plane.data().iter().all(|&v| v == 0.0))
    );
}

#[test]
fn an_answer_that_is_no_picture_of_the_frame_is_refused() {
    let refused = |graph: &Graph| {
        session(graph)
            .apply(&frame(), ModelInputs::default())
            .unwrap_err()
            .to_string()
    };
    assert_eq!(
        refused(&unary("GlobalAveragePool")),
        "style `test` returned a picture of 1×1 for a 4×3 frame"
    );
    assert_eq!(
        refused(&unary("Log")),
        "style `test` returned a picture with a sample of -inf for a 4×3 frame"
    );
}

#[test]
fn a_frame_that_would_spoil_the_answer_is_refused() {
    let mut session = session(&unary("Identity"));
    let mut picture = frame();
    picture.planes_mut()[1][6] = f32::NAN;
    let error = session.apply(&picture, ModelInputs::default()).unwrap_err();
    assert_eq!(
        error.to_string(),
        "style `test`: image is NaN at pixel (2, 1); must be finite"
    );
    let error = session
        .apply(&Rgb::from_fn(0, 3, |_, _| [0.0; 3]), ModelInputs::default())
        .unwrap_err();
    assert_eq!(error.to_string(), "style `test`: the frame is empty: 0×3");
}

#[test]
fn a_model_of_another_form_is_refused_before_it_runs() {
    let refused = |graph: &Graph| session_of(&graph.bytes()).err().unwrap().to_string();
    let other = Graph {
        operator: "Add",
        inputs: &[IMAGE, ("depth", FLOAT, 1)],
        operands: &[0, 1],
        ..unary("Add")
    };
    assert!(refused(&other).contains("its input `depth` is unknown"));
    let double = Graph {
        inputs: &[("image", DOUBLE, 3)],
        ..unary("Identity")
    };
    assert!(
        refused(&double).contains("`image` is Tensor<f64>"),
        "{}",
        refused(&double)
    );
    let gray = Graph {
        inputs: &[("image", FLOAT, 1)],
        operands: &[0, 0, 0],
        attribute: Some(("axis", 1)),
        ..unary("Concat")
    };
    assert!(refused(&gray).contains("must be float32 of shape [1, 3, height, width]"));
    let error = session_of(b"no model at all").err().unwrap();
    assert!(
        error.to_string().starts_with("style `test` cannot be used: "),
        "{error}"
    );
}
