//! Labels of procedural scenes, their visibility through the water, and sequences.

use imaging::codec::{FilePlane, Radiance, decode_plane, decode_radiance};
use renderer::{Rendered, SceneSource, Slot};
use serde_json::{Value, json};

use crate::common::{Files, engine_without_runtime, file, parse, parse_errors, pixels, render, try_render};

fn job(fields: &Value) -> Value {
    let mut description = json!({
        "scene": {"kind": "procedural", "family": "pipeline", "seed": 3},
        "camera": {"width": 96, "height": 64},
        "metrics": [],
    });
    for (name, value) in fields.as_object().unwrap() {
        description[name] = value.clone();
    }
    description
}

fn labeled(optics: Value) -> Rendered {
    let artifacts = json!(["instances", "semantics", "findings", "normals", "boxes"]);
    render(&parse(&job(
        &json!({"water": {"optics": optics}, "artifacts": artifacts}),
    )))
}

#[test]
fn masks_boxes_and_record_speak_of_the_same_objects() {
    let rendered = labeled(json!("jerlov-IB"));
    let boxes: Value = serde_json::from_slice(file(&rendered, "boxes")).unwrap();
    let scene = rendered.record.scene.unwrap();
    assert_eq!(boxes, json!(scene));
    let codes = |kind: &str| match decode_plane(file_of(&rendered.files, kind)).unwrap() {
        FilePlane::Codes(plane) => plane,
        _ => panic!("a mask"),
    };
    let (instances, semantics) = (codes("instances"), codes("semantics"));
    let found = scene.instances.unwrap();
    assert!(found.len() > 2);
    for instance in &found {
        let shown = |at: usize| instances.data()[at] == instance.number;
        let pixels: Vec<usize> = (0..96 * 64).filter(|&at| shown(at)).collect();
        assert_eq!(pixels.len() as u64, instance.pixels);
        let [left, top, right, bottom] = instance.bounds;
        assert!(
            pixels
                .iter()
                .all(|at| (left..right).contains(&(at % 96)) && (top..bottom).contains(&(at / 96)))
        );
        let category = usize::from(semantics.data()[pixels[0]]);
        assert_eq!(scenes::categories::CATEGORIES[category].1, instance.category);
        let transmittance = instance.transmittance.unwrap();
        assert!(transmittance.iter().all(|t| (0.0..=1.0).contains(t)));
    }
    let pose = scene.world_from_camera.unwrap();
    assert_eq!(pose[3], [0.0, 0.0, 0.0, 1.0]);
}

#[test]
fn surfaces_out_of_sight_are_water_in_visible_semantics() {
    let rendered = render(&parse(&job(&json!({
        "water": {"optics": "jerlov-9C"}, "artifacts": ["semantics", "semantics.visible", "transmittance"],
    }))));
    let codes = |kind: &str| match decode_plane(file_of(&rendered.files, kind)).unwrap() {
        FilePlane::Codes(plane) => plane,
        _ => panic!("a mask"),
    };
    let (all, visible) = (codes("semantics"), codes("semantics.visible"));
    let Radiance::Linear(transmittance) = decode_radiance(file_of(&rendered.files, "transmittance")).unwrap()
    else {
        panic!("linear light")
    };
    let mut hidden = 0;
    for pixel in 0..96 * 64 {
        let most = transmittance
            .planes()
            .iter()
            .map(|plane| plane.data()[pixel])
            .fold(0.0, f32::max);
        let expected = if most < 0.02 { 0 } else { all.data()[pixel] };
        assert_eq!(visible.data()[pixel], expected);
        hidden += usize::from(visible.data()[pixel] != all.data()[pixel]);
    }
    assert!(hidden > 100, "{hidden}");
    let plain = render(&parse(&job(
        &json!({"artifacts": ["semantics", "semantics.visible"]}),
    )));
    let [all, visible] = ["semantics", "semantics.visible"].map(|kind| pixels(&plain, kind));
    assert_eq!(all, visible, "without a water everything is in sight");
}

#[test]
fn a_view_changes_the_pose_and_names_a_value_that_leaves_no_place() {
    let view = |view: Value| json!({"camera": {"width": 48, "height": 32, "view": view}});
    let engine = engine_without_runtime();
    let mut slot = Slot::new(&engine);
    let mut pose = |fields: &Value| {
        let frame = parse(&job(fields)).resolve(0).unwrap();
        slot.render(&frame, &SceneSource::Local)
            .map(|rendered| rendered.record.scene.unwrap().world_from_camera.unwrap())
    };
    let drawn = pose(&view(json!({}))).unwrap();
    let high = pose(&view(json!({"height_m": 4.0, "pitch_deg": -30}))).unwrap();
    assert_ne!(drawn, high);
    assert!((high[2][3] - 4.0).abs() < 1e-9 && (high[2][2] + 0.5).abs() < 1e-9);
    assert_eq!(
        pose(&view(json!({}))).unwrap(),
        drawn,
        "the cache of scenes tells views apart"
    );
    let error = pose(&json!({
        "scene": {"kind": "procedural", "family": "shaft", "seed": 1},
        "camera": {"view": {"distance_m": 30}},
    }));
    let message = error.unwrap_err().to_string();
    assert!(message.contains("`camera.view.distance_m` is 30"), "{message}");
}

fn file_of<'a>(files: &'a [renderer::File], kind: &str) -> &'a [u8] {
    &files.iter().find(|file| file.kind == kind).unwrap().bytes
}

#[test]
fn turbid_water_leaves_less_to_be_seen() {
    let of = |optics: Value| labeled(optics).record.scene.unwrap();
    let (clear, murky) = (of(json!("jerlov-IB")), of(json!("jerlov-9C")));
    assert!(murky.mean_visibility.unwrap() < clear.mean_visibility.unwrap());
    assert!(murky.visible.unwrap() <= clear.visible.unwrap());
    let range = |scene: &spec::SceneRecord| scene.instances.as_ref().unwrap()[0].range_m;
    assert_eq!(range(&clear), range(&murky));
}

#[test]
fn labels_are_made_only_when_they_are_asked_for() {
    let plain = render(&parse(&job(&json!({}))));
    let scene = plain.record.scene.unwrap();
    assert!(scene.instances.is_none() && scene.visible.is_none());
    let files = Files::new();
    let rendered = render(&files.stored_job(&json!({"artifacts": ["semantics"]})));
    assert_eq!(
        rendered.record.warnings,
        ["there is no artifact `semantics`: the scene has no instance mask"]
    );
    assert!(rendered.record.scene.is_none());
}

#[test]
fn a_sequence_goes_through_one_world_and_each_frame_can_be_rendered_alone() {
    let path = json!({"width": 48, "height": 32, "path": {"frames": 5, "sway_m": 0.02, "sway_deg": 1.0}});
    let water = json!({"optics": {"grid": ["jerlov-IB", "jerlov-5C"]}});
    let job = parse(&job(&json!({"camera": path, "count": 5, "water": water})));
    assert_eq!(job.frames(), 10);
    let engine = engine_without_runtime();
    let mut slot = Slot::new(&engine);
    let mut at = |index: u64| {
        slot.render(&job.resolve(index).unwrap(), &SceneSource::Local)
            .unwrap()
    };
    let place = |rendered: &Rendered| {
        rendered
            .record
            .scene
            .as_ref()
            .unwrap()
            .world_from_camera
            .unwrap()
            .map(|row| row[3])
    };
    let frames: Vec<Rendered> = (0..10).map(&mut at).collect();
    for pair in frames.chunks(2) {
        assert_eq!(
            place(&pair[0]),
            place(&pair[1]),
            "both waters from the same place"
        );
    }
    for index in [2, 4, 6, 8] {
        let (before, here) = (place(&frames[index - 2]), place(&frames[index]));
        let step: f64 = before
            .iter()
            .zip(here)
            .map(|(a, b)| (a - b).powi(2))
            .sum::<f64>()
            .sqrt();
        assert!(step > 1e-3, "the camera moves");
    }
    let parameters = &frames[6].record.parameters;
    assert_eq!(parameters["camera"]["path"]["frame"], 3);
    let alone = render(&parse(parameters));
    assert_eq!(alone.files, frames[6].files);
    assert_eq!(alone.record.scene, frames[6].record.scene);
}

#[test]
fn paths_that_cannot_be_are_refused() {
    let point = |x: f64| json!({"position_m": [x, -3.0, 1.0], "target_m": [x, 0.0, 1.0]});
    let with = |path: Value| job(&json!({"camera": {"path": path}}));
    let message = |description: &Value| parse_errors(description)[0].message.clone();
    let zero = with(json!({"frames": 9, "start": point(0.0), "end": point(0.0)}));
    assert!(message(&zero).contains("is the same as `camera.path.start`"));
    assert!(message(&with(json!({"frames": 9, "start": point(0.0)}))).contains("needs `camera.path.end`"));
    assert!(
        message(&with(json!({"frames": 9, "frame": 9})))
            .contains("must be below `camera.path.frames`, which is 9")
    );
    assert!(message(&with(json!({"frames": 0}))).contains("camera.path.frames"));
    let mut uploaded = with(json!({"frames": 9}));
    uploaded["scene"] = json!({"kind": "uploaded", "id": "scn_1"});
    assert!(message(&uploaded).contains("procedural"));
}

#[test]
fn a_mask_with_classes_labels_a_picture_of_files() {
    let files = Files::new();
    files.write_mask(
        r#"{"categories": [{"id": 2, "name": "pile"}, {"id": 40, "name": "chain"}],
        "segments_info": [{"id": 1, "category_id": 2}, {"id": 300, "category_id": 40}]}"#,
    );
    let fields = json!({
        "scene": files.scene_with_mask(), "water": {"optics": "jerlov-1C"},
        "artifacts": ["rgb", "instances", "semantics", "boxes"],
    });
    let rendered = render(&files.job(&fields));
    let FilePlane::Codes(semantics) = decode_plane(file(&rendered, "semantics")).unwrap() else {
        panic!("a mask")
    };
    // Left to right: pile, empty, chain, and an object without a class.
    let row: Vec<u16> = [2, 14, 26, 40].map(|x| semantics.pixel(x, 5)).into();
    assert_eq!(row, [2, 0, 40, 255]);
    let boxes: Value = serde_json::from_slice(file(&rendered, "boxes")).unwrap();
    assert_eq!(boxes, json!(rendered.record.scene));
    assert!(boxes.get("world_from_camera").is_none() && boxes["intrinsics"]["focal_px"].is_number());
    let names: Vec<_> = boxes["categories"]
        .as_array()
        .unwrap()
        .iter()
        .map(|c| (&c["id"], &c["name"]))
        .collect();
    assert_eq!(
        json!(names),
        json!([[2, "pile"], [40, "chain"], [255, "unlabeled"]])
    );
    let found = rendered.record.scene.unwrap().instances.unwrap();
    let categories: Vec<_> = found.iter().map(|i| (i.number, i.category.as_str())).collect();
    assert_eq!(categories, [(1, "pile"), (300, "chain"), (301, "unlabeled")]);
    assert!(
        found
            .iter()
            .all(|i| i.range_m.is_some() && i.transmittance.is_some() && i.pixels > 0)
    );
    assert!(
        found[0].transmittance > found[2].transmittance,
        "the left is nearer"
    );
    assert!(rendered.record.provenance.inputs.contains_key("scene.classes"));
    // Without a label artifact no labels are computed.
    let plain = render(&files.job(&json!({"scene": files.scene_with_mask(), "artifacts": ["instances"]})));
    assert!(plain.record.scene.is_none());
}

#[test]
fn classes_that_do_not_fit_the_mask_fail_the_frame_with_their_numbers() {
    let files = Files::new();
    for (classes, said) in [
        (
            r#"{"1": "pile", "7": "chain"}"#,
            "no pixel of the instance mask has the numbers 7",
        ),
        (r#"{"1": ""}"#, "the name of a class"),
    ] {
        files.write_mask(classes);
        let job = files.job(&json!({"scene": files.scene_with_mask()}));
        let error = try_render(&job, &engine_without_runtime()).unwrap_err();
        assert!(error.to_string().contains(said), "{error}");
    }
    let alone = json!({"scene": {"kind": "files", "rgb": "a.png", "classes": "c.json"}});
    assert_eq!(
        parse_errors(&files.description(&alone))[0].pointer,
        "/scene/classes"
    );
}
