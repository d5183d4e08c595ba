//! The camera of a frame: its effect on pictures and labels, and the outputs it leaves unchanged.

use imaging::codec::{FilePlane, decode_picture, decode_plane};
use imaging::{Plane, Samples};
use renderer::{Rendered, SceneSource, Slot};
use serde_json::{Value, json};

use crate::common::{Files, HEIGHT, WIDTH, engine_without_runtime, file, parse, parse_errors, render};

fn job(fields: &Value) -> Value {
    let mut description = json!({
        "scene": {"kind": "procedural", "family": "pipeline", "seed": 3},
        "camera": {"width": 96, "height": 64},
        "water": {"optics": "jerlov-IB"},
        "metrics": [],
    });
    for (name, value) in fields.as_object().unwrap() {
        match value.as_object().filter(|_| name == "camera") {
            Some(parts) => parts
                .iter()
                .for_each(|(part, value)| description["camera"][part] = value.clone()),
            None => description[name] = value.clone(),
        }
    }
    description
}

fn codes(bytes: &[u8]) -> Plane<u16> {
    match decode_plane(bytes).unwrap() {
        FilePlane::Codes(plane) => plane,
        _ => panic!("codes"),
    }
}

fn rgb(rendered: &Rendered) -> Vec<u8> {
    match decode_picture(file(rendered, "rgb")).unwrap().samples() {
        Samples::U8(codes) => codes.clone(),
        Samples::U16(_) => panic!("8 bit"),
    }
}

fn stages(rendered: &Rendered) -> Vec<(String, String)> {
    let lines = rendered.record.plan.as_array().unwrap();
    let text = |line: &Value, name: &str| line[name].as_str().unwrap().to_owned();
    lines
        .iter()
        .map(|line| (text(line, "stage"), text(line, "variant")))
        .filter(|(stage, _)| stage.starts_with("camera."))
        .collect()
}

#[test]
fn a_pinhole_has_no_line_and_a_part_within_its_share_is_skipped() {
    assert_eq!(stages(&render(&parse(&job(&json!({}))))), []);
    let faint = json!({"camera": {
        "vignette": {"v": 1e-5}, "distortion": {"k1": 1e-6}, "defocus": {"aperture_m": 1e-5, "focus_m": 3.0}
    }});
    let rendered = render(&parse(&job(&faint)));
    let skip = |stage: &str| (stage.to_owned(), "skip".to_owned());
    let expected = [
        skip("camera.geometry"),
        skip("camera.defocus"),
        skip("camera.vignette"),
    ];
    assert_eq!(stages(&rendered), expected);
    assert_eq!(rgb(&rendered), rgb(&render(&parse(&job(&json!({}))))));
}

#[test]
fn boxes_masks_and_range_follow_the_lens() {
    let camera = json!({"distortion": {"k1": -0.1, "k2": 0.01}, "port": {"kind": "flat"}, "supersample": 2});
    let artifacts = json!([
        "rgb",
        "instances",
        "semantics",
        "range",
        "normals",
        "boxes",
        "clean",
        "transmittance"
    ]);
    let rendered = render(&parse(&job(&json!({"camera": camera, "artifacts": artifacts}))));
    let instances = codes(file(&rendered, "instances"));
    let semantics = codes(file(&rendered, "semantics"));
    assert_eq!(instances.size(), (96, 64));
    assert_eq!(codes(file(&rendered, "range")).size(), (96, 64));
    let scene = rendered.record.scene.unwrap();
    let found = scene.instances.unwrap();
    assert!(found.len() > 2);
    for instance in &found {
        let own = (0..96 * 64).filter(|&at| instances.data()[at] == instance.number);
        let own: Vec<usize> = own.collect();
        assert_eq!(own.len() as u64, instance.pixels);
        let edge = |values: Vec<usize>| {
            (
                values.iter().min().copied(),
                values.iter().max().map(|most| most + 1),
            )
        };
        let (left, right) = edge(own.iter().map(|at| at % 96).collect());
        let (top, bottom) = edge(own.iter().map(|at| at / 96).collect());
        let bounds = [left, top, right, bottom].map(Option::unwrap);
        assert_eq!(bounds, instance.bounds);
        let category = usize::from(semantics.data()[own[0]]);
        assert_eq!(scenes::categories::CATEGORIES[category].1, instance.category);
    }
    let lens = scene.lens.unwrap();
    assert_eq!(
        (lens.distortion.k1, lens.flat_port_n_w),
        (-0.1, Some([1.3377, 1.3408, 1.3459]))
    );
    // 80 degrees across: 48 / tan 40.
    assert!((scene.intrinsics.focal_px - 57.2).abs() < 0.1);
}

#[test]
fn the_flat_port_narrows_the_view_by_the_index_of_the_water() {
    let pixels = |camera: Value| {
        let rendered = render(&parse(&job(
            &json!({"camera": camera, "artifacts": ["instances"]}),
        )));
        codes(file(&rendered, "instances"))
    };
    let (air, port) = (pixels(json!({})), pixels(json!({"port": {"kind": "flat"}})));
    // A point 10 px from the center in air is 13.4 px from it behind the port.
    let (mut same, mut all) = (0, 0);
    for (x, y) in (-7..8).flat_map(|x| (-7..8).map(move |y| (x, y))) {
        let moved = |d: i32, center: f64| (center + 1.34 * f64::from(d)).round() as usize;
        let (near, far) = (
            air.pixel((48 + x) as usize, (32 + y) as usize),
            port.pixel(moved(x, 48.17), moved(y, 32.17)),
        );
        same += u32::from(near == far);
        all += 1;
    }
    assert!(same * 10 >= all * 9, "{same} of {all}");
}

#[test]
fn noise_is_the_frames_own_and_the_same_whatever_was_rendered_before() {
    let description =
        job(&json!({"count": 2, "camera": {"sensor": {"light_level": 0.02}}, "artifacts": ["rgb", "raw"]}));
    let job = parse(&description);
    let mut slot = Slot::new(&engine_without_runtime());
    let mut shot = |index| {
        slot.render(&job.resolve(index).unwrap(), &SceneSource::Local)
            .unwrap()
    };
    let (first, second, again) = (shot(0), shot(1), shot(0));
    assert_eq!(first.files, again.files);
    assert_ne!(rgb(&first), rgb(&second));
    let raw = codes(file(&first, "raw"));
    assert_eq!(raw.size(), (96, 64));
    assert!(raw.data().iter().all(|&code| code < 4096));
    let numbers = &first.record.optics["camera"]["sensor"];
    assert_eq!(
        (&numbers["black_dn"], &numbers["cfa"]),
        (&json!(64), &json!("rggb"))
    );
    // The frame without noise is the mean of the noisy one, up to the noise of a mean over a thousand pixels.
    let mean = |picture: &[u8]| picture.iter().map(|&v| f64::from(v)).sum::<f64>() / picture.len() as f64;
    let quiet = render(&parse(&self::job(&json!({}))));
    assert!((mean(&rgb(&first)) - mean(&rgb(&quiet))).abs() < 6.0);
}

#[test]
fn the_fast_camera_agrees_with_the_reference() {
    let camera = json!({"width": 48, "height": 32, "distortion": {"k1": -0.1}, "port": {"kind": "flat"},
        "defocus": {"aperture_m": 0.01, "focus_m": 2.0}, "vignette": {}, "exposure": {"auto": {}},
        "sensor": "large-pixel-1/1.2", "white_balance": "gray_world"});
    let shot = |fidelity: Value| {
        let fields = json!({"camera": camera, "fidelity": fidelity, "water": {}});
        rgb(&render(&parse(&job(&fields))))
    };
    let (fast, exact) = (shot(json!({"tolerance": 1e-5})), shot(json!("reference")));
    let apart = fast.iter().zip(&exact).map(|(&a, &b)| a.abs_diff(b));
    // Between two radii the fast blur interpolates, which can change noisy samples by a code.
    let far = apart.filter(|&d| d > 2).count();
    assert!(far * 50 < fast.len(), "{far} of {}", fast.len());
}

#[test]
fn movement_blurs_along_the_path_and_rolls_from_row_to_row() {
    let path = json!({"frames": 20, "frame": 10});
    let shot = |parts: Value| {
        let mut camera = json!({"path": path});
        parts
            .as_object()
            .unwrap()
            .iter()
            .for_each(|(name, value)| camera[name] = value.clone());
        render(&parse(&job(
            &json!({"camera": camera, "artifacts": ["rgb", "instances", "boxes"]}),
        )))
    };
    let still = shot(json!({}));
    let moved = shot(json!({"exposure_s": 0.08}));
    assert_ne!(rgb(&still), rgb(&moved));
    assert_eq!(file(&still, "instances"), file(&moved, "instances"));
    let rolled = shot(json!({"readout_s": 0.2}));
    assert_ne!(file(&still, "instances"), file(&rolled, "instances"));
    let scene = rolled.record.scene.as_ref().unwrap();
    let instances = codes(file(&rolled, "instances"));
    for instance in scene.instances.as_ref().unwrap() {
        let shown = instances
            .data()
            .iter()
            .filter(|&&number| number == instance.number)
            .count();
        assert_eq!(shown as u64, instance.pixels);
    }
}

#[test]
fn exposure_follows_its_metering_slowly_and_each_frame_can_be_rendered_alone() {
    let gain = |frame: u64, lag: f64| {
        let camera =
            json!({"path": {"frames": 40, "frame": frame}, "exposure": {"auto": {"lag_frames": lag}}});
        // Without lit surfaces the light changes steadily along the path.
        let scene = json!({"kind": "procedural", "family": "pipeline", "seed": 3, "lighting": "in_air"});
        let water = json!({"optics": {"preset": "jerlov-IB", "veil_gain": 1}});
        let fields = json!({"camera": camera, "scene": scene, "water": water});
        let rendered = render(&parse(&job(&fields)));
        rendered.record.optics["camera"]["exposure_gain"]
            .as_f64()
            .unwrap()
    };
    let (first, last) = (gain(0, 0.0), gain(39, 0.0));
    assert!((gain(0, 5.0) / first - 1.0).abs() < 0.1);
    let behind = gain(39, 30.0);
    let between = (behind - first) * (behind - last);
    assert!(
        between <= 0.0 || (behind / last - 1.0).abs() < 0.1,
        "{first} {behind} {last}"
    );
}

#[test]
fn an_uploaded_picture_keeps_its_size_and_says_what_the_lens_sees_beyond_it() {
    let files = Files::new();
    let camera = json!({"distortion": {"k1": -0.1}, "motion": {"x_px": 3.0}});
    let job = files.job(&json!({"camera": camera, "artifacts": ["rgb", "valid", "range"]}));
    let rendered = render(&job);
    let valid = codes(file(&rendered, "valid"));
    assert_eq!(valid.size(), (WIDTH, HEIGHT));
    assert_eq!((valid.pixel(0, 0), valid.pixel(WIDTH / 2, HEIGHT / 2)), (0, 255));
    assert_eq!(codes(file(&rendered, "range")).size(), (WIDTH, HEIGHT));
    assert_eq!(
        rendered.record.parameters["camera"]["distortion"]["k1"],
        json!(-0.1)
    );
}

#[test]
fn metrics_take_the_compressed_picture() {
    let shot = |jpeg: Value| {
        let fields = json!({"camera": {"jpeg": jpeg}, "metrics": ["entropy"]});
        let rendered = render(&parse(&job(&fields)));
        (rgb(&rendered), rendered.record.measurements["rgb"]["entropy"])
    };
    let plain = render(&parse(&job(&json!({"metrics": ["entropy"]}))));
    let clean = plain.record.measurements["rgb"]["entropy"];
    let (picture, measured) = shot(json!({"quality": 10}));
    assert_ne!(picture, rgb(&plain));
    assert_ne!(measured, clean);
    assert_ne!(shot(json!({"quality": 10, "chroma": "half"})).0, rgb(&plain));
}

#[test]
fn the_noise_of_the_sensor_is_a_tolerance() {
    let plan = |fields: Value| {
        let job = parse(&job(&fields));
        let mut slot = Slot::new(&engine_without_runtime());
        let plan = slot.plan(&job.resolve(0).unwrap(), &SceneSource::Local);
        plan.unwrap().tolerance.map(|tolerance| tolerance.absolute)
    };
    let camera = json!({"sensor": {"read_noise_e": 30.0, "full_well_e": 10_000.0}});
    let tolerance = plan(json!({"camera": camera})).unwrap();
    // The noise is 30 electrons of 9000; the hidden error is a third of that.
    assert!(
        (tolerance / (30.0 / 9000.0 / 3.0) - 1.0).abs() < 1e-3,
        "{tolerance}"
    );
    let quiet = plan(json!({})).unwrap();
    assert!(quiet < 0.5 / 255.0, "{quiet}: within a code without a sensor");
}

#[test]
fn every_number_may_be_a_law_and_what_cannot_be_is_refused_at_submit() {
    let uniform = |a: f64, b: f64| json!({"uniform": [a, b]});
    let camera = json!({"distortion": {"k1": uniform(-0.1, 0.1)}, "vignette": {"v": uniform(0.0, 1.0)},
        "exposure": {"fixed": uniform(0.5, 2.0)}, "sensor": {"gain": uniform(1.0, 16.0), "bits": {"choice": [8, 12]}},
        "jpeg": {"quality": {"int": [20, 95]}}, "white_balance": {"fixed": [uniform(0.8, 1.2), 1.0, 1.1]}});
    let job = parse(&self::job(&json!({"count": 3, "camera": camera})));
    let mut slot = Slot::new(&engine_without_runtime());
    let mut shot = |index| {
        rgb(&slot
            .render(&job.resolve(index).unwrap(), &SceneSource::Local)
            .unwrap())
    };
    assert_ne!(shot(0), shot(2));
    for (camera, pointer, says) in [
        (json!({"distortion": {"k1": -0.9}}), "/camera/distortion", "folds"),
        (
            json!({"distortion": {"k1": uniform(-0.9, 0.0)}}),
            "/camera/distortion",
            "a possible camera of the distributions",
        ),
        (json!({"width": 1, "sensor": {}}), "/camera/sensor", "2×2"),
        (json!({"sensor": "none-such"}), "/camera/sensor", "known sensor"),
        (
            json!({"sensor": {"bits": 8, "black_dn": 300}}),
            "/camera/sensor/black_dn",
            "255",
        ),
        (json!({"readout_s": 0.01}), "/camera/readout_s", "path"),
        (json!({"motion": {}}), "/camera/motion", "an uploaded scene"),
        (
            json!({"exposure": {"auto": {"lag_frames": 3}}}),
            "/camera/exposure",
            "path",
        ),
        (json!({"preset": "none-such"}), "/camera/preset", "known camera"),
        (
            json!({"port": {"kind": "flat", "glass_m": 0.3}}),
            "/camera/port/glass_m",
            "0.2",
        ),
    ] {
        let errors = parse_errors(&self::job(&json!({"camera": camera})));
        let found = errors.iter().find(|error| error.pointer.starts_with(pointer));
        let found = found.unwrap_or_else(|| panic!("{camera}: {errors:?}"));
        assert!(found.message.contains(says), "{}", found.message);
    }
    let raw = parse_errors(&self::job(&json!({"artifacts": ["raw"]})));
    assert!(raw[0].message.contains("`camera.sensor`"));
    let files = Files::new();
    for camera in [json!({"supersample": 2}), json!({"readout_s": 0.01})] {
        let mut description = files.description(&json!({"camera": camera}));
        description["scene"] = files.scene("range.npy");
        assert!(parse_errors(&description)[0].pointer.starts_with("/camera"));
    }
    let mut blurred =
        files.description(&json!({"camera": {"defocus": {"aperture_m": 0.01, "focus_m": 1.0}}}));
    blurred["scene"] = files.scene_without_range();
    assert!(parse_errors(&blurred)[0].message.contains("range"));
}

#[test]
fn a_preset_is_a_camera_and_fields_replace_its_parts() {
    let rendered = render(&parse(&job(
        &json!({"camera": {"preset": "inspection-flat-port", "port": {"kind": "none"}}}),
    )));
    let stages: Vec<String> = stages(&rendered).into_iter().map(|(stage, _)| stage).collect();
    assert!(stages.contains(&"camera.sensor".to_owned()) && !stages.contains(&"camera.geometry".to_owned()));
    assert_eq!(
        rendered.record.optics["camera"]["sensor"]["preset"],
        json!("machine-vision-1/1.8")
    );
}
