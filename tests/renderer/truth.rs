//! The truth of whole frames: its artifacts, its record, and daylight on surfaces against closed forms.

use imaging::Plane;
use imaging::codec::{NpyValues, decode_npy, encode_npy_plane, encode_npy_rgb};
use imaging::{Rgb, geometry::Intrinsics};
use renderer::Rendered;
use serde_json::{Value, json};

use crate::common::{Files, engine_without_runtime, file, parse, render, try_render};

/// A lamp in coastal water in front of a structure.
fn lit(beside: &Value) -> Value {
    let mut job = json!({
        "scene": {"kind": "procedural", "family": "structure", "seed": 5},
        "camera": {"width": 16, "height": 12},
        "water": {"optics": {"absorption_per_m": [0.3, 0.2, 0.1], "scattering_per_m": [0.2, 0.2, 0.2],
                  "veiling_light": [0, 0, 0]}},
        "lights": [{"kind": "spot", "position_m": [0.5, -0.2, 0.1], "intensity": [8, 8, 8], "cone_deg": 50}],
        "truth": {"paths_max": 64, "target": 0.001},
        "metrics": [],
        "artifacts": ["truth", "truth_report"]
    });
    for (name, value) in beside.as_object().unwrap() {
        job[name] = value.clone();
    }
    job
}

/// Samples of the six planes, pixel by pixel.
fn samples(rendered: &Rendered) -> (Vec<usize>, Vec<f32>) {
    let array = decode_npy(file(rendered, "truth")).unwrap();
    let NpyValues::F32(values) = array.values else {
        panic!("the truth is not float32");
    };
    (array.shape, values)
}

fn report(rendered: &Rendered) -> Value {
    serde_json::from_slice(file(rendered, "truth_report")).unwrap()
}

#[test]
fn a_frame_is_traced_for_its_artifacts_alone_and_the_same_each_time() {
    let rendered = render(&parse(&lit(&json!({}))));
    let (shape, values) = samples(&rendered);
    assert_eq!(shape, [12, 16, 6]);
    let sum = |plane: usize| {
        values
            .iter()
            .skip(plane)
            .step_by(6)
            .map(|&v| f64::from(v))
            .sum::<f64>()
    };
    assert!(
        (0..6).all(|plane| sum(plane) > 0.0),
        "{:?}",
        (0..6).map(sum).collect::<Vec<_>>()
    );
    let said = report(&rendered);
    assert_eq!(
        (&said["paths"], &said["ended_by"], &said["rays"]),
        (&json!(64), &json!("paths_max"), &json!("scene"))
    );
    assert_eq!(
        said["phase"],
        json!({"kind": "ff", "backscatter_fraction": 0.0183})
    );
    let record = rendered.record.truth.clone().unwrap();
    assert_eq!(
        (record.paths, record.ended_by.as_str(), record.cut),
        (64, "paths_max", 0)
    );
    assert_eq!(json!(record.median_error[1]), said["block_error"][1]["median"]);
    let line = rendered
        .record
        .plan
        .as_array()
        .unwrap()
        .iter()
        .find(|line| line["stage"] == "truth");
    // 192 pixels, 64 paths, three channels, 500 000 in a second.
    let cost = line.unwrap()["cost_ms"].as_f64().unwrap();
    assert!((cost - 73.728).abs() < 1e-9, "{cost}");

    let again = render(&parse(&lit(&json!({}))));
    for kind in ["truth", "truth_report"] {
        assert_eq!(file(&rendered, kind), file(&again, kind), "{kind}");
    }
    let mut plain = lit(&json!({"artifacts": ["rgb"]}));
    plain.as_object_mut().unwrap().remove("truth");
    let plain = render(&parse(&plain));
    assert!(plain.record.truth.is_none() && !plain.record.plan.to_string().contains("\"truth\""));
}

#[test]
fn a_budget_is_paths_and_not_time() {
    // 0.04 s allow 20 000 paths, which is 34 for each of 192 pixels and three channels; the last complete doubling ends at 32.
    let truth = json!({"budget_s": 0.04, "target": 0.001});
    let rendered = render(&parse(&lit(&json!({"truth": truth}))));
    let record = rendered.record.truth.clone().unwrap();
    assert_eq!((record.paths, record.ended_by.as_str()), (32, "budget_s"));
    let exact = json!({"paths_max": 32, "target": 0.001});
    let same = render(&parse(&lit(&json!({"truth": exact}))));
    assert_eq!(file(&rendered, "truth"), file(&same, "truth"));
}

#[test]
fn the_seed_and_the_phase_function_change_the_paths() {
    let first = render(&parse(&lit(&json!({}))));
    let other = render(&parse(&lit(&json!({"seed": 9}))));
    assert_ne!(file(&first, "truth"), file(&other, "truth"));
    let mut job = lit(&json!({}));
    job["water"]["optics"]["phase"] = json!("hg");
    let other = render(&parse(&job));
    assert_ne!(file(&first, "truth"), file(&other, "truth"));
    assert_eq!(report(&other)["phase"]["kind"], json!("hg"));
}

/// A gray floor 2 m below a camera that looks straight down from 4 m, under this sky.
fn floor(files: &Files, sky: &Value, paths: u64) -> Rendered {
    let range = Plane::from_fn(SIDES.0, SIDES.1, |x, y| (FLOOR_M / cosine(x, y)) as f32);
    files.add("floor.npy", encode_npy_plane(&range));
    let gray = Rgb::from_fn(SIDES.0, SIDES.1, |_, _| [GRAY as f32; 3]);
    files.add("gray.npy", encode_npy_rgb(&gray));
    render(&parse(&json!({
        "scene": {"kind": "files", "rgb": files.path("gray.npy"), "range": files.path("floor.npy"), "lighting": "water"},
        "camera": {"up": [0, 0, -1], "hfov_deg": 60},
        "water": {"depth_m": DEPTH_M, "optics": {"absorption_per_m": ABSORPTION, "scattering_per_m": SCATTERING}},
        "daylight": sky,
        "truth": {"paths_max": paths},
        "metrics": [],
        "artifacts": ["truth", "truth_report"]
    })))
}

const SIDES: (usize, usize) = (16, 12);
const FLOOR_M: f64 = 2.0;
const DEPTH_M: f64 = 4.0;
const GRAY: f64 = 0.18;
const ABSORPTION: [f64; 3] = [0.4, 0.3, 0.2];
/// Scattering that is enough to derive the veil, but negligible otherwise.
const SCATTERING: [f64; 3] = [1e-3; 3];
/// Upper bound on light that the floor sends to the surface and that is reflected back: the gray times the reflected share, 0.18 ·
/// 0.48 · e^(−2·6·0.2). The small floor receives only part of it, which is below this.
const RETURNED: f64 = 3e-3;

/// Cosine of the ray of a pixel from the camera's axis.
fn cosine(x: usize, y: usize) -> f64 {
    let focal = 0.5 * SIDES.0 as f64 / 30f64.to_radians().tan();
    let camera = Intrinsics::centered(focal, SIDES.0, SIDES.1);
    camera.ray(x as f64, y as f64).normalized().z
}

/// Mean over the frame of the transmitted `light(channel)` of the floor.
fn expected(light: impl Fn(usize) -> f64) -> [f64; 3] {
    [0, 1, 2].map(|i| {
        let pixels = (0..SIDES.1).flat_map(|y| (0..SIDES.0).map(move |x| (x, y)));
        let arrives: f64 = pixels
            .map(|(x, y)| (-ABSORPTION[i] * FLOOR_M / cosine(x, y)).exp())
            .sum();
        GRAY * light(i) * arrives / (SIDES.0 * SIDES.1) as f64
    })
}

fn means(rendered: &Rendered) -> [(f64, f64); 3] {
    let said = report(rendered);
    [0, 1, 2].map(|i| {
        let level = &said["mean"][i];
        (level["mean"].as_f64().unwrap(), level["error"].as_f64().unwrap())
    })
}

#[test]
fn a_floor_under_an_even_sky_has_the_colors_of_the_closed_form() {
    let overcast =
        json!({"sun_elevation_deg": 45, "sun_azimuth_deg": 0, "cloud_cover": 1, "wind_m_per_s": 0});
    let rendered = floor(&Files::new(), &overcast, 2048);
    // Share of the irradiance just below the surface that reaches the floor: ∫ (1 − R) μ e^(−a z/μ) dμ / ∫ (1 − R) μ dμ.
    let window = |absorption: f64| {
        const STEPS: usize = 200_000;
        let critical = optics::daylight::CRITICAL_COSINE;
        let step = |k: usize| {
            let mu = critical + (1.0 - critical) * (k as f64 + 0.5) / STEPS as f64;
            (1.0 - optics::daylight::fresnel(mu)) * mu * (-absorption * (DEPTH_M + FLOOR_M) / mu).exp()
        };
        (0..STEPS).map(step).sum::<f64>()
    };
    let expected = expected(|i| window(ABSORPTION[i]) / window(0.0));
    let means = means(&rendered);
    // The exposure sets the level, so channels are compared with the last one.
    let ((last, last_error), last_expected) = (means[2], expected[2]);
    for ((mean, error), expected) in means.into_iter().zip(expected) {
        let (ratio, expected) = (mean / last, expected / last_expected);
        let allowed = ratio * (4.0 * (error / mean + last_error / last) + RETURNED);
        assert!(
            (ratio - expected).abs() <= allowed,
            "{ratio} ± {allowed}, expected {expected}"
        );
        assert!(error < 0.02 * mean, "{error} of {mean} tests nothing");
    }
    assert_eq!(report(&rendered)["left_out"][0], json!("waves"));
}

#[test]
fn a_stored_job_with_clouds_of_sediment_is_not_traced() {
    let files = Files::new();
    let job = files.stored_job(&json!({
        "water": {"depth_m": 5, "sediment": {},
                  "optics": {"absorption_per_m": [0.3, 0.2, 0.1], "scattering_per_m": [0.2, 0.2, 0.2]}},
        "truth": {"paths_max": 16, "target": 0.02},
        "artifacts": ["truth"]
    }));
    let error = try_render(&job, &engine_without_runtime()).unwrap_err();
    assert!(
        !error.retryable() && error.to_string().contains("clouds are not traced"),
        "{error}"
    );
}
