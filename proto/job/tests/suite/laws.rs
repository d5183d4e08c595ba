//! Distributions: known results, independence of one another, grids.

use crate::common::{document_with, job, job_with, parameters};
use imaging::random::Stream;
use serde_json::{Value, json};
use spec::{Encode, Fidelity, law};

/// log and exp of other libraries may differ from `libm` by some units in the last place.
const OTHER_LIBRARY: f64 = 1e-14;

struct Vector {
    seed: u64,
    pointer: String,
    law: Value,
    index: u64,
    bits: u64,
    u: f64,
    value: Value,
}

fn vectors() -> Vec<Vector> {
    let all: Vec<Value> = serde_json::from_str(include_str!("../vectors/laws.json")).unwrap();
    all.iter()
        .map(|vector| Vector {
            seed: vector["seed"].as_u64().unwrap(),
            pointer: vector["pointer"].as_str().unwrap().to_owned(),
            law: vector["law"].clone(),
            index: vector["index"].as_u64().unwrap(),
            bits: u64::from_str_radix(vector["bits"].as_str().unwrap(), 16).unwrap(),
            u: vector["u"].as_f64().unwrap(),
            value: vector["value"].clone(),
        })
        .collect()
}

fn floats(value: &Value) -> Vec<f64> {
    value
        .as_array()
        .unwrap()
        .iter()
        .map(|number| number.as_f64().unwrap())
        .collect()
}

fn same(ours: &Value, published: &Value, exact: bool) -> bool {
    match (ours.as_f64(), published.as_f64()) {
        (Some(a), Some(b)) if !exact => (a - b).abs() <= OTHER_LIBRARY * b.abs(),
        (Some(a), Some(b)) => a == b,
        _ => ours == published,
    }
}

#[test]
fn the_functions_yield_the_published_results() {
    for Vector {
        seed,
        pointer,
        law,
        index,
        bits,
        u,
        value,
    } in vectors()
    {
        let stream = Stream::law(seed, &pointer);
        assert_eq!(stream.bits(index, 0), bits, "{seed} {pointer} {index}");
        assert_eq!(stream.unit(index, 0), u, "{seed} {pointer} {index}");
        let numbers = |key: &str| law.get(key).map(floats);
        let ours = if let Some(ends) = numbers("uniform") {
            json!(law::uniform(u, ends[0], ends[1]))
        } else if let Some(ends) = numbers("log_uniform") {
            json!(law::log_uniform(u, ends[0], ends[1]))
        } else if let Some(ends) = numbers("int") {
            json!(law::int(u, ends[0] as i64, ends[1] as i64))
        } else if let Some(ends) = numbers("normal") {
            let clip = numbers("clip").unwrap();
            json!(law::normal(u, ends[0], ends[1], clip[0], clip[1]))
        } else {
            let values = law["choice"].as_array().unwrap();
            let weights = numbers("weights").unwrap_or_else(|| vec![1.0; values.len()]);
            values[law::choice(u, &weights)].clone()
        };
        let exact = law.get("log_uniform").or(law.get("normal")).is_none();
        assert!(
            same(&ours, &value, exact),
            "{seed} {pointer} {law} {index}: {ours} is not {value}"
        );
    }
}

/// The same results through a whole job: every label can be any distribution.
#[test]
fn a_job_yields_the_published_results() {
    let mut labels = 0;
    for Vector {
        seed,
        pointer,
        law,
        index,
        value,
        ..
    } in vectors()
    {
        let Some(name) = pointer
            .strip_prefix("/labels/")
            .filter(|name| name.is_ascii() && !name.contains('~'))
        else {
            continue;
        };
        let document = document_with(json!({"seed": seed, "count": 100_000_000, "labels": {name: law}}));
        let exact = law.get("log_uniform").or(law.get("normal")).is_none();
        let ours = &parameters(&job(&document), index)["labels"][name];
        assert!(
            same(ours, &value, exact),
            "{seed} {pointer} {index}: {ours} is not {value}"
        );
        labels += 1;
    }
    assert!(labels >= 100, "{labels}");
}

#[test]
fn a_law_inside_a_choice_is_addressed_by_its_place_in_the_description() {
    let ranges = json!({"choice": [{"style": "muddy"}, {"optics": "jerlov-1C", "range_scale": {"uniform": [0.5, 2.0]}}], "weights": [0, 1]});
    let job = job_with(json!({"seed": 42, "count": 64, "water": ranges}));
    let published = vectors();
    let vector = published
        .iter()
        .find(|vector| {
            vector.seed == 42 && vector.pointer == "/water/choice/1/range_scale" && vector.index == 63
        })
        .unwrap();
    assert_eq!(parameters(&job, 63)["water"]["range_scale"], vector.value);
}

#[test]
fn adding_a_law_does_not_change_the_others() {
    let few = json!({"count": 50, "seed": 7, "alpha": {"uniform": [0, 1]}, "water": {"style": "muddy"}});
    let mut more = few.clone();
    more["water"] = json!({"style": {"choice": ["muddy", "atlantic"]}, "range_scale": {"log_uniform": [0.1, 10]}, "optics": "jerlov-1C"});
    more["lights"] = json!([{"kind": "haze", "x": {"uniform": [0, 1]}, "y": 0}]);
    let (few, more) = (job_with(few), job_with(more));
    for index in 0..50 {
        assert_eq!(
            parameters(&few, index)["alpha"],
            parameters(&more, index)["alpha"]
        );
    }
}

#[test]
fn raising_the_count_keeps_the_frames_there_were() {
    let fields = |count: u64| {
        json!({"count": count, "alpha": {"uniform": [0, 1]}, "water": {"style": "muddy"},
            "scene": {"kind": "procedural", "family": "structure", "seed": {"grid": [1, 2, 3]}}})
    };
    let (few, more) = (job_with(fields(5)), job_with(fields(5_000)));
    assert_eq!((few.frames(), more.frames()), (15, 15_000));
    for index in 0..few.frames() {
        assert_eq!(few.resolve(index), more.resolve(index));
    }
    assert!(few.resolve(15).is_err());
}

#[test]
fn the_last_axis_of_a_grid_is_fastest_and_axes_are_sorted_by_pointer() {
    let job = job_with(json!({
        "count": 2,
        "labels": {"b": {"grid": ["x", "y"]}, "a": {"grid": [10, 20, 30]}},
        "alpha": {"grid": [0, 1]},
        "water": {"style": "muddy"},
    }));
    assert_eq!(job.frames(), 24);
    let cell = |index: u64| {
        let frame = parameters(&job, index);
        (
            frame["alpha"].as_f64().unwrap(),
            frame["labels"]["a"].clone(),
            frame["labels"]["b"].clone(),
        )
    };
    let mut expected = Vec::new();
    for alpha in [0.0, 1.0] {
        for a in [10, 20, 30] {
            expected.extend(["x", "y"].map(|b| (alpha, json!(a), json!(b))));
        }
    }
    assert_eq!((0..12).map(cell).collect::<Vec<_>>(), expected);
    assert_eq!((12..24).map(cell).collect::<Vec<_>>(), expected);
}

#[test]
fn every_cell_of_a_grid_draws_its_own_values() {
    let job = job_with(json!({"alpha": {"uniform": [0, 1]}, "labels": {"cell": {"grid": [1, 2, 3, 4]}}}));
    let mut alphas: Vec<_> = (0..4).map(|index| job.resolve(index).unwrap().alpha).collect();
    alphas.sort_by(f64::total_cmp);
    alphas.dedup();
    assert_eq!(alphas.len(), 4);
}

#[test]
fn a_grid_inside_a_choice_counts_and_is_warned_of() {
    let job =
        job_with(json!({"alpha": {"choice": [0.5, {"grid": [0.1, 0.2]}]}, "water": {"style": "muddy"}}));
    assert_eq!(job.frames(), 2);
    assert!(
        job.warnings()[0].contains("/alpha/choice/1"),
        "{:?}",
        job.warnings()
    );
}

#[test]
fn a_choice_may_hold_laws_objects_and_lists() {
    let job = job_with(json!({"count": 200, "seed": 3,
        "alpha": {"choice": [0, {"uniform": [0.5, 1]}]},
        "water": {"style": "muddy", "optics": {"choice": ["jerlov-1C",
            {"beam_attenuation_per_m": {"choice": [[0.1, 0.2, 0.3], [{"uniform": [0.4, 0.5]}, 0.5, 0.6]]},
             "veiling_light": [0, 0, 0]}]}},
        "encode": {"choice": [{"format": "png"}, {"format": "jpeg", "quality": {"int": [50, 60]}}]},
        "fidelity": {"choice": ["reference", {"terms": {"int": [4, 8]}}, {"tolerance": 1e-3}]}}));
    let frames: Vec<_> = (0..200).map(|index| job.resolve(index).unwrap()).collect();
    assert!(frames.iter().any(|frame| frame.alpha == 0.0) && frames.iter().any(|frame| frame.alpha > 0.5));
    assert!(
        frames
            .iter()
            .all(|frame| frame.alpha == 0.0 || frame.alpha >= 0.5)
    );
    let presets = frames
        .iter()
        .filter(|frame| frame.water.optics.as_ref().unwrap().preset.is_some())
        .count();
    assert!((50..150).contains(&presets), "{presets}");
    assert!(
        frames
            .iter()
            .any(|frame| { matches!(frame.encode, Encode::Jpeg { quality: 50..=60 }) })
    );
    assert!(frames.iter().any(|frame| frame.fidelity == Fidelity::Reference));
    assert!(
        frames
            .iter()
            .any(|frame| matches!(frame.fidelity, Fidelity::Terms(4..=8)))
    );
}

#[test]
fn ten_million_frames_are_a_formula() {
    let job =
        job_with(json!({"count": 10_000_000, "alpha": {"uniform": [0, 1]}, "water": {"style": "muddy"}}));
    assert_eq!(job.frames(), 10_000_000);
    assert!((0.0..1.0).contains(&job.resolve(9_999_999).unwrap().alpha));
}
