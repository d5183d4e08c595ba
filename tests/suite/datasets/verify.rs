//! Hashes a stored image and renders it again by the real binary.

use fathom_tests::Service;
use serde_json::{Value, json};

fn job(dataset: &str) -> Value {
    json!({
        "dataset": dataset, "count": 3, "seed": 5,
        "scene": {"kind": "procedural", "family": "structure", "seed": {"int": [0, 99]}},
        "camera": {"width": 96, "height": 64, "hfov_deg": 80},
        "water": {"optics": "jerlov-5C", "style": "muddy"}, "alpha": {"uniform": [0.2, 0.8]},
        "enhance": ["hscm"], "artifacts": ["rgb", "range", "transmittance", "enhanced.hscm"]
    })
}

#[test]
fn an_image_is_intact_and_renders_to_the_same_bytes() {
    let data = tempfile::tempdir().expect("a temporary folder");
    let service = Service::start(data.path(), &["--workers", "1"]);
    let id = service.submit(&job("bay"));
    assert_eq!(service.finished(&id)["state"], "done");
    let (status, quick) = service.post(&format!("/v1/images/{id}/1/verify"), &json!({}));
    assert_eq!(
        (status, &quick["intact"], &quick["reproduced"]),
        (200, &json!(true), &Value::Null),
        "{quick}"
    );
    let (status, found) = service.post(&format!("/v1/images/{id}/1/verify"), &json!({"rerender": true}));
    assert_eq!(status, 200, "{found}");
    assert_eq!(
        (&found["intact"], &found["reproduced"]),
        (&json!(true), &json!(true)),
        "{found}"
    );
    let artifacts = found["artifacts"].as_array().expect("a list");
    assert_eq!(artifacts.len(), 4);
    for artifact in artifacts {
        assert_eq!(
            (&artifact["stored"], &artifact["largest_difference"]),
            (&json!("good"), &json!(0.0)),
            "{found}"
        );
        assert_eq!(artifact["digest"], artifact["rerendered_digest"]);
    }
    assert_eq!(found["differences"], json!([]));
    let (status, _) = service.post(&format!("/v1/images/{id}/9/verify"), &json!({}));
    assert_eq!(status, 404);
    let (status, problem) = service.post(&format!("/v1/images/{id}/1/verify"), &json!({"render": true}));
    assert_eq!(
        (status, &problem["type"]),
        (400, &json!("/problems/invalid-body")),
        "{problem}"
    );
}
