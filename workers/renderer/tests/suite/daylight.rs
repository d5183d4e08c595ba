//! Light from above in whole frames: what the record says, and what changes.

use serde_json::{Value, json};

use crate::common::{file, parse, render};

fn job(from_above: &Value) -> Value {
    json!({
        "scene": {"kind": "procedural", "family": "structure", "seed": 3},
        "camera": {"width": 96, "height": 64},
        "water": {"depth_m": 6, "optics": "jerlov-1C", "from_above": from_above},
        "metrics": [],
        "artifacts": ["rgb"]
    })
}

/// Mean code of the rows of a picture from one to another.
fn mean(bytes: &[u8], rows: std::ops::Range<usize>) -> f64 {
    let picture = imaging::codec::decode_picture(bytes).unwrap().to_rgb8();
    let codes: Vec<f64> = picture
        .pixels()
        .skip(96 * rows.start)
        .take(96 * rows.len())
        .flatten()
        .map(f64::from)
        .collect();
    codes.iter().sum::<f64>() / codes.len() as f64
}

#[test]
fn open_water_brightens_towards_the_surface_and_the_record_says_why() {
    let constant = render(&parse(&job(&json!({"veil": "constant"}))));
    let field = render(&parse(&job(&json!({"veil": "field"}))));
    let slope = |rendered| mean(file(rendered, "rgb"), 0..10) - mean(file(rendered, "rgb"), 54..64);
    assert!(
        slope(&field) > slope(&constant) + 5.0,
        "{} {}",
        slope(&field),
        slope(&constant)
    );
    let record = &field.record;
    for name in ["horizon", "p", "q"] {
        assert!(
            record.optics[name]
                .as_array()
                .is_some_and(|numbers| numbers.len() == 3),
            "{name}"
        );
        assert!(
            record.optics["derived"]
                .as_array()
                .unwrap()
                .contains(&json!(name)),
            "{name}"
        );
    }
    let lines = record.plan.as_array().unwrap();
    let veil = lines.iter().find(|line| line["stage"] == "veil").unwrap();
    assert_eq!(veil["variant"], "by_direction");
    assert!(
        veil["bound"].as_f64().unwrap() > 0.0 && veil["cost_ms"].as_f64().unwrap() >= 0.0,
        "{veil}"
    );
    assert!(veil["model_error"].is_string());
    let other = constant.record.plan.as_array().unwrap();
    assert!(other.iter().all(|line| line["stage"] != "veil"));
}

#[test]
fn a_physical_veil_needs_none_and_is_darker_than_the_convention() {
    let field = render(&parse(&job(&json!({"veil": "field"}))));
    let physical = render(&parse(&job(&json!({"veil": "physical"}))));
    let light = |rendered: &renderer::Rendered| rendered.record.optics["veiling_light"][2].as_f64().unwrap();
    assert!(light(&physical) < 0.3 * light(&field), "{}", light(&physical));
    assert_ne!(file(&field, "rgb"), file(&physical, "rgb"));
}

/// Mean linear light of the rows of a layer from one to another.
fn light(bytes: &[u8], rows: std::ops::Range<usize>) -> f64 {
    let imaging::codec::Radiance::Linear(layer) = imaging::codec::decode_radiance(bytes).unwrap() else {
        panic!("a layer of light is linear")
    };
    let rows = rows.flat_map(|y| {
        layer
            .planes()
            .each_ref()
            .map(|plane| plane.row(y).iter().sum::<f32>())
    });
    let sums: Vec<f64> = rows.map(f64::from).collect();
    sums.iter().sum::<f64>() / (96 * sums.len()) as f64
}

fn reflecting(from_above: &Value, lights: &Value) -> Value {
    let mut job = job(from_above);
    job["scene"]["light"] = json!("albedo");
    job["lights"] = lights.clone();
    job
}

fn line<'a>(rendered: &'a renderer::Rendered, stage: &str) -> Option<&'a Value> {
    let lines = rendered.record.plan.as_array().unwrap();
    lines.iter().find(|line| line["stage"] == stage)
}

#[test]
fn reflectance_is_black_until_something_lights_it() {
    let lamp = json!([{"kind": "point", "position_m": [0.5, 0, 0], "intensity": [2, 2, 2]}]);
    let none = json!([]);
    let level = |job: &Value| {
        let mut job = job.clone();
        job["artifacts"] = json!(["rgb", "direct"]);
        light(file(&render(&parse(&job)), "direct"), 20..64)
    };
    let dark = level(&reflecting(&json!({"veil": "field"}), &none));
    let lit = level(&reflecting(&json!({"surfaces": "normal"}), &none));
    let by_lamp = level(&reflecting(&json!({"veil": "field"}), &lamp));
    let both = level(&reflecting(&json!({"surfaces": "normal"}), &lamp));
    assert!(
        dark == 0.0 && lit > 0.003 && by_lamp > 1e-4 && both > lit.max(by_lamp),
        "{dark} {lit} {by_lamp} {both}"
    );
}

#[test]
fn a_record_says_how_surfaces_are_lit_and_both_forms_agree() {
    let surfaces =
        json!({"surfaces": "normal", "sun_share": 0.6, "sun": {"elevation_deg": 40, "azimuth_deg": 100}});
    let of = |fidelity: Value| {
        let mut job = reflecting(&surfaces, &json!([]));
        job["camera"] = json!({"width": 48, "height": 32});
        job["fidelity"] = fidelity;
        render(&parse(&job))
    };
    let (fast, reference) = (
        of(json!({"tolerance": 3e-4})),
        of(json!({"variant": "reference"})),
    );
    let own = line(&fast, "surfaces").unwrap();
    assert_eq!(
        (&own["variant"], &line(&reference, "surfaces").unwrap()["variant"]),
        (&json!("by_normal"), &json!("reference"))
    );
    assert!(
        own["bound"].as_f64().unwrap() > 0.0 && own["cost_ms"].as_f64().unwrap() >= 0.0,
        "{own}"
    );
    assert!(own["model_error"].is_string());
    assert_eq!(line(&fast, "scene_light").unwrap()["variant"], "skip");
    let gain = fast.record.optics["radiance_gain"].as_array().unwrap();
    assert!(
        gain[0].as_f64().unwrap() < 0.5 && gain.contains(&json!(1.0)),
        "{gain:?}"
    );
    let codes = |rendered: &renderer::Rendered| {
        let picture = imaging::codec::decode_picture(file(rendered, "rgb"))
            .unwrap()
            .to_rgb8();
        picture.pixels().flatten().collect::<Vec<u8>>()
    };
    let apart = codes(&fast)
        .into_iter()
        .zip(codes(&reference))
        .filter(|(a, b)| a.abs_diff(*b) > 1);
    // Pixels at the edge of a shadow may differ.
    assert!(apart.count() <= 3 * 8);
}

#[test]
fn a_picture_darkens_with_depth_alone() {
    let lit = |surfaces: &str| {
        let mut job = job(&json!({"surfaces": surfaces}));
        job["artifacts"] = json!(["rgb", "direct"]);
        let rendered = render(&parse(&job));
        assert_eq!(
            line(&rendered, "surfaces").map(|line| line["variant"].clone()),
            (surfaces == "depth").then(|| json!("by_depth"))
        );
        let rows = |rows| light(file(&rendered, "direct"), rows);
        (rows(0..8), rows(56..64))
    };
    let ((top, bottom), (flat_top, flat_bottom)) = (lit("depth"), lit("none"));
    assert!(
        bottom < flat_bottom && bottom / flat_bottom < top / flat_top,
        "{top} {bottom} {flat_top} {flat_bottom}"
    );
}

fn sunny(more: &Value) -> Value {
    let mut above = json!({"surfaces": "normal", "sun_share": 0.7, "sun": {"elevation_deg": 50, "azimuth_deg": 70, "shadow": "none"}});
    for (name, value) in more.as_object().unwrap() {
        above[name] = value.clone();
    }
    let mut job = reflecting(&above, &json!([]));
    job["artifacts"] = json!(["rgb", "direct", "backscatter"]);
    job
}

#[test]
fn shadows_and_rays_to_the_sky_take_light_and_caustics_share_it_out() {
    let of = |more: Value| render(&parse(&sunny(&more)));
    let whole = |rendered: &renderer::Rendered| light(file(rendered, "direct"), 0..64);
    let plain = of(json!({}));
    let shadow = of(json!({"sun": {"elevation_deg": 50, "azimuth_deg": 70}}));
    let access = of(json!({"ambient_rays": 8}));
    let waves = of(json!({"caustics": {}}));
    let (sun, shaded, hidden, drawn) = (whole(&plain), whole(&shadow), whole(&access), whole(&waves));
    assert!(
        shaded < sun && hidden < sun && shaded > 0.2 * sun && hidden > 0.2 * sun,
        "{sun} {shaded} {hidden}"
    );
    assert!((drawn / sun - 1.0).abs() < 0.2 && drawn != sun, "{drawn} {sun}");
    for (rendered, stage, variant) in [
        (&shadow, "sun_shadow", "rays"),
        (&access, "ambient_access", "rays"),
        (&waves, "caustics", "tiles"),
    ] {
        let own = line(rendered, stage).unwrap();
        assert_eq!(own["variant"], variant, "{own}");
        assert!(
            line(&plain, stage).is_none() && own["cost_ms"].as_f64().unwrap() > 0.0,
            "{own}"
        );
    }
    assert!(waves.record.optics["daylight"]["caustics_peak"].as_f64().unwrap() > 1.2);
    assert!(plain.record.optics["daylight"]["deepest_m"].as_f64().unwrap() > 6.0);
    assert_eq!(file(&waves, "backscatter"), file(&plain, "backscatter"));
    let shafts = of(json!({"caustics": {}, "shafts": true}));
    assert_eq!(file(&waves, "direct"), file(&shafts, "direct"));
    assert_ne!(file(&waves, "backscatter"), file(&shafts, "backscatter"));
}

#[test]
fn a_sun_that_hardly_shines_needs_no_rays_and_no_waves() {
    let job = sunny(&json!({"sun_share": 1e-6, "sun": {"elevation_deg": 50}, "caustics": {}}));
    let rendered = render(&parse(&job));
    for stage in ["sun_shadow", "caustics"] {
        let own = line(&rendered, stage).unwrap();
        assert_eq!(own["variant"], "skip", "{own}");
        assert!(own["bound"].as_f64().unwrap() <= own["share"].as_f64().unwrap());
    }
}

#[test]
fn the_form_in_f64_draws_the_same_shadows_and_waves() {
    let of = |fidelity: Value| {
        let mut job = sunny(&json!({"sun": {"elevation_deg": 50}, "caustics": {}, "ambient_rays": 8}));
        job["camera"] = json!({"width": 48, "height": 32});
        job["fidelity"] = fidelity;
        let rendered = render(&parse(&job));
        imaging::codec::decode_picture(file(&rendered, "rgb"))
            .unwrap()
            .to_rgb8()
            .pixels()
            .flatten()
            .collect::<Vec<u8>>()
    };
    let (fast, reference) = (
        of(json!({"tolerance": 3e-4})),
        of(json!({"variant": "reference"})),
    );
    let apart = fast
        .iter()
        .zip(&reference)
        .filter(|(a, b)| a.abs_diff(**b) > 6)
        .count();
    // Rays to the sky are few between pixels, and shadows have edges.
    assert!(20 * apart <= fast.len(), "{apart} of {}", fast.len());
}
