//! The shipped waters on ONNX Runtime. Without the runtime these tests fail and say what to run.

use fathom_style::{Library, Runtime, Session, StyleError};
use imaging::Rgb;

fn runtime() -> Runtime {
    Runtime::load(None).unwrap_or_else(|missing| panic!("{missing}"))
}

fn session(runtime: &Runtime, name: &str) -> Session {
    runtime
        .session(Library::embedded().unwrap().get(name).unwrap())
        .unwrap()
}

fn scene(width: usize, height: usize) -> Rgb<f32> {
    Rgb::from_fn(width, height, |x, y| {
        let (u, v) = (x as f32 / width as f32, y as f32 / height as f32);
        [0.2 + 0.6 * u, 0.3 + 0.4 * v, 0.5 * (u + v)]
    })
}

fn mean(picture: &Rgb<f32>) -> [f32; 3] {
    picture
        .planes()
        .each_ref()
        .map(|plane| plane.data().iter().sum::<f32>() / plane.data().len() as f32)
}

#[test]
fn every_size_from_one_pixel_gives_a_picture_of_that_size_and_twice_the_same() {
    let runtime = runtime();
    for name in ["atlantic", "mediterranean", "muddy"] {
        let mut session = session(&runtime, name);
        for (width, height) in [(1, 1), (8, 8), (37, 3), (3, 37), (97, 61)] {
            let styled = session.apply(&scene(width, height)).unwrap();
            assert_eq!(styled.size(), (width, height));
            assert!(
                styled
                    .planes()
                    .iter()
                    .flat_map(|p| p.data())
                    .all(|v| (0.0..=1.0).contains(v)),
                "{name}"
            );
            assert_eq!(
                session.apply(&scene(width, height)).unwrap(),
                styled,
                "{name} at {width}×{height}"
            );
        }
    }
}

#[test]
fn the_three_waters_differ_clearly() {
    let runtime = runtime();
    let means = ["atlantic", "mediterranean", "muddy"]
        .map(|name| mean(&session(&runtime, name).apply(&scene(96, 64)).unwrap()));
    for (one, other) in [(0, 1), (0, 2), (1, 2)] {
        let apart: f32 = means[one]
            .iter()
            .zip(means[other])
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f32::max);
        assert!(apart > 0.08, "{one} and {other}: {means:?}");
    }
}

#[test]
fn a_sample_that_is_no_number_is_refused_before_it_spreads() {
    let runtime = runtime();
    let mut picture = scene(8, 8);
    picture.planes_mut()[1][5] = f32::NAN;
    assert!(matches!(
        session(&runtime, "muddy").apply(&picture),
        Err(StyleError::NotFinite { .. })
    ));
}

#[test]
fn bytes_that_are_no_model_are_an_error() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("broken.onnx"), b"no model at all").unwrap();
    let library = Library::embedded().unwrap().with_dir(folder.path()).unwrap();
    assert!(matches!(
        runtime().session(library.get("broken").unwrap()),
        Err(StyleError::Model { .. })
    ));
}
