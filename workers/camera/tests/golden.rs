//! Reference vectors: every folder of kind `camera` under `tests/vectors/realism`, and under `realism/` of each path in
//! `FATHOM_GOLDEN_EXTRA`. Each holds `params.json` and the arrays after each part of the camera.
#![allow(clippy::unwrap_used)]

use std::path::{Path, PathBuf};

use camera::geometry::{Lens, PortRefraction, Sampling, SourcePicture};
use camera::sensor::{Chance, FixedPattern, Raw, SensorModel};
use camera::vignette::FallOff;
use camera::{balance, defocus, exposure, geometry, mosaic, sensor, tone};
use imaging::codec::{self, NpyArray, NpyValues};
use imaging::geometry::Intrinsics;
use imaging::{Plane, Rgb};
use serde::Deserialize;
use serde_json::Value;
use spec::{Cfa, Distortion, Metering, Tone, WhiteBalance};

/// Largest error of light in f64 and f32, and of positions in px.
const EXACT: f64 = 1e-10;
const FAST: f64 = 1e-5;
const PLACE_PX: f64 = 1e-9;
/// Light from the stored codes.
const FROM_CODES: f64 = 1e-9;
/// Share of pixels whose code may differ by an electron: another library's sine, cosine and logarithm.
const CODES_APART: f64 = 1e-4;
/// Share of result samples that may differ by 1.
const RESULT_APART: f64 = 1e-3;

#[derive(Deserialize)]
struct Numbers {
    full_well_e: f64,
    white_at: f64,
    prnu: f64,
    dcnu: f64,
    dsnu_e: f64,
    dark_e_per_s: f64,
    exposure_s: f64,
    read_noise_e: f64,
    row_noise_e: f64,
    shot: bool,
    adc_bits: u8,
    black_dn: u16,
    gain: f64,
    cfa: String,
}

impl Numbers {
    fn sensor(&self) -> SensorModel {
        SensorModel {
            full_well_e: self.full_well_e,
            white_at: self.white_at,
            prnu: self.prnu,
            dcnu: self.dcnu,
            dsnu_e: self.dsnu_e,
            dark_e_per_s: self.dark_e_per_s,
            hot_share: 0.0,
            exposure_s: self.exposure_s,
            read_noise_e: self.read_noise_e,
            row_noise_e: self.row_noise_e,
            shot: self.shot,
            bits: self.adc_bits,
            black_dn: self.black_dn,
            gain: self.gain,
            cfa: match self.cfa.as_str() {
                "RGGB" => Cfa::Rggb,
                "BGGR" => Cfa::Bggr,
                "GRBG" => Cfa::Grbg,
                "GBRG" => Cfa::Gbrg,
                "none" => Cfa::None,
                other => panic!("cfa {other}"),
            },
        }
    }
}

struct Case {
    folder: PathBuf,
    parameters: Value,
}

impl Case {
    fn read(folder: &Path) -> Self {
        let text = std::fs::read_to_string(folder.join("params.json")).unwrap();
        Self {
            folder: folder.to_owned(),
            parameters: serde_json::from_str(&text).unwrap(),
        }
    }

    fn number(&self, pointer: &str) -> f64 {
        let value = self.parameters.pointer(pointer);
        value
            .and_then(Value::as_f64)
            .unwrap_or_else(|| panic!("{pointer}"))
    }

    fn triple(&self, pointer: &str) -> [f64; 3] {
        serde_json::from_value(self.parameters.pointer(pointer).unwrap().clone()).unwrap()
    }

    fn array(&self, name: &str) -> (Vec<usize>, Vec<f64>) {
        let bytes = std::fs::read(self.folder.join(format!("{name}.npy"))).unwrap();
        let NpyArray { shape, values, .. } = codec::decode_npy(&bytes).unwrap();
        let values = match values {
            NpyValues::F64(values) => values,
            NpyValues::F32(values) => values.into_iter().map(f64::from).collect(),
            NpyValues::U8(values) => values.into_iter().map(f64::from).collect(),
            NpyValues::U16(values) => values.into_iter().map(f64::from).collect(),
            NpyValues::Wide(values) => values.into_iter().map(|value| value as f64).collect(),
        };
        (shape, values)
    }

    fn picture(&self, name: &str) -> Rgb<f64> {
        let (shape, values) = self.array(name);
        Rgb::from_fn(shape[1], shape[0], |x, y| {
            [0, 1, 2].map(|channel| values[3 * (y * shape[1] + x) + channel])
        })
    }

    fn size(&self) -> (usize, usize) {
        (self.number("/width") as usize, self.number("/height") as usize)
    }

    fn lens(&self) -> Lens {
        let index = self.triple("/n_w");
        Lens {
            camera: Intrinsics {
                focal_px: self.number("/focal_px"),
                cx: self.number("/cx"),
                cy: self.number("/cy"),
            },
            distortion: Distortion {
                k1: self.number("/distortion/k1"),
                k2: self.number("/distortion/k2"),
                k3: self.number("/distortion/k3"),
                p1: self.number("/distortion/p1"),
                p2: self.number("/distortion/p2"),
            },
            refraction: match self.parameters["port"].as_str().unwrap() {
                "flat" => PortRefraction::Flat { index },
                _ => PortRefraction::None,
            },
        }
    }

    fn source(&self) -> SourcePicture {
        SourcePicture {
            size: (
                self.number("/source/width") as usize,
                self.number("/source/height") as usize,
            ),
            camera: Intrinsics {
                focal_px: self.number("/source/focal_px"),
                cx: self.number("/source/cx"),
                cy: self.number("/source/cy"),
            },
        }
    }
}

fn worst<T: Copy + Into<f64>>(expected: &Rgb<f64>, actual: &Rgb<T>) -> f64 {
    assert_eq!(expected.size(), actual.size());
    let planes = expected.planes().iter().zip(actual.planes());
    let errors = planes.flat_map(|(e, a)| e.data().iter().zip(a.data()));
    errors.map(|(e, &a)| (e - a.into()).abs()).fold(0.0, f64::max)
}

fn near<T: Copy + Into<f64>>(what: &str, expected: &Rgb<f64>, actual: &Rgb<T>, tolerance: f64) {
    let error = worst(expected, actual);
    println!("   {what}: {error:.1e}");
    assert!(error <= tolerance, "{what}: {error:e} exceeds {tolerance:e}");
}

fn narrow(picture: &Rgb<f64>) -> Rgb<f32> {
    picture.map(|&v| v as f32)
}

fn check(case: &Case) {
    println!("{}", case.folder.display());
    geometry_agrees(case);
    blur_agrees(case);
    brightness_agrees(case);
    sensor_agrees(case);
    codes_agree(case);
}

fn geometry_agrees(case: &Case) {
    let (lens, source, size) = (case.lens(), case.source(), case.size());
    lens.check(size).unwrap();
    let input = case.picture("input_linear");
    let (shape, places) = case.array("map_xy");
    assert_eq!(shape, [3, 2, size.1, size.0]);
    let fast = geometry::coordinates(&lens, &source, size);
    let expected = case.picture("after_geometry");
    let mut planes = Vec::new();
    for channel in 0..3 {
        let map = geometry::coordinates_reference(&lens, &source, size, channel);
        let quick = fast.get(channel).unwrap_or(&fast[0]);
        let pixels = size.0 * size.1;
        for (axis, pair) in [[&map.x, &quick.x], [&map.y, &quick.y]].into_iter().enumerate() {
            let expected = &places[(2 * channel + axis) * pixels..][..pixels];
            for plane in pair {
                let errors = plane.data().iter().zip(expected).map(|(a, e)| (a - e).abs());
                let error = errors.fold(0.0, f64::max);
                assert!(error <= PLACE_PX, "map of channel {channel}: {error:e}");
            }
        }
        planes.push(geometry::resample_reference(&input.planes()[channel], &map));
    }
    let reference = Rgb::new(planes.try_into().unwrap()).unwrap();
    near("geometry", &expected, &reference, EXACT);
    let sampling = Sampling::new(&fast, source.size);
    assert!(
        sampling.valid().is_none(),
        "the source holds all that is looked at"
    );
    near(
        "geometry in f32",
        &expected,
        &sampling.picture(&narrow(&input)),
        FAST,
    );
}

fn blur_agrees(case: &Case) {
    let (input, expected) = (case.picture("after_geometry"), case.picture("after_blur"));
    let radius = case.number("/defocus_radius_px");
    let (width, height) = input.size();
    let reference = defocus::blur_reference(&input, &Plane::filled(width, height, radius));
    near("blur", &expected, &reference, EXACT);
    let fast = defocus::blur(&narrow(&input), &Plane::filled(width, height, radius));
    near("blur in f32", &expected, &fast, FAST);
}

fn brightness_agrees(case: &Case) {
    let terms = ["/vignette/v1", "/vignette/v2", "/vignette/v3"].map(|pointer| case.number(pointer));
    let falloff = FallOff::with_terms(case.number("/vignette/v"), terms, case.lens().camera, case.size());
    let factors = falloff.reference(case.size());
    let (_, expected) = case.array("vignette");
    let errors = factors.data().iter().zip(&expected).map(|(a, e)| (a - e).abs());
    assert!(errors.fold(0.0, f64::max) <= EXACT);
    let metering = Metering {
        target: case.number("/exposure/target"),
        percentile: case.number("/exposure/percentile"),
        lag_frames: 0.0,
    };
    let blurred = case.picture("after_blur");
    let vignetted = Rgb::from_fn(blurred.width(), blurred.height(), |x, y| {
        blurred.pixel(x, y).map(|v| v * factors.pixel(x, y))
    });
    let gain = exposure::metered_reference(&vignetted, &metering);
    assert!((gain - case.number("/exposure/gain")).abs() < EXACT, "{gain}");
    let expected = case.picture("exposed");
    near("exposed", &expected, &vignetted.map(|v| v * gain), EXACT);
    let mut fast = narrow(&blurred);
    let gain = exposure::metered(&fast, Some(&falloff), &metering);
    camera::vignette::expose(&mut fast, Some(&falloff), gain);
    near("exposed in f32", &expected, &fast, FAST);
}

fn stored_codes(case: &Case) -> Raw {
    let (shape, values) = case.array("dn");
    let pixels = shape[0] * shape[1];
    let plane = |channel: usize, channels: usize| {
        let codes = (0..pixels).map(|pixel| values[pixel * channels + channel] as u16);
        Plane::new(shape[1], shape[0], codes.collect()).unwrap()
    };
    match shape.len() {
        2 => Raw::Mosaic(plane(0, 1)),
        _ => Raw::Planes([0, 1, 2].map(|channel| plane(channel, 3))),
    }
}

fn planes(raw: &Raw) -> Vec<&Plane<u16>> {
    match raw {
        Raw::Mosaic(plane) => vec![plane],
        Raw::Planes(planes) => planes.iter().collect(),
    }
}

fn numbers(case: &Case) -> SensorModel {
    let numbers: Numbers = serde_json::from_value(case.parameters["sensor"].clone()).unwrap();
    numbers.sensor()
}

fn sensor_agrees(case: &Case) {
    let sensor = numbers(case);
    let chance = Chance {
        seed: case.number("/seed") as u64,
        frame: case.number("/frame") as u64,
    };
    let exposed = case.picture("exposed");
    let expected = stored_codes(case);
    let samples = planes(&expected).iter().map(|plane| plane.data().len()).sum();
    let pattern = FixedPattern::new(&sensor, chance.seed, samples);
    let reference = sensor::read_reference(&exposed, &sensor, chance);
    // The fast variant gets the rounded light: f32 rounding is not the sensor's error.
    let fast = sensor::read(&narrow(&exposed), &sensor, chance, &pattern);
    let light = narrow(&exposed).map(|&v| f64::from(v));
    let of_same_light = sensor::read_reference(&light, &sensor, chance);
    for (what, actual, expected) in [
        ("reference", &reference, &expected),
        ("fast", &fast, &of_same_light),
    ] {
        let pairs = planes(actual).into_iter().zip(planes(expected));
        let apart: Vec<i32> = pairs
            .flat_map(|(a, e)| a.data().iter().zip(e.data()))
            .map(|(&a, &e)| (i32::from(a) - i32::from(e)).abs())
            .collect();
        let different = apart.iter().filter(|&&d| d > 0).count();
        let most = apart.iter().copied().max().unwrap_or(0);
        println!(
            "   {what}: {different} codes of {} differ, by {most} at most",
            apart.len()
        );
        assert!(different as f64 <= (CODES_APART * apart.len() as f64).ceil());
        assert!(f64::from(most) <= sensor.dn_per_e().ceil());
    }
}

fn codes_agree(case: &Case) {
    let sensor = numbers(case);
    let raw = stored_codes(case);
    let expected = case.picture("demosaiced");
    let reference = mosaic::light_of_reference(&raw, &sensor);
    near("light", &expected, &reference, FROM_CODES);
    let mut fast = mosaic::light_of(&raw, &sensor);
    near("light in f32", &expected, &fast, FAST);
    let law = match &case.parameters["white_balance"] {
        Value::String(name) if name == "grey_world" => WhiteBalance::GrayWorld,
        other => WhiteBalance::Fixed(serde_json::from_value(other.clone()).unwrap()),
    };
    let gains = balance::gains(&reference, law);
    let expected = case.triple("/gains");
    assert!(
        gains
            .iter()
            .zip(expected)
            .all(|(g, e)| (g - e).abs() < FROM_CODES),
        "{gains:?}"
    );
    assert_eq!(case.parameters["tone"], "srgb");
    let gains = balance::gains(&fast, law);
    balance::apply(&mut fast, gains);
    let (codes, _) = tone::codes(&fast, Tone::Srgb);
    let (_, expected) = case.array("codes");
    let apart: Vec<f64> = codes
        .data()
        .iter()
        .zip(&expected)
        .map(|(&a, e)| (f64::from(a) - e).abs())
        .collect();
    let different = apart.iter().filter(|&&d| d > 0.0).count();
    println!("   result: {different} codes of {} differ", apart.len());
    assert!(different as f64 <= (RESULT_APART * apart.len() as f64).ceil());
    assert!(apart.iter().all(|&d| d <= 1.0));
}

fn folders() -> Vec<PathBuf> {
    let own = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/vectors");
    let extra = std::env::var("FATHOM_GOLDEN_EXTRA").unwrap_or_default();
    let extra = extra
        .split(':')
        .filter(|path| !path.is_empty())
        .map(PathBuf::from);
    let places = std::iter::once(own)
        .chain(extra)
        .map(|place| place.join("realism"));
    places
        .flat_map(|place| {
            std::fs::read_dir(&place).unwrap_or_else(|error| panic!("{}: {error}", place.display()))
        })
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.is_dir())
        .collect()
}

#[test]
fn golden_camera_cases_pass() {
    let cases: Vec<Case> = folders()
        .iter()
        .map(|folder| Case::read(folder))
        .filter(|case| case.parameters["kind"] == "camera")
        .collect();
    assert!(cases.len() >= 2, "{} cases", cases.len());
    cases.iter().for_each(check);
}
