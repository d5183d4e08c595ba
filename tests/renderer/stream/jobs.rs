//! The job of a stream: its scene, its distributions and its deadline.

use super::*;

#[test]
fn distributions_are_drawn_once_or_for_each_stamp() {
    let (files, camera) = (Files::new(), Camera::new());
    let fields = json!({"count": 3, "seed": 4, "water": {"optics": "jerlov-3C", "range_scale": {"uniform": [0.1, 2]}}});
    let mut described = fields.clone();
    described["scene"] = files.scene("range.npy");
    let job = files.job(&described);
    let mut slot = renderer::Slot::new(&engine_without_runtime());
    let expected = [0, 1, 2].map(|index| {
        let frame = job.resolve(index).unwrap();
        pixels(
            &slot.render(&frame, &renderer::SceneSource::Local).unwrap(),
            "rgb",
        )
    });
    let options = StreamOptions {
        vary: Vary::Frame,
        ..StreamOptions::default()
    };
    let (mut still, mut varied) = (open(&fields), open_with(&fields, options));
    for (stamp, expected_here) in (0..).zip(&expected) {
        assert!(
            rgb(&mut varied, &camera.input(stamp)) == *expected_here,
            "{stamp}"
        );
        assert!(rgb(&mut still, &camera.input(stamp)) == expected[0], "{stamp}");
    }
    assert!(expected[0] != expected[1]);
}

#[test]
fn the_pictures_replace_the_scene_of_a_job_and_of_a_site() {
    let stream = open(&json!({
        "scene": {"kind": "procedural", "family": "structure"},
        "camera": {"width": 640, "height": 480, "view": {"pitch_deg": 4}},
        "water": {"optics": "jerlov-3C"},
        "artifacts": ["rgb", "boxes", "range"]
    }));
    assert_eq!(
        stream.warnings(),
        ["the pictures of the stream replace `scene`, without `camera.view`, the artifact \"boxes\""]
    );
    let camera = Camera::new();
    for site in [json!("harbour-wall"), json!({"choice": ["shaft", "tank"]})] {
        let mut stream = open(&json!({"site": site}));
        assert!(
            stream.warnings()[0].contains("replace `scene`"),
            "{:?}",
            stream.warnings()
        );
        assert!(rgb(&mut stream, &camera.input(0)) != camera.codes);
    }
    let lit = open(&json!({"scene": {"lighting": "water"}, "water": {"optics": "jerlov-3C"}}));
    assert_eq!(lit.warnings(), [""; 0]);
}

#[test]
fn artifacts_that_no_stream_has_are_refused_with_their_field() {
    let job = json!({"artifacts": ["rgb", "range", "boxes"], "alpha": 2});
    let opened = Stream::open(
        job.to_string().as_bytes(),
        StreamOptions::default(),
        &engine_without_runtime(),
    );
    let pointers: Vec<String> = opened
        .err()
        .unwrap()
        .0
        .into_iter()
        .map(|error| error.pointer)
        .collect();
    assert_eq!(pointers, ["/alpha", "/artifacts/2"]);
}

#[test]
fn a_deadline_keeps_the_plan_it_has_time_for_and_reports_one_that_is_late() {
    let camera = Camera::new();
    let job = json!({
        "water": {"optics": "jerlov-3C"},
        "lights": [{"kind": "point", "position_m": [0.3, -0.2, 0], "intensity": [4, 4, 4]}]
    });
    let open_for = |deadline_ms: f64| {
        open_with(
            &job,
            StreamOptions {
                deadline_ms: Some(deadline_ms),
                ..StreamOptions::default()
            },
        )
    };
    let free = open(&job).render(&camera.input(0)).unwrap();
    let ample = open_for(1e6).render(&camera.input(0)).unwrap();
    assert_eq!(codes(&ample, "rgb"), codes(&free, "rgb"));
    assert_eq!(
        (ample.error_bound(), &ample.record.warnings),
        (free.error_bound(), &free.record.warnings)
    );
    let late = open_for(1e-3).render(&camera.input(0)).unwrap();
    assert!(late.error_bound() > free.error_bound(), "a looser tolerance");
    let warning = late.record.warnings.last().unwrap();
    assert!(
        warning.starts_with("`deadline_ms` is 0.001, but the cheapest plan"),
        "{warning}"
    );
}

#[test]
fn a_deadline_that_is_none_or_contradicts_the_job_is_refused() {
    let refused = |job: Value, deadline_ms: f64| {
        let options = StreamOptions {
            deadline_ms: Some(deadline_ms),
            ..StreamOptions::default()
        };
        let opened = Stream::open(job.to_string().as_bytes(), options, &engine_without_runtime());
        opened.err().unwrap().to_string()
    };
    for deadline_ms in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(
            refused(json!({}), deadline_ms).contains("must be above 0"),
            "{deadline_ms}"
        );
    }
    assert!(
        refused(json!({"fidelity": "reference"}), 66.0).contains("`fidelity` is given, but `deadline_ms`")
    );
}

/// Failure: a picture that no stage changes has other codes than its input, or one that a stage changes has the same.
#[test]
fn pictures_that_no_stage_changes_come_back_in_every_order_of_channels() {
    let (rgb_codes, pixels) = {
        let picture = Rgb8::from_fn(16, 16, |x, y| {
            [16 * y + x, 255 - 16 * y - x, 16 * x + y].map(|code| code as u8)
        });
        let pixels: Vec<[u8; 3]> = picture.data().as_chunks::<3>().0.to_vec();
        (picture.data().to_vec(), pixels)
    };
    let ordered = |order: fn([u8; 3]) -> Vec<u8>| -> Vec<u8> {
        pixels.iter().flat_map(|&pixel| order(pixel)).collect()
    };
    let orders = [
        (ChannelOrder::Rgb, rgb_codes.clone()),
        (ChannelOrder::Bgr, ordered(|[r, g, b]| vec![b, g, r])),
        (ChannelOrder::Rgba, ordered(|[r, g, b]| vec![r, g, b, 7])),
        (ChannelOrder::Bgra, ordered(|[r, g, b]| vec![b, g, r, 7])),
    ];
    let haze = json!({"lights": [{"kind": "haze", "x": 0.5, "y": 0.5, "size": 0.5, "intensity": 1}]});
    let camera = Camera::new();
    let (mut plain, mut hazed) = (open(&json!({"enhance": ["hscm"]})), open(&haze));
    for (channels, codes) in &orders {
        let input = StreamInput {
            picture: StreamPicture {
                size: (16, 16),
                channels: *channels,
                samples: PictureSamples::Srgb(codes),
            },
            ..camera.input_without_range(0)
        };
        assert_eq!(rgb(&mut plain, &input), rgb_codes, "{channels:?}");
        assert_ne!(rgb(&mut hazed, &input), rgb_codes, "{channels:?}");
    }
}

/// Failure: a deadline that no plan meets leaves forward scatter as it is, or every frame chooses its effects again.
#[test]
fn a_short_deadline_coarsens_forward_scatter_and_keeps_the_choice() {
    let (camera, job) = (Camera::new(), json!({"water": {"optics": "jerlov-3C"}}));
    let dark = Camera {
        codes: vec![1; camera.codes.len()],
        ..Camera::new()
    };
    let terms = |frame: &StreamFrame| {
        let stages = frame.record.plan.as_array().expect("stages").iter();
        let scatter = stages.filter(|stage| {
            stage["stage"]
                .as_str()
                .is_some_and(|id| id.starts_with("forward_scatter"))
        });
        scatter
            .map(|stage| stage["terms"].as_u64().unwrap_or(0))
            .sum::<u64>()
    };
    let plain = open(&job).render(&camera.input(0)).expect("a frame");
    let options = StreamOptions {
        deadline_ms: Some(0.01),
        ..StreamOptions::default()
    };
    let mut late = open_with(&job, options);
    let frames = [&camera, &dark].map(|camera| late.render(&camera.input(0)).expect("a frame"));
    let chosen_anew = open_with(&job, options).render(&dark.input(0)).expect("a frame");
    assert!(
        2 * terms(&frames[0]) <= terms(&plain),
        "{}",
        frames[0].record.plan
    );
    // Estimated changes are in the notes.
    let estimates = |frame: &StreamFrame| {
        let stages = frame.record.plan.as_array().expect("stages").iter();
        let notes = stages.filter_map(|stage| stage["note"].as_str());
        let notes = notes.filter(|note| note.contains("would change"));
        notes.map(str::to_owned).collect::<Vec<_>>()
    };
    assert!(!estimates(&frames[0]).is_empty());
    assert_eq!(estimates(&frames[0]), estimates(&frames[1]));
    assert_ne!(estimates(&frames[0]), estimates(&chosen_anew));
}
