//! Streams: the frames of jobs over the same pictures, for any order of frames with and without distances.

mod inputs;
mod jobs;

use imaging::{Plane, Rgb8};
use renderer::{
    ChannelOrder, Content, DepthSamples, InputError, PictureSamples, Stream, StreamDepth, StreamError,
    StreamFrame, StreamInput, StreamOptions, StreamPicture, Vary,
};
use serde_json::{Value, json};
use spec::{ArtifactKind, RangeKind};

use crate::common::{Files, HEIGHT, WIDTH, engine_without_runtime, pixels, render};

const SIZE: (usize, usize) = (WIDTH, HEIGHT);

/// The arrays of the files of [`Files`].
pub(crate) struct Camera {
    pub(crate) codes: Vec<u8>,
    pub(crate) meters: Vec<f32>,
}

impl Camera {
    fn new() -> Self {
        let picture = Rgb8::from_fn(WIDTH, HEIGHT, |x, y| [5 * x as u8, 7 * y as u8, 90]);
        let range = Plane::from_fn(WIDTH, HEIGHT, |x, y| match (x, y) {
            (0, 0) => f32::NAN,
            _ => 1.0 + 4.0 * x as f32 / (WIDTH - 1) as f32,
        });
        Self {
            codes: picture.data().to_vec(),
            meters: range.data().to_vec(),
        }
    }

    fn input(&self, stamp_ns: u64) -> StreamInput<'_> {
        StreamInput {
            picture: StreamPicture {
                size: SIZE,
                channels: ChannelOrder::Rgb,
                samples: PictureSamples::Srgb(&self.codes),
            },
            depth: Some(StreamDepth {
                kind: RangeKind::Range,
                size: SIZE,
                samples: DepthSamples::Meters(&self.meters),
            }),
            instances: None,
            camera: None,
            stamp_ns: Some(stamp_ns),
            pose: None,
        }
    }

    fn input_without_range(&self, stamp_ns: u64) -> StreamInput<'_> {
        StreamInput {
            depth: None,
            ..self.input(stamp_ns)
        }
    }
}

fn open(job: &Value) -> Stream {
    open_with(job, StreamOptions::default())
}

fn open_with(job: &Value, options: StreamOptions) -> Stream {
    let opened = Stream::open(job.to_string().as_bytes(), options, &engine_without_runtime());
    opened.unwrap_or_else(|invalid| panic!("{invalid}"))
}

fn codes(frame: &StreamFrame, kind: &str) -> Vec<u8> {
    match frame.content(&ArtifactKind::parse(kind).unwrap()) {
        Some(Content::Picture(picture)) => picture.data().to_vec(),
        other => panic!("{kind} is {other:?}"),
    }
}

fn rgb(stream: &mut Stream, input: &StreamInput<'_>) -> Vec<u8> {
    codes(&stream.render(input).unwrap(), "rgb")
}

fn refused(stream: &mut Stream, input: &StreamInput<'_>) -> Vec<InputError> {
    match stream.render(input) {
        Err(StreamError::Input(errors)) => errors,
        other => panic!("{other:?}"),
    }
}

fn level_pose(x_m: f64) -> [[f64; 4]; 4] {
    [
        [1.0, 0.0, 0.0, x_m],
        [0.0, 0.0, 1.0, 8.0],
        [0.0, -1.0, 0.0, -9.5],
        [0.0, 0.0, 0.0, 1.0],
    ]
}

/// Every stage of the paper, lamps, particles and a sensor.
fn full_job() -> Value {
    json!({
        "seed": 11,
        "water": {"optics": "jerlov-3C", "style": "muddy", "snow": {"density_per_m3": 4000}},
        "alpha": 0.6,
        "lights": [
            {"kind": "point", "position_m": [0.3, -0.2, 0], "intensity": [4, 4, 4]},
            {"kind": "haze", "x": 0.3, "y": 1, "size": 0.1, "intensity": 0.4}
        ],
        "camera": {"sensor": {}},
        "enhance": ["hscm"],
        "artifacts": ["rgb", "enhanced.hscm", "range"]
    })
}

#[test]
fn a_frame_is_that_of_a_job_over_the_same_files() {
    let (files, camera) = (Files::new(), Camera::new());
    let expected = render(&files.job(&full_job()));
    let frame = open(&full_job()).render(&camera.input(0)).unwrap();
    assert_eq!(codes(&frame, "rgb"), pixels(&expected, "rgb"));
    assert_eq!(codes(&frame, "enhanced.hscm"), pixels(&expected, "enhanced.hscm"));
    assert_eq!(frame.plan(), &expected.record.plan);
    assert_eq!(
        frame.error_bound(),
        expected
            .record
            .promise
            .map(|promise| promise.bound + promise.relative)
    );
    let Some(Content::Range(range)) = frame.content(&ArtifactKind::Range) else {
        panic!("no range")
    };
    assert_eq!(range.data()[1..], camera.meters[1..]);
}

#[test]
fn the_same_stamps_give_the_same_bytes_in_any_order() {
    let camera = Camera::new();
    let mut first = open(&full_job());
    let pictures: Vec<_> = (1..4)
        .map(|stamp| rgb(&mut first, &camera.input(stamp)))
        .collect();
    assert!(
        pictures[0] != pictures[1] && pictures[1] != pictures[2],
        "noise of the sensor"
    );
    let mut second = open(&full_job());
    for stamp in [3, 1, 2, 1] {
        let picture = rgb(&mut second, &camera.input(stamp));
        assert!(picture == pictures[stamp as usize - 1], "{stamp}");
    }
    // Without stamps, frames are numbered.
    let unnumbered = StreamInput {
        stamp_ns: None,
        ..camera.input(0)
    };
    let mut counted = open(&full_job());
    let _ = rgb(&mut counted, &unnumbered);
    assert!(rgb(&mut counted, &unnumbered) == pictures[0]);
}

#[test]
fn a_frame_without_distances_goes_on_to_style_and_haze() {
    let camera = Camera::new();
    let mut job = full_job();
    job["camera"] = json!({});
    let mut dry = job.clone();
    dry["water"] = json!({"style": "muddy"});
    dry["lights"] = json!([full_job()["lights"][1]]);
    let expected = rgb(&mut open(&dry), &camera.input_without_range(5));
    let mut stream = open(&job);
    let wet = rgb(&mut stream, &camera.input(5));
    let frame = stream.render(&camera.input_without_range(5)).unwrap();
    assert!(codes(&frame, "rgb") == expected && expected != wet && expected != camera.codes);
    assert!(frame.content(&ArtifactKind::Range).is_none());
    assert!(
        frame
            .record
            .warnings
            .contains(&"the scene has no range: the water's optics are skipped".to_owned())
    );
    assert!(
        rgb(&mut stream, &camera.input(5)) == wet,
        "the next frame has distances again"
    );
}

#[test]
fn a_style_that_takes_a_range_reports_that_it_is_skipped() {
    let camera = Camera::new();
    let mut stream = open(&json!({"water": {"style": "atlantic-range"}}));
    let frame = stream.render(&camera.input_without_range(0)).unwrap();
    assert_eq!(codes(&frame, "rgb"), camera.codes);
    let skipped = "the scene has no range: the style \"atlantic-range\" is skipped";
    assert!(
        frame.record.warnings.contains(&skipped.to_owned()),
        "{:?}",
        frame.record.warnings
    );
}

#[test]
fn particles_keep_their_places_in_the_world_of_poses_and_drift_with_time() {
    let camera = Camera::new();
    let seen_from = |stream: &mut Stream, stamp_ns: u64, pose| {
        let input = StreamInput {
            pose,
            ..camera.input(stamp_ns)
        };
        rgb(stream, &input)
    };
    let snow = json!({"density_per_m3": 20000});
    let mut stream = open(
        &json!({"seed": 2, "water": {"optics": "jerlov-1C", "snow": snow, "turbidity": {"contrast": 0.8}}}),
    );
    let here = seen_from(&mut stream, 7, Some(level_pose(0.0)));
    assert!(
        seen_from(&mut stream, 8, Some(level_pose(0.4))) != here,
        "the camera moved"
    );
    assert!(
        seen_from(&mut stream, 9, Some(level_pose(0.0))) == here,
        "it came back"
    );
    let carried = seen_from(&mut stream, 7, None);
    assert!(
        seen_from(&mut stream, 8, None) == carried,
        "without a pose they move with the camera"
    );
    let snow = json!({"density_per_m3": 20000, "drift_m_per_s": [0.2, 0, 0]});
    let mut drifting = open(&json!({"seed": 2, "water": {"optics": "jerlov-1C", "snow": snow}}));
    let begun = seen_from(&mut drifting, 0, Some(level_pose(0.0)));
    let later = seen_from(&mut drifting, 2_000_000_000, Some(level_pose(0.0)));
    assert!(later != begun);
    // After 2 s the current has carried the particles 0.4 m: a camera that moves along sees the same ones.
    assert!(seen_from(&mut drifting, 2_000_000_000, Some(level_pose(0.4))) == begun);
}
