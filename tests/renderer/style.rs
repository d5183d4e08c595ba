//! When the style network runs, and the result where it cannot.

use optics::plan::StageId;
use renderer::{SceneSource, Slot};
use serde_json::json;

use crate::common::{Files, WIDTH, engine, engine_without_runtime, file, parse, pixels, try_render};

#[test]
fn without_the_runtime_a_style_of_another_form_fails_for_good_and_says_what_to_run() {
    let files = Files::new();
    let job = files.job(&json!({"water": {"style": "foreign"}}));
    let error = try_render(&job, &engine_without_runtime()).unwrap_err();
    assert!(!error.retryable());
    assert!(
        error.to_string().contains("scripts/get-onnxruntime.sh"),
        "{error}"
    );
}

#[test]
fn with_alpha_zero_no_network_runs() {
    let files = Files::new();
    let job =
        files.job(&json!({"water": {"style": "atlantic"}, "alpha": 0.0, "artifacts": ["rgb", "clean"]}));
    let rendered = try_render(&job, &engine_without_runtime()).unwrap();
    assert_eq!(pixels(&rendered, "rgb"), pixels(&rendered, "clean"));
    assert!(!rendered.record.provenance.inputs.contains_key("style.atlantic"));
}

#[test]
fn alpha_leads_from_the_water_to_the_style() {
    let files = Files::new();
    let engine = engine_without_runtime();
    let red = |alpha: f64| {
        let job = files.job(&json!({"water": {"style": "atlantic"}, "alpha": alpha}));
        let rendered = try_render(&job, &engine).unwrap();
        let picture = imaging::codec::decode_picture(file(&rendered, "rgb"))
            .unwrap()
            .to_rgb8();
        picture.pixels().map(|[red, ..]| u64::from(red)).sum::<u64>()
    };
    let (air, half, styled) = (red(0.0), red(0.5), red(1.0));
    assert!(air > half && half > styled, "red fades: {air} {half} {styled}");
}

#[test]
fn a_frame_names_its_model_and_the_runtime_if_that_ran() {
    let files = Files::new();
    let ran = |style: &str| {
        let job = files.job(&json!({"water": {"style": style}}));
        let rendered = try_render(&job, &engine()).unwrap();
        let inputs = &rendered.record.provenance.inputs;
        assert_eq!(inputs[&format!("style.{style}")].len(), 64);
        (
            rendered.record.provenance.onnx_runtime.clone(),
            file(&rendered, "rgb").to_vec(),
        )
    };
    let (native, by_us) = ran("muddy");
    let (foreign, by_runtime) = ran("foreign");
    assert_eq!(native, None);
    assert!(foreign.is_some_and(|version| version.starts_with("1.")));
    let [by_us, by_runtime] =
        [by_us, by_runtime].map(|png| imaging::codec::decode_picture(&png).unwrap().to_rgb8());
    let pairs = by_us.data().iter().zip(by_runtime.data());
    let apart = pairs.map(|(a, b)| a.abs_diff(*b)).max();
    assert!(apart <= Some(1), "rounding at most: {apart:?}");
}

#[test]
fn a_color_table_takes_the_place_of_the_network_where_the_tolerance_allows_it() {
    let files = Files::new();
    let ran = |tolerance: f64| {
        let fields = json!({"water": {"style": "muddy"}, "alpha": 0.5, "fidelity": {"tolerance": tolerance}});
        let rendered = try_render(&files.job(&fields), &engine_without_runtime()).unwrap();
        let inputs = rendered.record.provenance.inputs.keys();
        let style = inputs.filter(|name| name.starts_with("style.")).cloned();
        (style.collect::<String>(), file(&rendered, "rgb").to_vec())
    };
    let ((by_network, network), (by_table, table)) = (ran(3e-4), ran(1.0));
    assert_eq!(
        (by_network.as_str(), by_table.as_str()),
        ("style.muddy", "style.muddy.lut")
    );
    assert!(table != network);
}

#[test]
fn a_style_that_takes_a_range_is_given_that_of_each_pixel_and_leaves_a_scene_without_one() {
    let files = Files::new();
    let styled = |scene: serde_json::Value| {
        let fields =
            json!({"scene": scene, "water": {"style": "atlantic-range"}, "artifacts": ["rgb", "clean"]});
        try_render(&files.stored_job(&fields), &engine_without_runtime()).unwrap()
    };
    // The ramp is near at the left and far at the right; the other scene is open water only. Near pixels differ more.
    let (ramp, open) = (styled(files.scene("range.npy")), styled(files.scene("holes.npy")));
    let near_and_far = [0, WIDTH - 4].map(|left| {
        let of = |rendered| columns(file(rendered, "rgb"), left);
        apart(&of(&ramp), &of(&open))
    });
    // The blend toward open water is at three quarters for 5 m and at one quarter for 1 m; near pixels are also darker.
    assert!(2 * near_and_far[0] > 3 * near_and_far[1], "{near_and_far:?}");
    assert!(ramp.record.provenance.inputs.contains_key("style.atlantic-range"));
    let bare = styled(files.scene_without_range());
    assert_eq!(pixels(&bare, "rgb"), pixels(&bare, "clean"));
    assert!(!bare.record.provenance.inputs.contains_key("style.atlantic-range"));
}

/// Four columns of a picture, starting at `left`.
fn columns(picture: &[u8], left: usize) -> Vec<u8> {
    let picture = imaging::codec::decode_picture(picture).unwrap().to_rgb8();
    let places = (0..picture.height()).flat_map(|y| (left..left + 4).map(move |x| (x, y)));
    places.flat_map(|(x, y)| picture.pixel(x, y)).collect()
}

fn apart(one: &[u8], other: &[u8]) -> u64 {
    one.iter()
        .zip(other)
        .map(|(&a, &b)| u64::from(a.abs_diff(b)))
        .sum()
}

#[test]
fn a_style_that_looks_at_the_range_is_expected_to_cost_more() {
    let cost = |style: &str| {
        let job = parse(
            &json!({"scene": {"kind": "procedural", "family": "structure"}, "metrics": [],
                                "camera": {"width": 400, "height": 300}, "water": {"style": style}}),
        );
        let plan = Slot::new(&engine_without_runtime())
            .plan(&job.resolve(0).unwrap(), &SceneSource::Local)
            .unwrap();
        let stage = plan.stage(StageId::Style).unwrap();
        assert_eq!(stage.variant.name(), "network");
        stage.cost_ms.unwrap()
    };
    let (plain, ranged) = (cost("atlantic"), cost("atlantic-range"));
    assert!(ranged > plain && plain > 0.0, "{ranged} against {plain}");
}
