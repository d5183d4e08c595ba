//! The planned variant of an enhancement.

use optics::plan::StageId;
use renderer::{Rendered, SceneSource, Slot};
use serde_json::{Value, json};

use crate::common::{Files, engine_without_runtime, file, render};

const EVERY: [&str; 2] = ["ibla", "ibla_guided"];

fn fields(methods: &[&str], fidelity: &Value) -> Value {
    let enhanced = methods.iter().map(|method| format!("enhanced.{method}"));
    let artifacts: Vec<String> = enhanced.collect();
    json!({"water": {"optics": "jerlov-1C"}, "enhance": methods, "artifacts": artifacts, "fidelity": fidelity})
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
        (json!({"tolerance": 3e-4}), "ibla"),
        (json!({"tolerance": 0.169}), "ibla"),
        (json!({"tolerance": 0.17}), "ibla_guided"),
        (json!({"terms": 4}), "ibla"),
        (json!("reference"), "ibla"),
    ] {
        // The methods of the variants use the same picture and are never replaced.
        let chosen = render(&files.job(&fields(&EVERY, &fidelity)));
        let [ibla, guided] = EVERY.map(|name| file(&chosen, &format!("enhanced.{name}")));
        assert_eq!(ibla == guided, form == "ibla_guided", "{fidelity}");

        let [line] = lines(&chosen).try_into().unwrap();
        assert_eq!(line["variant"], form, "{line}");
        let share = fidelity["tolerance"].as_f64().filter(|_| form != "ibla");
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
    let exact = enhance::run(&enhance::ibla::IblaRefinement::Matting.method(), &picture("rgb")).unwrap();
    assert_eq!(picture("enhanced.ibla").to_rgb8(), exact.picture.to_rgb8());
}

#[test]
fn only_frames_that_ask_for_ibla_have_a_line_of_its_forms() {
    let files = Files::new();
    let job = |methods: &[&str]| files.job(&fields(methods, &json!({"tolerance": 0.5})));
    assert!(lines(&render(&job(&["hscm", "ibla_guided"]))).is_empty());

    let plan = Slot::new(&engine_without_runtime())
        .plan(&job(&["hscm", "ibla"]).resolve(0).unwrap(), &SceneSource::Local)
        .unwrap();
    let stage = plan.stage(StageId::Ibla).unwrap();
    assert_eq!(stage.variant.name(), "ibla_guided");
}
