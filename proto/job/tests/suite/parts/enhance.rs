//! Enhancements of a description: their fields, names and artifacts.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use imaging::Plane;
use imaging::codec::encode_png;
use serde_json::{Value, json};

use crate::common::{document_with, errors, job, job_with, only_error};

#[test]
fn an_artifact_of_a_method_needs_the_method() {
    assert!(
        only_error(json!({"artifacts": ["enhanced.hscm"]}))
            .message
            .contains("needs \"hscm\" in `enhance`")
    );
    assert_eq!(
        only_error(json!({"enhance": ["ulap"], "artifacts": ["rgb", "enhanced.hscm.mask"]})).pointer,
        "/artifacts/1"
    );
    let sometimes = json!({"enhance": [{"choice": ["hscm", "ulap"]}], "artifacts": ["enhanced.hscm"]});
    assert_eq!(only_error(sometimes).pointer, "/artifacts/0");
}

#[test]
fn an_enhancement_is_refused_at_the_field_that_is_wrong() {
    let method = |fields: Value| {
        let mut hscm = json!({"method": "hscm"});
        hscm.as_object_mut()
            .unwrap()
            .extend(fields.as_object().unwrap().clone());
        json!({"enhance": [hscm]})
    };
    for (fields, pointer, text) in [
        (json!({"cut_off": 16}), "/enhance/0/cut_off", "no field `cut_off`"),
        (
            json!({"guide_eps": 0.1}),
            "/enhance/0/guide_eps",
            "belongs to method \"ulap\"",
        ),
        (json!({"cutoff": 0}), "/enhance/0/cutoff", "above 0"),
        (json!({"median_px": 4}), "/enhance/0/median_px", "must be odd"),
        (
            json!({"median_px": {"int": [3, 5]}}),
            "/enhance/0/median_px",
            "must be odd",
        ),
        (
            json!({"gain_low": 3}),
            "/enhance/0/gain_low",
            "at most `enhance[0].gain_high`, which is 2.5",
        ),
        (
            json!({"tiles": [8]}),
            "/enhance/0/tiles",
            "a list of two whole numbers",
        ),
        (json!({"tiles": [8, 0]}), "/enhance/0/tiles/1", "1..=256"),
        (json!({"mask": "round"}), "/enhance/0/mask", "is not one of"),
        (
            json!({"mask": {"circle": {"radius": -1}}}),
            "/enhance/0/mask/circle/radius",
            "0..=10",
        ),
        (json!({"name": "rgb"}), "/enhance/0/name", "not `rgb`"),
        (
            json!({"cutoff": 16, "delta": 9}),
            "/enhance/0/cutoff",
            "cannot be combined with `enhance[0].delta`",
        ),
        (
            json!({"metrics_over": "mask"}),
            "/enhance/0/metrics_over",
            "add a `mask`",
        ),
        (json!({"name": "a.b"}), "/enhance/0/name", "1 to 32 of"),
    ] {
        let error = only_error(method(fields.clone()));
        assert_eq!(error.pointer, pointer, "{fields}");
        assert!(error.message.contains(text), "{fields}: {}", error.message);
    }
    let steps = |steps: Value| json!({"enhance": [{"name": "mine", "steps": steps}]});
    for (steps, pointer) in [
        (json!([]), "/enhance/0/steps"),
        (json!([{}]), "/enhance/0/steps/0"),
        (json!([{"clahe": {}, "hscm": {}}]), "/enhance/0/steps/0"),
        (json!([{"chain": {}}]), "/enhance/0/steps/0"),
        (json!(vec![json!({"clahe": {}}); 9]), "/enhance/0/steps"),
        (
            json!([{"clahe": {"cutoff": 3}}]),
            "/enhance/0/steps/0/clahe/cutoff",
        ),
    ]
    .map(|(list, pointer)| (steps(list), pointer))
    {
        assert_eq!(only_error(steps.clone()).pointer, pointer, "{steps}");
    }
    let unnamed = json!({"enhance": [{"steps": [{"clahe": {}}]}]});
    assert!(only_error(unnamed).message.contains("a chain without a name"));
}

#[test]
fn a_grid_of_tiles_is_one_error_that_names_tiles_and_a_distribution_stays_one() {
    let design = json!({"method": "hscm", "name": "wide", "cutoff": {"uniform": [16, 64]}, "clip": 2, "grid": [8, 8], "mask": "none"});
    for (entry, pointer) in [
        (design, "/enhance/0/grid"),
        (json!({"method": "clahe", "grid": 8}), "/enhance/0/grid"),
        (
            json!({"name": "mine", "steps": [{"udcp": {}}, {"clahe": {"grid": [8, 8]}}]}),
            "/enhance/0/steps/1/clahe/grid",
        ),
    ] {
        let error = only_error(json!({"enhance": [entry]}));
        assert_eq!(
            (error.pointer.as_str(), error.did_you_mean.as_deref()),
            (pointer, Some("tiles"))
        );
        assert!(error.message.contains("no field `grid`"), "{}", error.message);
    }
    let grid_of_methods = json!({"grid": [{"method": "clahe", "clip": 3}, "hscm"]});
    let grid_of_parameters =
        json!({"name": "mine", "steps": [{"clahe": {"clip": {"grid": [1, 2]}, "tiles": [4, 4]}}]});
    job(&document_with(json!({"enhance": [grid_of_methods]})));
    job(&document_with(json!({"enhance": [grid_of_parameters]})));
    // Methods without tiles keep the message about distributions.
    let error = errors(&document_with(
        json!({"enhance": [{"method": "udcp", "grid": [8, 8]}]}),
    ));
    assert!(error[0].message.contains("`grid` distribution"), "{error:?}");
}

#[test]
fn enhancements_of_a_frame_have_different_names() {
    let wide = |name: &str| json!({"method": "hscm", "name": name, "cutoff": 16});
    let wide_and = |other: Value| json!({"enhance": [wide("wide"), other], "artifacts": ["enhanced.wide"]});
    job(&document_with(wide_and(json!("hscm"))));
    let sometimes = json!({"choice": [wide("other"), wide("wide")]});
    assert_eq!(only_error(wide_and(sometimes)).pointer, "/enhance/1/choice/1");
    assert_eq!(only_error(wide_and(wide("wide"))).pointer, "/enhance/1");
    let same = json!({"enhance": ["hscm", {"method": "hscm", "cutoff": 16}]});
    assert!(only_error(same).message.contains("another `name`"));
    let cutoffs = json!({"choice": [wide("wide"), {"method": "clahe", "name": "wide"}]});
    let common = json!({"enhance": [cutoffs], "artifacts": ["enhanced.wide", "enhanced.wide.median"]});
    assert_eq!(only_error(common).pointer, "/artifacts/1");
}

#[test]
fn a_guide_needs_the_guided_refinement() {
    let ibla = |refine: &str| json!({"enhance": [{"method": "ibla", "refine": refine, "guide_eps": 0.01}]});
    job(&document_with(ibla("guided")));
    job(&document_with(ibla("auto")));
    assert_eq!(only_error(ibla("matting")).pointer, "/enhance/0/guide_eps");
    let step = json!({"enhance": [{"name": "mine", "steps": [{"ibla": {"refine": "matting", "guide_radius_px": 9}}]}]});
    assert!(only_error(step).message.contains("no effect"));
}

#[test]
fn a_drawn_mask_has_the_size_of_every_image() {
    let png = encode_png(&Plane::filled(64, 48, 255u8).into()).unwrap();
    let mask = STANDARD.encode(png);
    let masked =
        |camera: Value| json!({"camera": camera, "enhance": [{"method": "hscm", "mask": {"image": mask}}]});
    job_with(masked(json!({"width": 64, "height": 48})));
    for (camera, sizes) in [
        (json!({"width": 65, "height": 48}), "65×48"),
        (
            json!({"width": 64, "height": {"int": [48, 50]}}),
            "64×48 to 64×50",
        ),
        (
            json!({"width": {"choice": [64, 128]}, "height": 48}),
            "64×48 to 128×48",
        ),
    ] {
        let error = only_error(masked(camera));
        assert_eq!(error.pointer, "/enhance/0/mask/image");
        assert_eq!(error.limit.as_deref(), Some(sizes));
        assert!(
            error.message.contains("the mask has 64×48 pixels"),
            "{}",
            error.message
        );
    }
    let error = only_error(json!({"enhance": [{"method": "hscm", "mask": {"image": "robot.png"}}]}));
    assert!(error.message.contains("is not base64"), "{}", error.message);
}

#[test]
fn a_network_of_one_size_needs_images_of_that_size() {
    let enhanced = |model: &str, camera: &Value| {
        let steps = json!({"name": "mine", "steps": [{"clahe": {}}, {"onnx": {"model": model}}]});
        json!({"camera": camera, "enhance": [{"method": "onnx", "model": model}, steps]})
    };
    let fitting = json!({"width": 64, "height": 48});
    job_with(enhanced("for-64x48", &fitting));
    for (camera, sides) in [
        (json!({"width": 64, "height": 50}), "`camera.height` can be 50"),
        (
            json!({"width": {"int": [64, 65]}, "height": {"choice": [40, 48]}}),
            "`camera.width` can be 65 and `camera.height` can be 40",
        ),
    ] {
        job_with(enhanced("for-any", &camera));
        let found = errors(&document_with(enhanced("for-64x48", &camera)));
        let pointers: Vec<_> = found.iter().map(|error| error.pointer.as_str()).collect();
        assert_eq!(pointers, ["/enhance/0/model", "/enhance/1/steps/1/onnx/model"]);
        assert_eq!(found[0].limit.as_deref(), Some("only with pictures of 64×48"));
        assert!(found[0].message.contains(sides), "{}", found[0].message);
    }
}
