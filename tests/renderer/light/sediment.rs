//! Clouds of sediment in the plan: drawn where they may be visible, skipped where they cannot.

use optics::plan::StageId;
use renderer::{SceneSource, Slot};
use serde_json::{Value, json};

use crate::common::{Files, engine_without_runtime, file, pixels, render};

fn with_clouds(sediment: &Value) -> Value {
    json!({"water": {"optics": "jerlov-1C", "snow": {"density_per_m3": 0}, "sediment": sediment}})
}

fn line(plan: &Value) -> Option<&Value> {
    let mut stages = plan.as_array().unwrap().iter();
    stages.find(|stage| stage["stage"] == "sediment")
}

#[test]
fn clouds_in_view_have_a_line_with_their_cost_and_change_the_picture() {
    let files = Files::new();
    let clear = render(&files.job(&json!({"water": {"optics": "jerlov-1C"}})));
    assert_eq!(line(&clear.record.plan), None);
    let banks = json!({"cover": 0.8, "above_bottom_m": 0.6});
    for sediment in [banks, json!({"cover": 0, "thrusters": 4})] {
        let murky = render(&files.job(&with_clouds(&sediment)));
        let line = line(&murky.record.plan).unwrap();
        assert_eq!(line["variant"], "rays");
        assert!(line["cost_ms"].as_f64() > Some(0.0) && line["share"].as_f64() > Some(0.0));
        assert_eq!(line.get("bound"), None, "edges between rays have no bound");
        assert_eq!(line["model_error"], "not measured");
        assert_ne!(file(&murky, "rgb"), file(&clear, "rgb"));
        assert!(murky.record.optics["sediment"]["cover"].as_f64() > Some(0.01));
        let stages = murky.record.plan.as_array().unwrap();
        let names: Vec<_> = stages
            .iter()
            .map(|stage| stage["stage"].as_str().unwrap())
            .collect();
        let at = |name: &str| names.iter().position(|other| *other == name).unwrap();
        assert!(at("glow") < at("sediment") && at("sediment") < at("snow"));
    }
    let mut exact = with_clouds(&json!({}));
    exact["fidelity"] = json!("reference");
    let exact = render(&files.job(&exact));
    assert_eq!(line(&exact.record.plan).unwrap()["variant"], "reference");
}

#[test]
fn clouds_that_cannot_matter_are_skipped_and_cost_nothing() {
    let files = Files::new();
    let clear = render(&files.job(&json!({"water": {"optics": "jerlov-1C"}})));
    for sediment in [
        json!({"cover": 0}),
        json!({"extinction_per_m": 0, "thrusters": 3}),
        json!({"above_bottom_m": 50}),
        json!({"extinction_per_m": 1e-7, "cover": 1, "thrusters": 2}),
    ] {
        let same = render(&files.job(&with_clouds(&sediment)));
        let line = line(&same.record.plan).unwrap();
        assert_eq!(
            (&line["variant"], &line["cost_ms"]),
            (&json!("skip"), &json!(0.0)),
            "{sediment}"
        );
        assert!(
            line["bound"].as_f64() <= line["share"].as_f64(),
            "{sediment}: {line}"
        );
        if line["bound"] == json!(0.0) {
            assert_eq!(file(&same, "rgb"), file(&clear, "rgb"), "{sediment}");
        }
        // A share of the tolerance that the clouds take may leave the water other kernels.
        let codes = pixels(&same, "rgb").into_iter().zip(pixels(&clear, "rgb"));
        let apart = codes.map(|(one, other)| one.abs_diff(other)).max();
        assert!(apart <= Some(1), "{sediment}: {apart:?}");
        assert_eq!(same.record.optics["sediment"]["cover"], 0.0);
    }
}

/// Cameras at any height and angle over any bank: if the plan skips the clouds, the reference changes by at most the stated bound.
#[test]
fn what_is_skipped_is_not_there_in_the_reference_either() {
    let files = Files::new();
    let uniform = |least: f64, most: f64| json!({"uniform": [least, most]});
    let sediment = json!({"cover": uniform(0.0, 1.0), "height_m": uniform(0.05, 1.5), "above_bottom_m": uniform(0.1, 6.0),
                          "extinction_per_m": {"log_uniform": [1e-6, 10.0]}});
    let up = json!([uniform(-0.3, 0.3), -1.0, uniform(-1.0, 1.0)]);
    let fields = |fidelity: Value| {
        files.job(
            &json!({"count": 60, "seed": 3, "camera": {"up": up}, "water": {"sediment": sediment},
                          "fidelity": fidelity}),
        )
    };
    let jobs = [json!({"tolerance": 3e-4}), json!("reference")].map(fields);
    let air = files.job(&json!({"fidelity": "reference"}));
    let mut slot = Slot::new(&engine_without_runtime());
    let plain = slot
        .linear(&air.resolve(0).unwrap(), &SceneSource::Local)
        .unwrap()
        .radiance;
    let (mut skipped, mut drawn) = (0, 0);
    for index in 0..60 {
        let [fast, exact] = jobs.each_ref().map(|job| job.resolve(index).unwrap());
        let plan = slot.plan(&fast, &SceneSource::Local).unwrap();
        let Some(bound) = plan.stage(StageId::Sediment).unwrap().bound else {
            drawn += 1;
            continue;
        };
        skipped += 1;
        let murky = slot.linear(&exact, &SceneSource::Local).unwrap().radiance;
        let pairs = plain.planes().iter().zip(murky.planes());
        let changes = pairs.flat_map(|(a, b)| {
            a.data()
                .iter()
                .zip(b.data())
                .map(|(a, b)| f64::from((a - b).abs()))
        });
        let most = changes.fold(0.0, f64::max);
        let bound = bound.absolute;
        // The reference stores its light in f32.
        assert!(
            most <= bound + f64::from(f32::EPSILON),
            "frame {index}: {most:e} above {bound:e}"
        );
    }
    assert!(skipped > 10 && drawn > 10, "{skipped} skipped, {drawn} drawn");
}
