use std::collections::BTreeMap;

use serde_json::{Value, json};
use spec::{ArtifactEntry, Counts, Job, Provenance};

use super::*;

fn job(more: Value) -> Job {
    let mut body = json!({"dataset": "x", "scene": {"kind": "procedural", "family": "structure", "seed": 1},
                          "camera": {"width": 100, "height": 50, "hfov_deg": 80}});
    body.as_object_mut()
        .unwrap()
        .extend(more.as_object().unwrap().clone());
    let library = style::Library::embedded().unwrap();
    Job::parse(
        body.to_string().as_bytes(),
        &renderer::vocabulary(&library, false),
    )
    .unwrap()
}

fn cost(costs: &Costs, job: &Job) -> Cost {
    let frame = job.resolve(0).unwrap();
    costs.estimate(&[Sized {
        frame: &frame,
        pixels: 5000.0,
    }])
}

/// Learns a frame of a job with this time and these bytes.
fn learn(costs: &Costs, job: &Job, total_ms: f64, bytes: u64) {
    let frame = job.resolve(0).unwrap();
    let record = FrameRecord {
        frame: 0,
        parameters: json!({"camera": {"width": 100, "height": 50}}),
        optics: serde_json::Map::new(),
        promise: None,
        plan: json!([]),
        measurements: BTreeMap::new(),
        artifacts: vec![ArtifactEntry {
            kind: "rgb".to_owned(),
            digest: String::new(),
            bytes,
            media_type: String::new(),
        }],
        counts: Counts::default(),
        timings_ms: BTreeMap::from([("total".to_owned(), total_ms)]),
        warnings: Vec::new(),
        scene: None,
        truth: None,
        provenance: Provenance::default(),
    };
    costs.learn(&frame, &record);
}

#[test]
fn more_work_costs_more() {
    let costs = Costs::default();
    let plain = cost(&costs, &job(json!({})));
    let water = cost(
        &costs,
        &job(json!({"water": {"optics": "jerlov-3C", "style": "muddy"}})),
    );
    assert!(water.seconds > plain.seconds && water.bytes == plain.bytes);
    let lamp = json!({"kind": "point", "position_m": [0, 0, 0], "intensity": [1, 1, 1]});
    let suspended = [
        (json!({"optics": "jerlov-3C"}), 0),
        (json!({"optics": "jerlov-3C", "snow": {"density_per_m3": 10}}), 0),
        (json!({"optics": "jerlov-3C", "turbidity": {"contrast": 0.5}}), 0),
        (json!({"optics": "jerlov-3C"}), 1),
        (json!({"optics": "jerlov-3C"}), 4),
    ]
    .map(|(water, lamps): (Value, usize)| {
        let lights = vec![lamp.clone(); lamps];
        cost(&costs, &job(json!({"water": water, "lights": lights}))).seconds
    });
    assert!(
        suspended.windows(2).all(|pair| pair[0] < pair[1]),
        "{suspended:?}"
    );
    let layers = cost(&costs, &job(json!({"artifacts": ["rgb", "direct"]})));
    assert!(layers.bytes > plain.bytes + 5000.0 * 11.0);
    let reference = cost(&costs, &job(json!({"fidelity": "reference"})));
    assert!(reference.seconds > 10.0 * plain.seconds);
}

#[test]
fn measured_frames_correct_their_kind_and_no_other() {
    let costs = Costs::default();
    let plain = job(json!({"water": {"optics": "jerlov-3C"}}));
    let lamp = json!({"kind": "point", "position_m": [0, 0, 0], "intensity": [1, 1, 1]});
    let heavy = job(json!({"water": {"optics": "jerlov-3C"}, "lights": vec![lamp; 4]}));
    let before = cost(&costs, &plain);
    for _ in 0..20 {
        learn(&costs, &heavy, 2_000.0, 30_000);
    }
    let learned = cost(&costs, &heavy);
    assert!((learned.seconds - 2.0).abs() < 1e-6, "{learned:?}");
    assert!((learned.bytes - 30_000.0).abs() < 1.0, "{learned:?}");
    assert_eq!(cost(&costs, &plain), before);
    assert!(learned.is_measured && !before.is_measured);
}

#[test]
fn a_single_slow_frame_changes_no_price() {
    let costs = Costs::default();
    let plain = job(json!({}));
    for total_ms in [10.0, 10.0, 90_000.0, 10.0, 10.0] {
        learn(&costs, &plain, total_ms, 1000);
    }
    let learned = cost(&costs, &plain);
    assert!((learned.seconds - 0.01).abs() < 1e-6, "{learned:?}");
}

#[test]
fn a_trace_is_priced_at_its_most_whatever_earlier_ones_took() {
    let costs = Costs::default();
    let traced = job(
        json!({"water": {"optics": "jerlov-1C"}, "artifacts": ["rgb", "truth"],
                            "truth": {"paths_max": 65536}}),
    );
    for _ in 0..9 {
        learn(&costs, &traced, 1.0, 1000);
    }
    let price = cost(&costs, &traced);
    assert!(price.most_seconds > 1900.0, "{price:?}");
}
