//! Sites: expansion, overrides, mixed jobs and their canonical form.

use serde_json::{Value, json};
use spec::{FieldError, Job, SITES, SitePreset, Vocabulary};

use crate::common;

fn vocabulary() -> Vocabulary {
    let names = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect();
    Vocabulary {
        families: names(&["structure", "shaft", "pipeline"]),
        presets: names(&[
            "jerlov-IB/williamson2022",
            "jerlov-II/williamson2022",
            "jerlov-1C/williamson2022",
            "jerlov-3C/williamson2022",
            "jerlov-7C/solonenko2015",
            "jerlov-IB/solonenko2015",
        ]),
        ..common::vocabulary(false)
    }
}

fn parse(document: &Value) -> Result<Job, Vec<FieldError>> {
    Job::parse(document.to_string().as_bytes(), &vocabulary()).map_err(|invalid| invalid.0)
}

fn job(document: &Value) -> Job {
    parse(document).unwrap_or_else(|errors| panic!("{document}\n{errors:#?}"))
}

pub(super) fn errors(document: &Value) -> Vec<FieldError> {
    parse(document).expect_err("the job has errors")
}

fn parameters(job: &Job, frame: u64) -> Value {
    job.resolve(frame).unwrap().parameters
}

pub(super) fn mixed() -> Value {
    json!({
        "site": {"choice": ["harbour-wall", "shaft"], "weights": [2, 1]}, "count": 600, "seed": 3,
        "dataset": "two-places", "camera": {"hfov_deg": {"uniform": [60, 80]}},
    })
}

#[test]
fn every_shipped_site_is_a_complete_job() {
    for site in SITES {
        let job = job(&json!({"site": site.name, "count": 100}));
        assert_eq!((job.frames(), job.dataset()), (100, "default"), "{}", site.name);
        assert_eq!(job.warnings(), [""; 0], "{}", site.name);
        let frame = job.resolve(99).unwrap();
        assert_eq!(frame.site.unwrap().name, site.name);
        assert_eq!(frame.parameters["site"], json!({"name": site.name}));
    }
    assert!(SitePreset::find("shaft").is_some() && SitePreset::find("bath").is_none());
}

#[test]
fn a_site_is_the_same_job_as_its_description() {
    let site = SitePreset::find("shaft").unwrap();
    let mut described = Value::from(site.description());
    described["count"] = json!(5);
    let described = job(&described);
    let named = job(&json!({"site": "shaft", "count": 5}));
    for frame in 0..5 {
        let mut parameters = parameters(&named, frame);
        parameters.as_object_mut().unwrap().remove("site");
        assert_eq!(parameters, described.resolve(frame).unwrap().parameters);
    }
}

#[test]
fn objects_are_merged_and_everything_else_is_replaced() {
    let job = job(&json!({
        "site": "harbour-wall",
        "scene": {"seed": 12},
        "camera": {"width": 320, "exposure": {"fixed": 2.0}},
        "water": {"optics": {"backscatter_fraction": 0.02}, "depth_m": 9, "snow": null},
        "lights": [],
        "fidelity": {"tolerance": 0.01},
    }));
    let parameters = parameters(&job, 0);
    let value_at = |pointer: &str| parameters.pointer(pointer).unwrap_or(&Value::Null).clone();
    assert_eq!(value_at("/scene/seed"), 12);
    assert_eq!(
        (value_at("/scene/lighting"), value_at("/scene/ground/scour")),
        (json!("water"), json!(0.5))
    );
    assert_eq!(
        (value_at("/camera/width"), value_at("/camera/height")),
        (json!(320), json!(492))
    );
    // An object with exactly one field is replaced.
    assert_eq!(value_at("/camera/exposure"), json!({"fixed": 2.0}));
    assert_eq!(value_at("/fidelity"), json!({"tolerance": 0.01}));
    // The site's short form is completed.
    assert_eq!(
        value_at("/water/optics"),
        json!({"preset": "jerlov-1C/williamson2022", "backscatter_fraction": 0.02, "phase": "ff"})
    );
    assert_eq!(value_at("/water/depth_m"), 9.0);
    assert_eq!(
        (value_at("/water/snow"), value_at("/lights")),
        (Value::Null, json!([]))
    );
    assert!(value_at("/water/sediment").is_object());
}

#[test]
fn a_law_replaces_the_object_that_it_varies() {
    let water = json!({"optics": "jerlov-3C", "depth_m": 4});
    let job = job(&json!({"site": "tank", "water": {"choice": [water]}}));
    let water = &parameters(&job, 0)["water"];
    assert_eq!(
        water["optics"],
        json!({"preset": "jerlov-3C/williamson2022", "phase": "ff"})
    );
    assert_eq!(
        (&water["range_scale"], water.get("multiple")),
        (&json!(1.0), None)
    );
}

#[test]
fn another_family_or_kind_replaces_the_scene() {
    let pipeline = job(&json!({"site": "harbour-wall", "scene": {"family": "pipeline"}}));
    assert_eq!(
        parameters(&pipeline, 0)["scene"],
        json!({"kind": "procedural", "family": "pipeline", "lighting": "water", "seed": 0})
    );
    let uploaded = job(&json!({
        "site": "paper", "scene": {"kind": "uploaded", "id": "scn_a"}, "camera": null,
    }));
    assert_eq!(
        parameters(&uploaded, 0)["scene"],
        json!({"kind": "uploaded", "id": "scn_a", "lighting": "in_air"})
    );
    assert_eq!(uploaded.uploaded_scene_ids(), ["scn_a"]);
}

#[test]
fn mixed_sites_come_in_the_shares_of_their_weights() {
    let job = job(&mixed());
    let walls = (0..job.frames()).filter(|frame| {
        let parameters = parameters(&job, *frame);
        let is_wall = parameters["site"]["name"] == "harbour-wall";
        assert_eq!(parameters["scene"]["family"] == "structure", is_wall);
        // Only walls are lit by daylight alone, and only some.
        assert!(is_wall || !parameters["lights"].as_array().unwrap().is_empty());
        is_wall
    });
    // 600 frames, share 2/3: the standard deviation is 11.5 frames.
    let walls = walls.count();
    assert!((365..=435).contains(&walls), "{walls} of 600 frames");
}

#[test]
fn a_site_draws_the_same_alone_in_a_mix_and_in_a_longer_job() {
    let short = job(&mixed());
    let mut longer = mixed();
    longer["count"] = json!(5000);
    let longer = job(&longer);
    let mut alone = mixed();
    alone["site"] = json!("shaft");
    let alone = job(&alone);
    let mut shafts = 0;
    for frame in 0..60 {
        let parameters = parameters(&short, frame);
        assert_eq!(parameters, longer.resolve(frame).unwrap().parameters);
        if parameters["site"]["name"] == "shaft" {
            shafts += 1;
            assert_eq!(parameters, alone.resolve(frame).unwrap().parameters);
        }
    }
    assert!(shafts > 5, "{shafts}");
}

#[test]
fn the_canonical_form_holds_every_description_and_is_a_fixed_point() {
    let lone = json!({"site": "harbour-wall", "count": 9, "water": {"optics": "jerlov-3C", "snow": null}});
    let changed = json!({"site": "shaft", "water": {"optics": "jerlov-3C"}, "scene": {"life": null}});
    for document in [
        lone,
        changed,
        mixed(),
        json!({"site": {"grid": ["tank", "tank", "paper"]}}),
    ] {
        let first = job(&document);
        let again = job(&serde_json::from_str(first.canonical()).unwrap());
        let trusted = Job::from_canonical(first.canonical()).unwrap();
        for other in [again, trusted] {
            assert_eq!(first.canonical(), other.canonical());
            assert_eq!(first.digest(), other.digest());
            for frame in 0..first.frames().min(20) {
                assert_eq!(first.resolve(frame), other.resolve(frame));
            }
        }
        let frame = parameters(&first, 0);
        assert_eq!(
            parameters(&job(&frame), 0),
            frame,
            "parameters are a job of one frame"
        );
    }
    let canonical: Value = serde_json::from_str(job(&mixed()).canonical()).unwrap();
    let keys: Vec<_> = canonical.as_object().unwrap().keys().collect();
    assert_eq!(keys, ["count", "dataset", "seed", "site"]);
    assert_eq!(canonical["site"]["weights"], json!([2.0, 1.0]));
    assert_eq!(canonical["site"]["choice"][1]["name"], "shaft");
    assert_eq!(
        canonical["site"]["choice"][1]["camera"]["hfov_deg"],
        json!({"uniform": [60.0, 80.0]})
    );
}

#[test]
fn a_grid_of_sites_enumerates_them_and_shares_their_axes() {
    let job = job(&json!({
        "site": {"grid": ["tank", "shaft", "pipeline"]}, "count": 2, "alpha": {"grid": [0.5, 1]},
        "water": {"style": "muddy"}, "labels": {"run": "a"},
    }));
    assert_eq!(job.frames(), 12);
    let cells: std::collections::BTreeSet<_> = (0..6)
        .map(|frame| {
            let frame = parameters(&job, frame);
            format!("{} {}", frame["site"]["name"], frame["alpha"])
        })
        .collect();
    assert_eq!(cells.len(), 6);
    assert_eq!(parameters(&job, 7)["labels"]["run"], "a");
}

#[test]
fn a_job_can_describe_sites_of_its_own() {
    let quay = json!({"name": "quay", "scene": {"kind": "procedural", "family": "structure"}, "alpha": 0.5,
        "water": {"style": "muddy"}});
    let job = job(&json!({"site": {"choice": [quay, "tank"]}, "count": 50, "camera": {"width": 100}}));
    let frames: Vec<_> = (0..50).map(|frame| parameters(&job, frame)).collect();
    let quay = frames
        .iter()
        .find(|frame| frame["site"]["name"] == "quay")
        .unwrap();
    assert_eq!(
        (&quay["alpha"], &quay["camera"]["width"]),
        (&json!(0.5), &json!(100))
    );
    assert!(frames.iter().any(|frame| frame["site"]["name"] == "tank"));
}

#[test]
fn a_path_needs_the_same_site_in_every_frame() {
    let path = json!({"site": {"choice": ["tank", "shaft"]}, "camera": {"path": {"frames": 4}}, "scene": {"seed": 1, "life": null}});
    let error = errors(&path);
    assert!(
        error
            .iter()
            .any(|error| error.message.contains("`site` is drawn for each frame")),
        "{error:#?}"
    );
    let mut grid = path;
    grid["site"] = json!({"grid": ["tank", "shaft"]});
    assert!(parse(&grid).is_ok(), "{:#?}", errors(&grid));
}

#[test]
fn a_field_without_effect_in_a_site_is_refused_for_that_site() {
    let found = errors(&json!({"site": {"choice": ["paper", "tank"]}, "alpha": 0.5}));
    assert_eq!((found.len(), found[0].pointer.as_str()), (1, "/alpha"));
    assert!(found[0].message.starts_with("site `tank`: `alpha`"), "{found:#?}");
}

#[test]
fn a_damaged_canonical_text_is_refused_without_a_panic() {
    let canonical = job(&mixed()).canonical().to_owned();
    for at in 0..canonical.len() {
        if canonical.is_char_boundary(at) {
            assert!(Job::from_canonical(&canonical[..at]).is_err());
        }
    }
    for name in ["scene", "site", "choice", "name", "water"] {
        let _ = Job::from_canonical(&canonical.replace(&format!("\"{name}\""), "\"x\""))
            .map(|job| job.resolve(0));
    }
}
