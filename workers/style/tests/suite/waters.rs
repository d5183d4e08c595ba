//! The shipped waters.

use imaging::Rgb;
use style::{Library, ModelInputs, Runtime, Session};

use crate::runtime;

const WATERS: [&str; 3] = ["atlantic", "mediterranean", "muddy"];

fn water(name: &str) -> Session {
    runtime()
        .session(Library::embedded().unwrap().get(name).unwrap())
        .unwrap()
}

fn ramp(width: usize, height: usize) -> Rgb<f32> {
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
fn every_size_from_one_pixel_gives_a_picture_of_that_size_and_twice_the_same_bits() {
    for name in WATERS {
        let (mut first, mut second) = (water(name), water(name));
        for (width, height) in [(1, 1), (8, 8), (37, 3), (3, 37), (97, 61)] {
            let styled = first.apply(&ramp(width, height), ModelInputs::default()).unwrap();
            assert_eq!(styled.size(), (width, height));
            let samples = || styled.planes().iter().flat_map(|plane| plane.data());
            assert!(samples().all(|sample| (0.0..=1.0).contains(sample)), "{name}");
            for session in [&mut first, &mut second] {
                let again = session
                    .apply(&ramp(width, height), ModelInputs::default())
                    .unwrap();
                let again = again.planes().iter().flat_map(|plane| plane.data());
                assert!(
                    samples().map(|v| v.to_bits()).eq(again.map(|v| v.to_bits())),
                    "{name} at {width}×{height}"
                );
            }
        }
    }
}

/// The water lifts black by its veil, and absorbs red first, or blue in mud.
#[test]
fn flat_frames_take_the_color_of_their_water() {
    let flat = |name: &str, light: f32| {
        let frame = Rgb::from_fn(64, 48, |_, _| [light; 3]);
        mean(&water(name).apply(&frame, ModelInputs::default()).unwrap())
    };
    for name in WATERS {
        let (black, white) = (flat(name, 0.0), flat(name, 1.0));
        assert!(
            black[1] > 0.05 && (0..3).all(|c| white[c] > black[c]),
            "{name}: {black:?} {white:?}"
        );
        let blue_water = name != "muddy";
        for [red, green, blue] in [black, white] {
            assert_eq!(
                blue > red + 0.1 && green > red + 0.1,
                blue_water,
                "{name}: {black:?} {white:?}"
            );
        }
    }
    assert!(flat("mediterranean", 0.5)[1] > flat("atlantic", 0.5)[1] + 0.1);
    let [red, _, blue] = flat("muddy", 0.5);
    assert!(red > blue, "mud takes blue first");
}

#[test]
fn the_three_waters_differ_clearly() {
    let means = WATERS.map(|name| mean(&water(name).apply(&ramp(96, 64), ModelInputs::default()).unwrap()));
    for (one, other) in [(0, 1), (0, 2), (1, 2)] {
        let apart = means[one]
            .iter()
            .zip(means[other])
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, f32::max);
        assert!(apart > 0.08, "{} and {}: {means:?}", WATERS[one], WATERS[other]);
    }
}

#[test]
fn sessions_on_several_threads_do_not_disturb_each_other() {
    let alone = water("muddy")
        .apply(&ramp(64, 48), ModelInputs::default())
        .unwrap();
    std::thread::scope(|scope| {
        let threads: Vec<_> = (0..4)
            .map(|_| {
                scope.spawn(|| {
                    water("muddy")
                        .apply(&ramp(64, 48), ModelInputs::default())
                        .unwrap()
                })
            })
            .collect();
        for thread in threads {
            assert_eq!(thread.join().unwrap(), alone);
        }
    });
}

#[test]
fn the_runtime_is_loaded_once_and_knows_its_version() {
    let runtime = runtime();
    let again = Runtime::load(None).unwrap();
    assert_eq!(
        (again.path(), again.version()),
        (runtime.path(), runtime.version())
    );
    let numbers: Vec<u32> = runtime
        .version()
        .split('.')
        .map(|number| number.parse().unwrap())
        .collect();
    assert!(numbers >= vec![1, 24], "{}", runtime.version());
    let elsewhere = tempfile::NamedTempFile::new().unwrap();
    let error = Runtime::load(Some(elsewhere.path())).unwrap_err();
    assert!(error.to_string().contains("this process already uses"), "{error}");
}
