//! Daylight in whole frames: pictures, plans and records.

use serde_json::{Value, json};

use crate::common::{file, parse, render};

/// A structure 6 m deep under this sky.
fn job(daylight: &Value) -> Value {
    json!({
        "scene": {"kind": "procedural", "family": "structure", "seed": 3},
        "camera": {"width": 96, "height": 64},
        "water": {"depth_m": 6, "optics": "jerlov-1C"},
        "daylight": daylight,
        "fidelity": {"tolerance": 3e-4},
        "metrics": [],
        "artifacts": ["rgb"]
    })
}

/// The same as a picture that contains its illumination.
fn in_air(daylight: &Value) -> Value {
    let mut job = job(daylight);
    job["scene"]["lighting"] = json!("in_air");
    job
}

fn sky(cloud_cover: f64) -> Value {
    json!({"sun_elevation_deg": 50, "sun_azimuth_deg": 70, "cloud_cover": cloud_cover, "wind_m_per_s": 5})
}

/// Mean code of a range of rows of a picture.
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
    let open = |mut job: Value| {
        job["scene"]["family"] = json!("open-water");
        job
    };
    let day = render(&parse(&open(job(&json!("auto")))));
    let mut given = open(in_air(&json!("auto")));
    given["water"]["optics"] = json!({"preset": "jerlov-1C", "veil_gain": 1});
    let constant = render(&parse(&given));
    let slope = |rendered| mean(file(rendered, "rgb"), 0..10) - mean(file(rendered, "rgb"), 54..64);
    assert!(
        slope(&day) > slope(&constant) + 5.0,
        "{} {}",
        slope(&day),
        slope(&constant)
    );
    let record = &day.record;
    for name in ["horizon", "diffuse_attenuation_per_m"] {
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
    let veil = line(&day, "veil").unwrap();
    assert_eq!(veil["variant"], "by_direction");
    assert!(
        veil["bound"].as_f64().unwrap() > 0.0 && veil["cost_ms"].as_f64().unwrap() >= 0.0,
        "{veil}"
    );
    assert!(veil["model_error"].is_string());
    assert!(line(&constant, "veil").is_none());
}

#[test]
fn by_default_the_veil_is_much_darker_than_the_published_convention() {
    let mut given = in_air(&json!("auto"));
    given["water"]["optics"] = json!({"preset": "jerlov-1C", "veil_gain": 1});
    let (day, constant) = (render(&parse(&job(&json!("auto")))), render(&parse(&given)));
    let light = |rendered: &renderer::Rendered| rendered.record.optics["veiling_light"][2].as_f64().unwrap();
    assert!(light(&day) < 0.3 * light(&constant), "{}", light(&day));
}

/// Mean linear light of a range of rows of a layer.
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

fn line<'a>(rendered: &'a renderer::Rendered, stage: &str) -> Option<&'a Value> {
    let lines = rendered.record.plan.as_array().unwrap();
    lines.iter().find(|line| line["stage"] == stage)
}

#[test]
fn reflectance_is_lit_by_the_sky_and_by_lamps() {
    let lamp = json!([{"kind": "point", "position_m": [0.5, 0, 0], "intensity": [2, 2, 2]}]);
    let level = |daylight: Value, lights: &Value| {
        let mut job = job(&daylight);
        job["lights"] = lights.clone();
        job["artifacts"] = json!(["rgb", "direct"]);
        light(file(&render(&parse(&job)), "direct"), 20..64)
    };
    let by_sky = level(sky(1.0), &json!([]));
    let by_lamp = level(json!("none"), &lamp);
    let both = level(sky(1.0), &lamp);
    assert!(
        by_sky > 0.003 && by_lamp > 1e-4 && both > by_sky.max(by_lamp),
        "{by_sky} {by_lamp} {both}"
    );
}

#[test]
fn a_record_says_how_surfaces_are_lit_and_the_reference_agrees() {
    let frame = |fidelity: Value| {
        let mut job = job(&sky(1.0));
        job["camera"] = json!({"width": 48, "height": 32});
        job["fidelity"] = fidelity;
        render(&parse(&job))
    };
    let (fast, reference) = (frame(json!({"tolerance": 3e-4})), frame(json!("reference")));
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
    let apart = apart(&fast, &reference, 6);
    // Ambient occlusion is interpolated between its rays.
    assert!(apart < 0.05, "{apart}");
}

/// The share of codes that differ by more than `most`.
fn apart(one: &renderer::Rendered, other: &renderer::Rendered, most: u8) -> f64 {
    let [one, other] = [one, other].map(|rendered| {
        let picture = imaging::codec::decode_picture(file(rendered, "rgb")).unwrap();
        picture.to_rgb8().pixels().flatten().collect::<Vec<u8>>()
    });
    let far = one.iter().zip(&other).filter(|(a, b)| a.abs_diff(**b) > most);
    far.count() as f64 / one.len() as f64
}

#[test]
fn a_picture_takes_the_color_of_its_depth() {
    let of_depth = |depth_m: f64| {
        let mut job = in_air(&sky(1.0));
        job["water"]["depth_m"] = json!(depth_m);
        render(&parse(&job)).record.optics["radiance_gain"].clone()
    };
    let (shallow, deep) = (of_depth(1.0), of_depth(10.0));
    assert!(deep[0].as_f64() < shallow[0].as_f64(), "{deep} {shallow}");
    assert!(
        deep.as_array().unwrap().contains(&json!(1.0)),
        "exposed for the brightest channel: {deep}"
    );
}

#[test]
fn the_sun_draws_shadows_caustics_and_shafts() {
    let frame = |cloud_cover: f64, wind: f64| {
        let mut sky = sky(cloud_cover);
        sky["wind_m_per_s"] = json!(wind);
        let mut job = job(&sky);
        job["artifacts"] = json!(["rgb", "direct", "backscatter"]);
        render(&parse(&job))
    };
    let (sunny, overcast, rough) = (frame(0.0, 5.0), frame(1.0, 5.0), frame(0.0, 15.0));
    for (rendered, stage, variant) in [
        (&sunny, "sun_shadow", "rays"),
        (&sunny, "caustics", "tiles"),
        (&overcast, "ambient_access", "rays"),
    ] {
        let own = line(rendered, stage).unwrap();
        assert_eq!(own["variant"], variant, "{own}");
        assert!(own["cost_ms"].as_f64().unwrap() > 0.0, "{own}");
    }
    assert!(line(&overcast, "sun_shadow").is_none() && line(&overcast, "caustics").is_none());
    assert!(sunny.record.optics["daylight"]["caustics_peak"].as_f64().unwrap() > 1.2);
    assert!(sunny.record.optics["daylight"]["deepest_m"].as_f64().unwrap() > 6.0);
    for kind in ["direct", "backscatter"] {
        assert_ne!(file(&sunny, kind), file(&rough, kind), "{kind}");
    }
}

#[test]
fn a_hidden_sun_needs_no_rays_and_no_waves() {
    let rendered = render(&parse(&job(&sky(0.999_999))));
    for stage in ["sun_shadow", "caustics"] {
        let own = line(&rendered, stage).unwrap();
        assert_eq!(
            (&own["variant"], &own["cost_ms"]),
            (&json!("skip"), &json!(0.0)),
            "{own}"
        );
    }
}

#[test]
fn the_reference_draws_the_same_shadows_and_waves() {
    let frame = |fidelity: Value| {
        let mut job = job(&sky(0.0));
        job["camera"] = json!({"width": 48, "height": 32});
        job["fidelity"] = fidelity;
        render(&parse(&job))
    };
    let apart = apart(&frame(json!({"tolerance": 3e-4})), &frame(json!("reference")), 6);
    // Sky rays are sparse between pixels, and shadows have edges.
    assert!(apart < 0.05, "{apart}");
}
