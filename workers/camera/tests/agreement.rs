//! Fast variants against their references over sizes and inputs, and invariants of the camera.
#![allow(clippy::unwrap_used)]

use camera::defocus;
use camera::geometry::{self, Lens, PortRefraction, Sampling, SourcePicture};
use camera::sensor::{self, Chance, FixedPattern, Raw, SensorModel};
use camera::vignette::{self, FallOff};
use camera::{exposure, mosaic, preset};
use imaging::geometry::Intrinsics;
use imaging::{Plane, Rgb};
use spec::{Cfa, Distortion, Metering};

/// f32 of light up to about 1.
const ROUNDING: f64 = 1e-5;
const SIZES: [(usize, usize); 7] = [(2, 2), (3, 2), (5, 17), (64, 5), (131, 37), (256, 9), (257, 130)];

fn picture(width: usize, height: usize) -> Rgb<f32> {
    Rgb::from_fn(width, height, |x, y| {
        let wave = |k: usize| 0.5 + 0.5 * (0.3 * (x * k) as f32 + 0.7 * y as f32).sin();
        [wave(1), 0.6 * wave(2), 0.02 + 0.01 * wave(5)]
    })
}

fn worst(expected: &Rgb<f64>, actual: &Rgb<f32>) -> f64 {
    let planes = expected.planes().iter().zip(actual.planes());
    let errors = planes.flat_map(|(e, a)| e.data().iter().zip(a.data()));
    errors.map(|(e, &a)| (e - f64::from(a)).abs()).fold(0.0, f64::max)
}

fn lenses(width: usize, height: usize) -> Vec<Lens> {
    let distortion = |k1: f64, k2: f64, p1: f64| Distortion {
        k1,
        k2,
        p1,
        ..Distortion::default()
    };
    let distortions = [
        distortion(0.0, 0.0, 0.0),
        distortion(-0.15, 0.02, 0.01),
        distortion(0.2, 0.0, -0.01),
    ];
    let refractions = [
        PortRefraction::None,
        PortRefraction::Flat { index: [1.34; 3] },
        PortRefraction::Flat {
            index: [1.33, 1.34, 1.35],
        },
    ];
    let camera = Intrinsics::centered(0.8 * width.max(height) as f64, width, height);
    let all = distortions.into_iter().flat_map(|distortion| {
        refractions.into_iter().map(move |refraction| Lens {
            camera,
            distortion,
            refraction,
        })
    });
    all.collect()
}

#[test]
fn maps_and_samples_agree_with_their_references() {
    for (width, height) in SIZES {
        for lens in lenses(width, height) {
            lens.check((width, height)).unwrap();
            for supersample in [1, 2] {
                let source = SourcePicture::covering(&lens, (width, height), supersample).unwrap();
                let scene = picture(source.size.0, source.size.1);
                let maps = geometry::coordinates(&lens, &source, (width, height));
                let sampling = Sampling::new(&maps, source.size);
                assert_eq!(sampling.valid(), None, "the source holds all that is looked at");
                let planes = [0, 1, 2].map(|channel| {
                    let map = geometry::coordinates_reference(&lens, &source, (width, height), channel);
                    geometry::resample_reference(&scene.planes()[channel].map(|&v| f64::from(v)), &map)
                });
                let error = worst(&Rgb::new(planes).unwrap(), &sampling.picture(&scene));
                assert!(error < ROUNDING, "{width}×{height} of {lens:?}: {error:e}");
            }
        }
    }
}

#[test]
fn an_uploaded_picture_says_where_its_camera_looks_beyond_it() {
    let size = (80, 60);
    let camera = Intrinsics::centered(60.0, 80, 60);
    let barrel = Distortion {
        k1: -0.2,
        ..Distortion::default()
    };
    let lens = Lens {
        camera,
        distortion: barrel,
        refraction: PortRefraction::None,
    };
    let source = SourcePicture { size, camera };
    let maps = geometry::coordinates(&lens, &source, size);
    let sampling = Sampling::new(&maps, size);
    let valid = sampling.valid().expect("barrel distortion sees more");
    assert_eq!((valid.pixel(0, 0), valid.pixel(40, 30)), (0, 1));
    let labels = Plane::from_fn(80, 60, |x, y| (x / 10 + 100 * (y / 10)) as u16);
    let mapped = sampling.labels(&labels);
    assert_eq!(mapped.pixel(0, 0), labels.pixel(0, 0));
    for (x, y) in [(10, 20), (70, 50), (33, 7)] {
        let (column, row) = (maps[0].x.pixel(x, y), maps[0].y.pixel(x, y));
        let (column, row) = ((column + 0.5).floor() as usize, (row + 0.5).floor() as usize);
        assert_eq!(mapped.pixel(x, y), labels.pixel(column, row));
    }
}

#[test]
fn blur_has_the_reference_s_disc_at_every_pixel() {
    for (width, height) in SIZES {
        let scene = picture(width, height);
        let wide = scene.map(|&v| f64::from(v));
        let noise = |x: usize, y: usize| ((x * 7919 + y * 104_729) % 1013) as f64 / 1013.0;
        // On rings and next to them, where a last bit changes the disc.
        let on_ring = |x: usize, y: usize| {
            let radius = f64::from(8 * ((x + 3 * y) % 200) as u32 + 2).sqrt() / 16.0;
            [radius.next_down(), radius, radius.next_up()][x % 3]
        };
        let radii: [&dyn Fn(usize, usize) -> f64; 8] = [
            &|_, _| 0.0,
            &|_, _| 0.57,
            &|_, _| 1.7,
            &|_, _| 9.0,
            &|x, y| 0.5 + 0.02 * (x + y) as f64,
            &|x, y| 3.0 * noise(x, y),
            &|x, y| 12.0 * noise(x, y) * noise(y, x),
            &on_ring,
        ];
        for (number, radius) in radii.into_iter().enumerate() {
            let radii = Plane::from_fn(width, height, radius);
            let largest = radii.data().iter().copied().fold(0.0, f64::max);
            let exact = defocus::blur_reference(&wide, &radii);
            let error = worst(&exact, &defocus::blur(&scene, &radii));
            let bound = defocus::rounding_bound(largest, 1.0);
            assert!(
                error <= bound,
                "{width}×{height} by {number}: {error:e} of {bound:e}"
            );
        }
    }
}

#[test]
fn vignette_and_metering_agree_with_the_reference() {
    let metering = Metering {
        target: 0.4,
        percentile: 0.9,
        lag_frames: 0.0,
    };
    for (width, height) in SIZES {
        let falloff = FallOff::with_terms(
            0.8,
            [0.1, -0.4, 0.1],
            Intrinsics::centered(0.7 * width as f64, width, height),
            (width, height),
        );
        let mut fast = picture(width, height);
        let exact = Rgb::from_fn(width, height, |x, y| {
            fast.pixel(x, y).map(|v| f64::from(v) * falloff.factor(x, y))
        });
        let gain = exposure::metered_reference(&exact, &metering);
        let quick = exposure::metered(&fast, Some(&falloff), &metering);
        assert!(
            (gain / quick - 1.0).abs() < ROUNDING,
            "{width}×{height}: {gain} {quick}"
        );
        vignette::expose(&mut fast, Some(&falloff), gain);
        let error = worst(&exact.map(|v| v * gain), &fast);
        assert!(error < ROUNDING, "{width}×{height}: {error:e}");
    }
}

fn codes(raw: &Raw) -> Vec<u16> {
    match raw {
        Raw::Mosaic(plane) => plane.data().to_vec(),
        Raw::Planes(planes) => planes
            .iter()
            .flat_map(|plane| plane.data().iter().copied())
            .collect(),
    }
}

fn sensors() -> Vec<SensorModel> {
    let plain = preset::SENSORS[0].sensor();
    vec![
        plain,
        SensorModel {
            white_at: 0.01,
            gain: 16.0,
            cfa: Cfa::Gbrg,
            ..plain
        },
        SensorModel {
            white_at: 0.004,
            hot_share: 0.02,
            dark_e_per_s: 200.0,
            cfa: Cfa::None,
            ..plain
        },
        SensorModel {
            shot: false,
            read_noise_e: 0.0,
            cfa: Cfa::Bggr,
            ..plain
        },
        SensorModel {
            cfa: Cfa::Grbg,
            ..preset::SENSORS[1].sensor()
        },
        preset::SensorPreset::find("ideal").unwrap().sensor(),
    ]
}

#[test]
fn the_sensor_agrees_with_its_reference() {
    let (mut apart, mut all) = (0, 0);
    for (width, height) in SIZES {
        let scene = picture(width, height);
        let wide = scene.map(|&v| f64::from(v));
        for (number, sensor) in sensors().into_iter().enumerate() {
            let chance = Chance {
                seed: 5 + number as u64,
                frame: 3,
            };
            let samples = width * height * if sensor.cfa == Cfa::None { 3 } else { 1 };
            let pattern = FixedPattern::new(&sensor, chance.seed, samples);
            let fast = sensor::read(&scene, &sensor, chance, &pattern);
            let (fast, exact) = (
                codes(&fast),
                codes(&sensor::read_reference(&wide, &sensor, chance)),
            );
            assert_eq!(fast.len(), exact.len());
            let differences = fast
                .iter()
                .zip(&exact)
                .map(|(&a, &b)| (i32::from(a) - i32::from(b)).abs());
            let most = f64::from(differences.clone().max().unwrap());
            assert!(
                most <= sensor.dn_per_e().ceil(),
                "{number} at {width}×{height}: {most}"
            );
            apart += differences.filter(|&d| d > 0).count();
            all += fast.len();
        }
    }
    assert!(apart as f64 <= 1e-4 * all as f64, "{apart} of {all}");
}

#[test]
fn noise_has_the_mean_and_the_spread_of_its_model() {
    let sensor = SensorModel {
        prnu: 0.0,
        dsnu_e: 0.0,
        row_noise_e: 0.0,
        cfa: Cfa::None,
        ..preset::SENSORS[0].sensor()
    };
    for light in [0.0005f32, 0.002, 0.0035, 0.1, 0.7] {
        let scene = Rgb::from_fn(200, 200, |_, _| [light; 3]);
        let pattern = FixedPattern::new(&sensor, 1, 120_000);
        let chance = Chance { seed: 1, frame: 9 };
        let seen = mosaic::light_of(&sensor::read(&scene, &sensor, chance, &pattern), &sensor);
        let values: Vec<f64> = seen
            .planes()
            .iter()
            .flat_map(|p| p.data())
            .map(|&v| f64::from(v))
            .collect();
        let count = values.len() as f64;
        let mean = values.iter().sum::<f64>() / count;
        let spread = (values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / count).sqrt();
        let expected = sensor.noise_at(f64::from(light));
        let dark = sensor.dark_e_per_s * sensor.exposure_s / sensor.white_e();
        // Four standard errors of the mean, and of the spread; rounding to codes adds a twelfth of a code's square.
        assert!(
            (mean - f64::from(light) - dark).abs() < 4.0 * spread / count.sqrt(),
            "{light}: {mean}"
        );
        let step = sensor.light_per_dn();
        let rounded = (expected * expected + step * step / 12.0).sqrt();
        assert!(
            (spread / rounded - 1.0).abs() < 0.015,
            "{light}: {spread:e} {rounded:e}"
        );
    }
}

#[test]
fn the_pattern_stays_and_the_noise_changes_from_frame_to_frame() {
    let sensor = preset::SENSORS[0].sensor();
    let scene = Rgb::from_fn(64, 64, |_, _| [0.5f32; 3]);
    let pattern = FixedPattern::new(&sensor, 2, 64 * 64);
    let shot = |seed, frame| sensor::read(&scene, &sensor, Chance { seed, frame }, &pattern);
    assert_eq!(shot(2, 0), shot(2, 0));
    assert_ne!(shot(2, 0), shot(2, 1));
    assert_ne!(shot(2, 0), shot(3, 0));
    // The correlation of a thousand pixels between two frames is due to the pattern: with PRNU only, all of it.
    let quiet = SensorModel {
        shot: false,
        read_noise_e: 0.0,
        row_noise_e: 0.0,
        ..sensor
    };
    let pattern = FixedPattern::new(&quiet, 2, 64 * 64);
    let still = |frame| sensor::read(&scene, &quiet, Chance { seed: 2, frame }, &pattern);
    assert_eq!(still(0), still(1));
}

#[test]
fn a_pattern_too_large_to_be_kept_is_the_same() {
    // 4 Mi samples are stored, one more row is not.
    let sensor = preset::SENSORS[0].sensor();
    let (width, height) = (2048, 2050);
    let scene = Rgb::from_fn(width, height, |x, _| [0.1 + 1e-4 * x as f32; 3]);
    let chance = Chance { seed: 8, frame: 1 };
    let large = sensor::read(
        &scene,
        &sensor,
        chance,
        &FixedPattern::new(&sensor, 8, width * height),
    );
    let rows = Rgb::from_fn(width, 64, |x, y| scene.pixel(x, y));
    let small = sensor::read(&rows, &sensor, chance, &FixedPattern::new(&sensor, 8, width * 64));
    assert_eq!(codes(&large)[..width * 64], codes(&small));
}

#[test]
fn demosaicing_agrees_with_the_reference_and_keeps_even_light() {
    for (width, height) in SIZES {
        for cfa in [Cfa::Rggb, Cfa::Bggr, Cfa::Grbg, Cfa::Gbrg] {
            let sensor = SensorModel {
                cfa,
                ..preset::SENSORS[0].sensor()
            };
            let raw = Raw::Mosaic(Plane::from_fn(width, height, |x, y| {
                (64 + (x * 7919 + y * 104_729) % 4000) as u16
            }));
            let exact = mosaic::light_of_reference(&raw, &sensor);
            let error = worst(&exact, &mosaic::light_of(&raw, &sensor));
            assert!(error < ROUNDING, "{width}×{height} {cfa:?}: {error:e}");
            let even = mosaic::light_of(&Raw::Mosaic(Plane::filled(width, height, 2000)), &sensor);
            let value = even.pixel(0, 0)[0];
            assert!(
                even.planes()
                    .iter()
                    .all(|plane| plane.data().iter().all(|&v| v == value))
            );
        }
    }
}
