//! The bound of a plan: exposed light is within it of the f64 reference.

use imaging::Rgb;
use optics::plan::Plan;
use renderer::{LinearPicture, SceneSource, Slot};
use serde_json::{Value, json};

use crate::common::{engine_without_runtime, parse};

/// Linear light of white: sensors and codes clip above it.
const WHITE: f64 = 1.0;

/// The bound of a plan on the error of exposed light.
fn promise(plan: &Plan) -> f64 {
    plan.promise().expect("a frame with a tolerance").bound
}

/// A structure in turbid water under a faint veil: dim, so that a camera multiplies its light. No lamp or sun casts shadows, since
/// their edges have no bound.
fn job(exposure: &Value, fidelity: &Value) -> Value {
    json!({
        "scene": {"kind": "procedural", "family": "structure", "lighting": "in_air"},
        "camera": {"width": 80, "height": 60, "bits": 16, "tone": "linear", "exposure": exposure},
        "water": {"optics": {"preset": "jerlov-3C", "veil_gain": 0.01}, "range_scale": 3},
        "fidelity": fidelity,
        "metrics": [],
    })
}

fn exposed_light(exposure: &Value, fidelity: &Value) -> LinearPicture {
    let frame = parse(&job(exposure, fidelity)).resolve(0).unwrap();
    let mut slot = Slot::new(&engine_without_runtime());
    slot.linear(&frame, &SceneSource::Local).unwrap()
}

/// The largest difference of a sample; light beyond white counts as white.
fn largest_error(fast: &Rgb<f32>, exact: &Rgb<f32>) -> f64 {
    let shown = |light: f32| f64::from(light).min(WHITE);
    let planes = fast.planes().iter().zip(exact.planes());
    let samples = planes.flat_map(|(fast, exact)| fast.data().iter().zip(exact.data()));
    samples
        .map(|(&fast, &exact)| (shown(fast) - shown(exact)).abs())
        .fold(0.0, f64::max)
}

/// Checks a frame of the default tolerance against its reference.
fn check(exposure: &Value) {
    let fast = exposed_light(exposure, &json!({"tolerance": 3e-4}));
    let exact = exposed_light(exposure, &json!("reference"));
    let error = largest_error(&fast.radiance, &exact.radiance);
    let promise = promise(&fast.plan);
    assert!(
        error <= promise,
        "exposure {exposure}: error {error:.2e} above {promise:.2e}"
    );
}

#[test]
fn light_of_a_fixed_exposure_is_within_the_promise() {
    check(&json!({"fixed": 1.0}));
    check(&json!({"fixed": 20.0}));
    check(&json!({"fixed": 60.0}));
}

#[test]
fn metered_light_is_within_the_promise() {
    check(&json!({"auto": {"target": 0.5, "percentile": 0.05}}));
}
