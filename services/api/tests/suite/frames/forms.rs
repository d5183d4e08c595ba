//! Pictures of forms, rendered without a job; nothing is stored.

use std::sync::Arc;
use std::time::Duration;

use api::{Limits, PriceLimits};
use imaging::codec::decode_picture;
use renderer::{
    ChannelOrder, Content, DepthSamples, Engine, PictureSamples, Stream, StreamDepth, StreamInput,
    StreamOptions, StreamPicture,
};
use serde_json::{Value, json};
use spec::{ArtifactKind, RangeKind};

use crate::common::bytes::{png, png_head, range_npy};
use crate::common::{Answer, Running, Setup, start, start_on, start_with};
use crate::rejections::bad_input::counted;

const SIZE: (usize, usize) = (24, 16);

fn job() -> Value {
    json!({"seed": 4, "water": {"optics": "jerlov-3C"}, "camera": {"sensor": {}}})
}

fn rendering() -> Setup {
    Setup {
        workers: 1,
        ..Setup::default()
    }
}

fn meters(x: usize, y: usize) -> f32 {
    1.0 + 0.1 * (x + y) as f32
}

/// A picture with its range and a stamp of 9 ns.
fn post(service: &Running, job: &Value) -> Answer {
    let (width, height) = SIZE;
    service.form(
        "/v1/renders",
        &[
            ("frame", job.to_string().as_bytes()),
            ("rgb", &png(width, height)),
            ("range", &range_npy(width, height, meters)),
            ("stamp_ns", b"9"),
        ],
    )
}

/// The codes of a stream with the same job and stamp.
fn expected() -> Vec<u8> {
    let engine = Arc::new(Engine::new(style::Library::embedded().unwrap(), None));
    let text = job().to_string();
    let mut stream = Stream::open(text.as_bytes(), StreamOptions::default(), &engine).unwrap();
    let (width, height) = SIZE;
    let codes = decode_picture(&png(width, height)).unwrap().to_rgb8();
    let range: Vec<f32> = (0..width * height)
        .map(|i| meters(i % width, i / width))
        .collect();
    let input = StreamInput {
        picture: StreamPicture {
            size: SIZE,
            channels: ChannelOrder::Rgb,
            samples: PictureSamples::Srgb(codes.data()),
        },
        depth: Some(StreamDepth {
            kind: RangeKind::Range,
            size: SIZE,
            samples: DepthSamples::Meters(&range),
        }),
        instances: None,
        camera: None,
        stamp_ns: Some(9),
        pose: None,
    };
    match stream.render(&input).unwrap().content(&ArtifactKind::Rgb) {
        Some(Content::Picture(picture)) => picture.data().to_vec(),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_picture_has_the_bytes_of_a_stream_and_leaves_nothing_behind() {
    let data = start().stop();
    let before = counted(&data);
    let service = start_on(data, rendering());
    for _ in 0..2 {
        let answer = post(&service, &job());
        assert_eq!(
            (answer.status, answer.header("content-type")),
            (200, "image/png"),
            "{}",
            answer.text()
        );
        assert_eq!(decode_picture(&answer.body).unwrap().to_rgb8().data(), expected());
    }
    assert_eq!(service.shown(), [0, 0, 0]);
    assert_eq!(counted(&service.stop()), before);
}

#[test]
fn wrong_parts_leave_nothing_behind_and_are_named_together() {
    let data = start().stop();
    let before = counted(&data);
    let service = start_on(data, rendering());
    let (picture, text) = (png(8, 6), job().to_string());
    let fine = [("frame", text.as_bytes()), ("rgb", picture.as_slice())];
    let large = png_head(60_000, 60_000);
    for (fields, pointers) in [
        (vec![fine[0]], vec!["/rgb"]),
        (vec![fine[0], fine[1], fine[1]], vec!["/rgb"]),
        (vec![fine[1], ("x", b"1".as_slice())], vec!["/x", "/frame"]),
        (vec![fine[0], ("rgb", &large)], vec!["/rgb"]),
        (vec![fine[1], ("frame", b"{".as_slice())], vec!["/frame"]),
        (
            vec![fine[0], ("rgb", b"no"), ("range", b"no"), ("instances", b"no")],
            vec!["/rgb", "/range", "/instances"],
        ),
        (
            vec![
                fine[0],
                fine[1],
                ("stamp_ns", b"x"),
                ("camera", b"x"),
                ("pose", b"x"),
            ],
            vec!["/stamp_ns", "/camera", "/pose"],
        ),
    ] {
        let answer = service.form("/v1/renders", &fields);
        let problem = answer.problem(422, "validation");
        let errors = problem["errors"].as_array().unwrap();
        let found: Vec<&str> = errors
            .iter()
            .map(|error| error["pointer"].as_str().unwrap())
            .collect();
        assert_eq!(found, pointers, "{problem}");
    }
    assert_eq!(service.shown(), [0, 0, 0]);
    assert_eq!(counted(&service.stop()), before);
}

#[test]
fn limits_of_prices_and_callers_hold() {
    let service = start_with(Setup {
        prices: PriceLimits {
            frame: Duration::from_nanos(1),
            ..PriceLimits::default()
        },
        ..rendering()
    });
    post(&service, &job()).problem(422, "too-expensive");
    let service = start_with(Setup {
        prices: PriceLimits {
            caller: Duration::from_nanos(1),
            ..PriceLimits::default()
        },
        ..rendering()
    });
    post(&service, &job()).problem(429, "caller-limit");
    let service = start_with(Setup {
        limits: Limits {
            renders: 0,
            ..rendering().limits
        },
        ..rendering()
    });
    post(&service, &job()).problem(503, "overloaded");
}

#[test]
fn a_service_that_renders_nothing_says_so() {
    let problem = post(&start(), &job()).problem(422, "render-failed");
    assert!(problem["detail"].as_str().unwrap().contains("--workers 0"));
}

#[test]
fn a_process_that_fails_is_reported_and_started_again() {
    let service = start_with(Setup {
        program: "/bin/false",
        ..rendering()
    });
    for _ in 0..2 {
        let problem = post(&service, &job()).problem(422, "render-failed");
        assert!(
            problem["detail"].as_str().unwrap().contains("process"),
            "{problem}"
        );
    }
}
