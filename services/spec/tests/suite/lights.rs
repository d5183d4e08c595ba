//! What must fit together within the lights.

use serde_json::{Value, json};
use spec::RaySource;

use crate::common::{errors, job_with, with};

/// A lamp with these fields beside.
fn lamp(beside: Value) -> Value {
    let mut lamp = json!({"kind": "point", "position_m": [0.3, 0, 0], "intensity": [4, 4, 4]});
    if let Value::Object(beside) = beside {
        for (name, value) in beside {
            lamp[name] = value;
        }
    }
    lamp
}

#[test]
fn every_form_of_shadow_is_a_job() {
    let lights = json!([
        lamp(json!({})),
        lamp(json!({"shadow": "none"})),
        lamp(json!({"shadow": "hard", "glow_shadow": true})),
        lamp(json!({"shadow": "soft", "radius_m": 0.05})),
        lamp(json!({"shadow": "soft", "radius_m": 0.05, "samples": 64, "glow_shadow": false})),
        lamp(json!({"shadow": {"choice": ["hard", "soft"]}, "radius_m": {"uniform": [0, 0.1]}})),
    ]);
    let job = job_with(json!({"lights": lights}));
    assert_eq!(job.resolve(0).unwrap().ray_source(), RaySource::Scene);
    let job = job_with(json!({"lights": lights, "rays": "screen"}));
    assert_eq!(job.resolve(0).unwrap().ray_source(), RaySource::Screen);
}

#[test]
fn what_a_shadow_lacks_and_what_lacks_a_shadow_is_said_at_once() {
    let lights = json!([
        lamp(json!({"shadow": "soft"})),
        lamp(json!({"shadow": "hard", "radius_m": 0.1, "samples": 4})),
        lamp(json!({"glow_shadow": true})),
        lamp(json!({"shadow": "soft", "radius_m": 0.6, "samples": 300})),
    ]);
    let picture = json!({"kind": "uploaded", "id": "scn_0123456789abcdef01234567"});
    let found = errors(&with(
        json!({"lights": lights, "rays": "scene", "scene": picture}),
    ));
    let expected = [
        ("/lights/0/shadow", "needs `radius_m`"),
        ("/lights/1/radius_m", "be \"soft\""),
        ("/lights/1/samples", "be \"soft\""),
        ("/lights/2/glow_shadow", "\"hard\" or \"soft\""),
        ("/lights/3/radius_m", "0.5"),
        ("/lights/3/samples", "256"),
        ("/rays", "procedural"),
    ];
    for (pointer, text) in expected {
        let is_it = |error: &spec::FieldError| error.pointer == pointer && error.message.contains(text);
        assert!(found.iter().any(is_it), "{pointer} {text}: {found:?}");
    }
    assert_eq!(found.len(), expected.len(), "{found:?}");
}
