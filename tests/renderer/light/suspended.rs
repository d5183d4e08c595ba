//! Snow and patches of turbidity in a job: their effects and records.

use imaging::codec::{Radiance, decode_radiance};
use renderer::{Rendered, SceneSource, Slot};
use serde_json::{Value, json};

use crate::common::{Files, engine_without_runtime, file, parse, render};

/// Rounding of f32 in the airlight and in the sum of the layers, relative to the brightest sample.
const ROUNDING: f32 = 1e-5;

/// An effect is omitted if fewer than 0.1 % of the pixels change by more than two codes; rounding may add one.
const ALLOWED_CODES: u8 = 3;

fn snow() -> Value {
    json!({"density_per_m3": 400.0, "radius_m": 0.004, "near_m": 0.3, "far_m": 6.0, "albedo": [1, 1, 1]})
}

fn codes(bytes: &[u8]) -> Vec<u8> {
    let Radiance::Encoded(raster) = decode_radiance(bytes).unwrap() else {
        panic!("a picture of codes");
    };
    raster.to_rgb8().data().to_vec()
}

fn stage<'a>(plan: &'a Value, name: &str) -> &'a Value {
    let stages = plan.as_array().unwrap();
    stages.iter().find(|stage| stage["stage"] == name).unwrap()
}

#[test]
fn snow_whitens_the_picture_where_its_mask_says_and_leaves_the_range_alone() {
    let files = Files::new();
    let water = |snow: Value| json!({"optics": "jerlov-3C", "snow": snow});
    let frame =
        |snow| json!({"water": water(snow), "artifacts": ["scattered", "range", "direct", "snow_mask"]});
    let with = render(&files.job(&frame(snow())));
    let none = render(&files.job(&frame(json!({"density_per_m3": 0}))));
    assert_eq!(file(&with, "range"), file(&none, "range"));
    assert_eq!(file(&with, "direct"), file(&none, "direct"));
    let (before, after) = (codes(file(&none, "scattered")), codes(file(&with, "scattered")));
    let mask = codes(file(&with, "snow_mask"));
    assert!(codes(file(&none, "snow_mask")).iter().all(|&code| code == 0));
    assert!(mask.iter().filter(|&&code| code > 60).count() > 30);
    for i in 0..mask.len() {
        assert!(mask[i] > 0 || before[i].abs_diff(after[i]) <= 6, "{i}");
        assert!(mask[i] < 60 || before[i] != after[i], "{i}");
    }
    let snow = &with.record.optics["snow"];
    assert!(snow["particles"].as_u64().unwrap() > 50 && snow["cover"].as_f64().unwrap() > 0.01);
    assert_eq!(stage(&with.record.plan, "snow")["variant"], "discs");
    assert_eq!(stage(&none.record.plan, "snow")["variant"], "skip");
    assert!(with.record.timings_ms.contains_key("snow"));
}

#[test]
fn patches_replace_the_range_in_the_water_and_only_there() {
    let files = Files::new();
    let frame = |more: Value| {
        let mut water = json!({"optics": "jerlov-3C"});
        water
            .as_object_mut()
            .unwrap()
            .extend(more.as_object().unwrap().clone());
        render(&files.job(&json!({"water": water, "artifacts": ["rgb", "range", "transmittance"]})))
    };
    let (even, patchy) = (
        frame(json!({})),
        frame(json!({"turbidity": {"contrast": 0.9, "scale_m": 0.5}})),
    );
    assert_eq!(file(&even, "range"), file(&patchy, "range"));
    assert_ne!(file(&even, "rgb"), file(&patchy, "rgb"));
    assert_ne!(file(&even, "transmittance"), file(&patchy, "transmittance"));
    let none = frame(json!({"turbidity": {"contrast": 0}}));
    assert_eq!(file(&even, "rgb"), file(&none, "rgb"));
    let factors = &patchy.record.optics["turbidity"];
    let number = |name: &str| factors[name].as_f64().unwrap();
    assert!(
        number("least") < number("mean") && number("mean") < number("most"),
        "{factors}"
    );
    assert!(number("least") > 0.1 && number("most") < 4.7);
    assert_eq!(stage(&patchy.record.plan, "turbidity")["variant"], "closed_form");
    assert!(!even.record.optics.contains_key("turbidity"));
}

#[test]
fn with_everything_in_the_water_the_shares_add_up_to_the_tolerance() {
    let files = Files::new();
    let frame = |fidelity: Value| {
        let lamp = json!({"kind": "point", "position_m": [0.3, 0.0, 0.0], "intensity": [3.0, 3.0, 3.0]});
        let water =
            json!({"optics": "jerlov-3C", "snow": snow(), "turbidity": {"contrast": 0.7, "scale_m": 1.0}});
        let fields = json!({"water": water, "lights": [lamp], "fidelity": fidelity,
                            "artifacts": ["scattered", "snow_mask"]});
        render(&files.job(&fields))
    };
    let exact = frame(json!("reference"));
    for tolerance in [3e-4, 1e-3] {
        let fast = frame(json!({"tolerance": tolerance}));
        let bound = |name: &str| stage(&fast.record.plan, name)["bound"].as_f64().unwrap();
        let others: f64 = ["turbidity", "lamps", "glow", "snow"].map(bound).iter().sum();
        for channel in ["r", "g", "b"] {
            let sum = bound(&format!("forward_scatter.{channel}")) + others;
            assert!(sum <= tolerance, "{channel}: {sum:e} of {tolerance:e}");
        }
        if tolerance == 3e-4 {
            for kind in ["scattered", "snow_mask"] {
                let pairs = codes(file(&fast, kind))
                    .into_iter()
                    .zip(codes(file(&exact, kind)));
                let far = pairs
                    .into_iter()
                    .filter(|(a, b)| a.abs_diff(*b) > ALLOWED_CODES)
                    .count();
                assert!(1000 * far <= codes(file(&exact, kind)).len(), "{kind}: {far}");
            }
        }
    }
    let variants =
        ["turbidity", "lamps", "glow", "snow"].map(|name| stage(&exact.record.plan, name)["variant"].clone());
    assert_eq!(variants, ["reference"; 4]);
}

/// Samples of the sum of all layers.
fn layers(rendered: &Rendered) -> Vec<f32> {
    let layer = |kind: &str| {
        let Radiance::Linear(layer) = decode_radiance(file(rendered, kind)).unwrap() else {
            panic!("{kind} is a linear layer");
        };
        let planes = layer.into_planes().into_iter();
        planes.flat_map(imaging::Plane::into_data).collect::<Vec<f32>>()
    };
    let mut sum = layer("direct");
    for kind in ["forward_scatter", "backscatter"] {
        sum.iter_mut()
            .zip(layer(kind))
            .for_each(|(sum, light)| *sum += light);
    }
    sum
}

/// Random waters, lamps, patches and snow: the bound of the plan holds for all of them combined.
#[test]
fn whatever_is_in_the_water_no_error_exceeds_the_bounds_of_the_plan() {
    let uniform = |least: f64, most: f64| json!({"uniform": [least, most]});
    let place = json!([uniform(-0.8, 0.8), uniform(-0.5, 0.5), uniform(-0.3, 2.5)]);
    let light = json!({"log_uniform": [0.05, 10.0]});
    let mut falling = snow();
    falling["density_per_m3"] = json!({"log_uniform": [1.0, 400.0]});
    let files = Files::new();
    let fields = |fidelity: Value| {
        json!({"count": 10, "seed": 11, "fidelity": fidelity,
            "water": {"optics": {"choice": ["jerlov-IB", "jerlov-1C", "jerlov-3C", "jerlov-7C"]}, "snow": falling.clone(),
                      "turbidity": {"contrast": uniform(0.0, 0.95), "scale_m": {"log_uniform": [0.2, 10.0]}}},
            "lights": [{"kind": "point", "position_m": place, "intensity": [light, light, light]},
                       {"kind": "spot", "position_m": place, "intensity": [light, light, light],
                        "direction": [uniform(-0.5, 0.5), uniform(-0.5, 0.5), 1.0], "cone_deg": uniform(5.0, 80.0)}],
            "artifacts": ["direct", "forward_scatter", "backscatter", "scattered"]})
    };
    let tolerance = 3e-4;
    let [fast, exact] =
        [json!({"tolerance": tolerance}), json!("reference")].map(|of| files.job(&fields(of)));
    for index in 0..10 {
        let [fast, exact] = [&fast, &exact].map(|job| {
            let mut slot = Slot::new(&engine_without_runtime());
            let frame = job.resolve(index).unwrap();
            slot.render(&frame, &SceneSource::Local).unwrap()
        });
        let bound = |name: &str| stage(&fast.record.plan, name)["bound"].as_f64().unwrap();
        let before_snow: f64 = ["turbidity", "lamps", "glow"].map(bound).iter().sum();
        let (ours, exactly) = (layers(&fast), layers(&exact));
        let pixels = ours.len() / 3;
        let brightest = exactly.iter().copied().fold(1.0, f32::max);
        let mut whole: f64 = 0.0;
        for (channel, name) in ["r", "g", "b"].into_iter().enumerate() {
            let promised = bound(&format!("forward_scatter.{name}")) + before_snow;
            whole = whole.max(promised + bound("snow"));
            let of = channel * pixels..(channel + 1) * pixels;
            let pairs = ours[of.clone()].iter().zip(&exactly[of]);
            let error = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            assert!(
                f64::from(error) <= promised + f64::from(ROUNDING * brightest),
                "frame {index}, {name}: {error:e} above {promised:e}"
            );
        }
        let pairs = codes(file(&fast, "scattered"))
            .into_iter()
            .zip(codes(file(&exact, "scattered")));
        let most = pairs.into_iter().map(|(a, b)| a.abs_diff(b)).max();
        // Next to a lamp the light is so bright that rounding alone is above the tolerance.
        let says_why = fast
            .record
            .warnings
            .iter()
            .any(|warning| warning.starts_with("the plan exceeds the tolerance"));
        assert_eq!(
            whole > tolerance * 1.000_001,
            says_why,
            "frame {index}: {whole:e}"
        );
        assert!(brightest > 3.0 || most <= Some(1), "frame {index}: {most:?}");
    }
}

/// Faint and bright lamps, lax and strict tolerances: either the bounds sum to at most the tolerance, or the plan states the reason.
#[test]
fn the_bounds_add_up_to_the_tolerance_or_the_plan_says_why() {
    let uniform = |least: f64, most: f64| json!({"uniform": [least, most]});
    let place = json!([uniform(-0.8, 0.8), uniform(-0.5, 0.5), uniform(-0.3, 2.5)]);
    let light = json!({"log_uniform": [1e-3, 3.0]});
    let files = Files::new();
    let mut slot = Slot::new(&engine_without_runtime());
    let (mut kept, mut explained) = (0, 0);
    for tolerance in [1e-6, 3e-5, 3e-4, 1e-2] {
        let job = files.job(&json!({"count": 12, "seed": 11, "fidelity": {"tolerance": tolerance},
            "water": {"optics": {"choice": ["jerlov-IB", "jerlov-1C", "jerlov-3C", "jerlov-7C"]}, "snow": snow(),
                      "turbidity": {"contrast": uniform(0.0, 0.95), "scale_m": {"log_uniform": [0.2, 10.0]}}},
            "lights": [{"kind": "spot", "position_m": place, "intensity": [light, light, light],
                        "direction": [uniform(-0.5, 0.5), uniform(-0.5, 0.5), 1.0], "cone_deg": uniform(1.0, 80.0)}]}));
        for index in 0..12 {
            let plan = slot
                .plan(&job.resolve(index).unwrap(), &SceneSource::Local)
                .unwrap();
            let promise = plan.promise().unwrap();
            let says_why = promise.exceeds.is_some();
            assert_eq!(says_why, promise.bound > tolerance * 1.000_001, "{promise:?}");
            let reason = promise.exceeds.unwrap_or_default();
            let has_remedy = ["raise `fidelity.tolerance`", "lower the intensity of the lamps"]
                .iter()
                .any(|remedy| reason.contains(remedy));
            assert_eq!(has_remedy, says_why, "{reason}");
            if says_why { explained += 1 } else { kept += 1 }
        }
    }
    assert!(kept > 4 && explained > 4, "{kept} within, {explained} explained");
}

#[test]
fn frames_of_a_path_share_their_particles_and_others_do_not() {
    let job = |camera: Value| {
        parse(
            &json!({"scene": {"kind": "procedural", "family": "structure", "seed": 3}, "count": 2, "seed": 5,
                      "metrics": [], "camera": camera, "artifacts": ["snow_mask"],
                      "water": {"optics": "jerlov-3C", "snow": snow()}}),
        )
    };
    let camera = json!({"width": 48, "height": 32});
    let mut on_path = camera.clone();
    on_path["path"] = json!({"frames": 9, "frame": 4});
    let masks = |camera: &Value| {
        let (job, source) = (job(camera.clone()), SceneSource::Local);
        [0, 1].map(|index| {
            let mut slot = Slot::new(&engine_without_runtime());
            let rendered = slot.render(&job.resolve(index).unwrap(), &source).unwrap();
            file(&rendered, "snow_mask").to_vec()
        })
    };
    let [first, second] = masks(&camera);
    assert_ne!(first, second);
    let [first, second] = masks(&on_path);
    assert_eq!(first, second);
}

#[test]
fn a_lens_makes_wide_faint_discs_of_near_particles_and_a_current_draws_them_out() {
    let files = Files::new();
    let frame = |camera: Value, more: Value| {
        let mut snow = json!({"density_per_m3": 3000.0, "radius_m": 0.0015, "near_m": 0.15, "far_m": 1.0,
            "albedo": [1, 1, 1]});
        snow.as_object_mut()
            .unwrap()
            .extend(more.as_object().unwrap().clone());
        let water = json!({"optics": "jerlov-3C", "snow": snow});
        let fields = json!({"camera": camera, "water": water, "artifacts": ["rgb", "snow_mask", "range"]});
        codes(file(&render(&files.job(&fields)), "snow_mask"))
    };
    let covered = |mask: &[u8]| mask.iter().filter(|&&code| code > 0).count();
    let (blurred, sharp) = (json!({"defocus": {"aperture_m": 0.02, "focus_m": 5}}), json!({}));
    let (wide, small) = (frame(blurred.clone(), json!({})), frame(sharp.clone(), json!({})));
    assert!(
        covered(&wide) > covered(&small),
        "{} {}",
        covered(&wide),
        covered(&small)
    );
    assert!(wide.iter().max() < small.iter().max());
    let drift = json!({"drift_m_per_s": [3, 0, 0]});
    assert_ne!(frame(sharp, drift), small);
}

#[test]
fn sixteen_bits_keep_what_eight_round_away() {
    let files = Files::new();
    let of = |bits: u8| {
        let rendered = render(&files.job(&json!({"camera": {"bits": bits}})));
        let Radiance::Encoded(raster) = decode_radiance(file(&rendered, "rgb")).unwrap() else {
            panic!("a picture of codes");
        };
        raster
    };
    let (coarse, deep) = (of(8), of(16));
    // Rounding twice may move a code by one.
    let pairs = coarse
        .to_rgb8()
        .data()
        .to_vec()
        .into_iter()
        .zip(deep.to_rgb8().data().to_vec());
    assert!(pairs.into_iter().all(|(coarse, deep)| coarse.abs_diff(deep) <= 1));
    let imaging::Samples::U16(samples) = deep.samples() else {
        panic!("16 bits were asked for");
    };
    assert!(!samples.is_empty());
}
