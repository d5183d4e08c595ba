use serde_json::{Value, json};
use spec::{Light, RaySource};

use crate::common::{job_with, only_error};

fn lamp(fields: Value) -> Value {
    let mut lamp = json!({"kind": "spot", "position_m": [0.3, 0, 0], "intensity": [4, 4, 4]});
    if let Value::Object(fields) = fields {
        for (name, value) in fields {
            lamp[name] = value;
        }
    }
    json!({"lights": [lamp]})
}

#[test]
fn lamps_have_a_radius() {
    let frame = job_with(lamp(json!({}))).resolve(0).unwrap();
    let Light::Spot(spot) = frame.lights[0] else {
        panic!("{:?}", frame.lights)
    };
    assert_eq!(spot.radius_m, 0.02);
    assert_eq!(frame.ray_source(), RaySource::Scene);
    assert_eq!(
        only_error(lamp(json!({"radius_m": 0.6}))).pointer,
        "/lights/0/radius_m"
    );
}

#[test]
fn a_lamp_points_somewhere() {
    let error = only_error(lamp(json!({"direction": [0, 0, 0]})));
    assert_eq!(error.pointer, "/lights/0/direction");
    assert!(
        error.message.contains("length must be above 0"),
        "{}",
        error.message
    );
}
