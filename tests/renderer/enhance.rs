//! The planned variant of an enhancement.

use optics::plan::StageId;
use renderer::{Rendered, SceneSource, Slot};
use serde_json::{Value, json};

use crate::common::{Files, engine_without_runtime, file, render};

/// `ibla` with the planner's refinement, and with a given one.
fn every() -> Value {
    json!(["ibla", {"method": "ibla", "name": "guided", "refine": "guided"}])
}

fn fields(enhance: &Value, artifacts: &[&str], fidelity: &Value) -> Value {
    json!({"water": {"optics": "jerlov-1C"}, "enhance": enhance, "artifacts": artifacts, "fidelity": fidelity})
}

fn lines(rendered: &Rendered) -> Vec<Value> {
    let lines = rendered.record.plan.as_array().unwrap().iter();
    let of_forms = lines.filter(|line| line["stage"] == "enhance.ibla");
    of_forms.cloned().collect()
}

#[test]
fn a_tolerance_takes_the_fastest_form_of_ibla_that_was_measured_to_be_within_it() {
    let files = Files::new();
    for (fidelity, form) in [
        (json!({"tolerance": 3e-4}), "matting"),
        (json!({"tolerance": 0.169}), "matting"),
        (json!({"tolerance": 0.17}), "guided"),
        (json!({"terms": 4}), "matting"),
        (json!("reference"), "matting"),
    ] {
        // Both use the same picture, and a given refinement is never replaced.
        let kinds = ["enhanced.ibla", "enhanced.guided"];
        let chosen = render(&files.job(&fields(&every(), &kinds, &fidelity)));
        let [ibla, guided] = kinds.map(|kind| file(&chosen, kind));
        assert_eq!(ibla == guided, form == "guided", "{fidelity}");

        let [line] = lines(&chosen).try_into().unwrap();
        assert_eq!(line["variant"], form, "{line}");
        let share = fidelity["tolerance"].as_f64().filter(|_| form != "matting");
        assert_eq!(line["share"].as_f64(), share, "{line}");
        assert!(!line["note"].as_str().unwrap().is_empty());
    }
}

#[test]
fn by_default_a_frame_gets_the_exact_form_of_ibla() {
    let files = Files::new();
    let asked = json!({"water": {"optics": "jerlov-1C"}, "enhance": ["ibla"],
                       "artifacts": ["rgb", "enhanced.ibla"], "encode": {"format": "png"}});
    let rendered = render(&files.job(&asked));
    let picture = |kind: &str| imaging::codec::decode_picture(file(&rendered, kind)).unwrap();
    let exact = enhance::run(&enhance::Method::parse("ibla").unwrap(), &picture("rgb")).unwrap();
    assert_eq!(picture("enhanced.ibla").to_rgb8(), exact.picture.to_rgb8());
}

#[test]
fn only_frames_that_ask_for_ibla_have_a_line_of_its_forms() {
    let files = Files::new();
    let job = |enhance: Value| files.job(&fields(&enhance, &["rgb"], &json!({"tolerance": 0.5})));
    let given = json!({"method": "ibla", "refine": "guided"});
    assert!(lines(&render(&job(json!(["hscm", given])))).is_empty());

    let plan = Slot::new(&engine_without_runtime())
        .plan(
            &job(json!(["hscm", "ibla"])).resolve(0).unwrap(),
            &SceneSource::Local,
        )
        .unwrap();
    let stage = plan.stage(StageId::Ibla).unwrap();
    assert_eq!(stage.variant.name(), "guided");
}

#[test]
fn steps_and_masks_of_enhancements_are_artifacts() {
    let files = Files::new();
    let kinds = [
        "rgb",
        "enhanced.wide",
        "enhanced.wide.homomorphic",
        "enhanced.wide.median",
        "enhanced.wide.contrast",
        "enhanced.wide.mask",
        "enhanced.mine",
        "enhanced.mine.1",
    ];
    let enhance = json!([
        {"method": "hscm", "name": "wide", "cutoff": 16, "mask": {"circle": {"radius": 0.3}}},
        {"name": "mine", "steps": [{"gray_world": {}}, {"clahe": {"clip": 3}}]},
    ]);
    let rendered = render(&files.job(&fields(&enhance, &kinds, &json!("picture"))));
    let picture = |kind: &str| imaging::codec::decode_picture(file(&rendered, kind)).unwrap();
    let run = |text: &str, picture: &imaging::Raster| {
        let enhancement = spec::Enhancement::parse(text).unwrap();
        enhance::enhance(&enhancement, picture, &["mask"], &mut enhance::refuse_network).unwrap()
    };
    let wide = run(
        "hscm:cutoff=16,mask={\"circle\":{\"radius\":0.3}}",
        &picture("rgb"),
    );
    assert_eq!(picture("enhanced.wide"), wide.picture);
    assert_eq!(picture("enhanced.wide.mask"), wide.steps[0].1);
    assert_ne!(wide.picture, wide.unmasked);
    let first = run("gray_world", &picture("rgb")).picture;
    assert_eq!(picture("enhanced.mine.1"), first);
    assert_eq!(picture("enhanced.mine"), run("clahe:clip=3", &first).picture);
    let stages = kinds[2..5].iter().map(|kind| picture(kind));
    assert_eq!(
        stages
            .map(|stage| spec::sha256(stage.to_rgb8().data()))
            .collect::<std::collections::HashSet<_>>()
            .len(),
        3
    );
}
