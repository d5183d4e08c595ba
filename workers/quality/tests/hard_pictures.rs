//! Pictures that break published programs, and properties of every picture.

use imaging::vector::vec3;
use imaging::{Channels, Plane, Raster, Rgb8, Samples};
use proptest::prelude::*;
use quality::{
    CameraMotion, FrameFeatures, Illumination, MetricId, Motion, Needs, PreviousFrame, QualityError,
    RelativePose, Sequence, Subject, TrueLight, measure, measure_subject,
};

/// Rounding at the ends of a range.
const SLACK: f64 = 1e-9;
const PROFILES: [&str; 3] = ["panetta", "funie", "table1"];

/// The metrics of a picture and its clean version.
fn list_metrics() -> Vec<MetricId> {
    MetricId::all()
        .filter(|id| matches!(id.info().needs, Needs::Nothing | Needs::PictureInAir))
        .collect()
}

fn metric(picture: &Rgb8, name: &str) -> f64 {
    let id = MetricId::parse(name).expect("a name of the registry");
    measure(picture, None, &[id]).expect("a picture with pixels")[0].1
}

fn constant(pixel: [u8; 3]) -> Rgb8 {
    Rgb8::from_fn(48, 40, |_, _| pixel)
}

fn textured(width: usize, height: usize) -> Rgb8 {
    Rgb8::from_fn(width, height, |x, y| {
        [(37 * x + 11 * y) as u8, (5 * x + 91 * y) as u8, (x * y) as u8]
    })
}

#[test]
fn a_constant_picture_has_no_entropy_no_edges_and_no_contrast() {
    for pixel in [[0; 3], [255; 3], [60, 120, 140]] {
        let picture = constant(pixel);
        for name in [
            "entropy",
            "entropy_joint_rgb",
            "entropy_2d",
            "uism",
            "uism@funie",
            "uiconm",
            "uiconm@table1",
        ] {
            assert_eq!(metric(&picture, name), 0.0, "{name} of {pixel:?}");
        }
    }
    // The deep-learning profile compares channels: only a gray constant has no contrast.
    assert_eq!(metric(&constant([90; 3]), "uiconm@funie"), 0.0);
    assert!(metric(&constant([60, 120, 140]), "uiconm@funie") > 0.3);
}

#[test]
fn a_color_cast_without_spread_has_a_negative_colorfulness() {
    // RG = -60, YB = -50: the norm is sqrt(6100).
    let expected = -0.0268 * 6100f64.sqrt();
    assert!((metric(&constant([60, 120, 140]), "uicm") - expected).abs() < 1e-12);
}

#[test]
fn a_gray_picture_has_no_colorfulness_and_every_other_metric() {
    let gray = Raster::from(Plane::from_fn(40, 30, |x, y| (x * y) as u8)).to_rgb8();
    for profile in PROFILES {
        assert_eq!(metric(&gray, &format!("uicm@{profile}")), 0.0);
    }
    for id in MetricId::all().filter(|id| id.info().needs == Needs::Nothing) {
        assert!(metric(&gray, &id.to_string()).is_finite(), "{id}");
    }
}

#[test]
fn a_picture_smaller_than_a_block_is_one_block() {
    // One block of 3 × 2: the intensities 10 and 30 give q = 1026 · 20 / 1016 / (40 - 300 / 1026).
    let picture = Rgb8::from_fn(3, 2, |x, _| if x == 0 { [10; 3] } else { [30; 3] });
    let q: f64 = (1026.0 * 20.0 / 1016.0) / (40.0 - 300.0 / 1026.0);
    assert!((metric(&picture, "uiconm") + q * q.ln()).abs() < 1e-12);
}

#[test]
fn a_black_pixel_takes_its_block_out_of_the_sharpness() {
    // Two blocks. The left one is independent of black in the right one, be it a pixel or nearly all of it.
    let whole = Rgb8::from_fn(20, 10, |x, y| [(100 + 3 * (x % 10) + 5 * y) as u8; 3]);
    let black = |hidden: fn(usize, usize) -> bool| {
        Rgb8::from_fn(
            20,
            10,
            |x, y| if hidden(x, y) { [0; 3] } else { whole.pixel(x, y) },
        )
    };
    let (pierced, dark) = (black(|x, y| (x, y) == (16, 5)), black(|x, _| x > 11));
    let left_alone = metric(&pierced, "uism");
    assert!(0.0 < left_alone && left_alone < metric(&whole, "uism"));
    assert_eq!(left_alone, metric(&dark, "uism"));
    assert!(metric(&pierced, "uiconm@table1").is_finite());
}

#[test]
fn opponent_colors_are_subtracted_in_wide_numbers() {
    // Half red, half cyan: RG = ±255, YB = ±127.5; the trimmed mean of ten is over 4 and 4.
    let picture = Rgb8::from_fn(10, 1, |x, _| if x < 5 { [255, 0, 0] } else { [0, 255, 255] });
    let expected = 0.1586 * (255f64.powi(2) + 127.5f64.powi(2)).sqrt();
    assert!((metric(&picture, "uicm") - expected).abs() < 1e-9);
}

#[test]
fn sixteen_bits_measure_like_the_eight_that_they_reduce_to() {
    let eight = textured(30, 20);
    let wide = eight.data().iter().map(|&code| 257 * u16::from(code)).collect();
    let sixteen = Raster::new(30, 20, Channels::Rgb, Samples::U16(wide), None)
        .unwrap()
        .to_rgb8();
    for id in MetricId::all().filter(|id| id.info().needs == Needs::Nothing) {
        assert_eq!(
            metric(&eight, &id.to_string()),
            metric(&sixteen, &id.to_string()),
            "{id}"
        );
    }
}

#[test]
fn a_few_outliers_stay_within_the_bounds() {
    let picture = Rgb8::from_fn(100, 100, |x, y| match (x, y) {
        (5, 5) => [255, 0, 255],
        (50, 77) => [0, 255, 0],
        _ => [1, 1, 1],
    });
    assert!(metric(&picture, "uicm") <= 58.0);
    assert!(metric(&picture, "uism") <= 26.0);
    assert!(metric(&picture, "uiconm") <= 0.368);
    assert!(metric(&picture, "uiqm").abs() < 11.0);
}

#[test]
fn a_swap_of_red_and_blue_changes_colorfulness() {
    let picture = textured(40, 30);
    let swapped = Rgb8::from_fn(40, 30, |x, y| {
        let [r, g, b] = picture.pixel(x, y);
        [b, g, r]
    });
    for name in ["uicm", "uism"] {
        assert_ne!(metric(&picture, name), metric(&swapped, name), "{name}");
    }
}

#[test]
fn an_empty_picture_a_missing_and_a_misfit_reference_are_errors() {
    let (uiqm, psnr) = (MetricId::parse("uiqm").unwrap(), MetricId::parse("psnr").unwrap());
    let empty = Rgb8::new(0, 7, Vec::new()).unwrap();
    let error = measure(&empty, None, &[uiqm]).unwrap_err();
    assert_eq!(error, QualityError::Empty { width: 0, height: 7 });
    let picture = textured(4, 3);
    let error = measure(&picture, None, &[uiqm, psnr]).unwrap_err();
    assert_eq!(error.to_string(), "psnr needs a clean picture, which is missing");
    let error = measure(&picture, Some(&textured(4, 4)), &[psnr]).unwrap_err();
    assert_eq!(error.to_string(), "picture is 4×3 but the clean one is 4×4");
    // A clean picture of another size does not affect metrics without a reference.
    assert!(measure(&picture, Some(&textured(4, 4)), &[uiqm]).is_ok());
}

#[test]
fn psnr_of_equal_pictures_is_capped_and_one_code_everywhere_is_48_db() {
    let psnr = MetricId::parse("psnr").unwrap();
    let picture = Rgb8::from_fn(20, 10, |x, y| [(x + y) as u8; 3]);
    let brighter = Rgb8::from_fn(20, 10, |x, y| picture.pixel(x, y).map(|code| code + 1));
    assert_eq!(measure(&picture, Some(&picture), &[psnr]).unwrap()[0].1, 100.0);
    let value = measure(&brighter, Some(&picture), &[psnr]).unwrap()[0].1;
    assert!((value - 20.0 * 255f64.log10()).abs() < 1e-12);
}

#[test]
fn values_come_in_the_order_of_the_request_and_alone_or_together_are_the_same() {
    let picture = textured(50, 40);
    let mut ids = list_metrics();
    ids.reverse();
    let together = measure(&picture, Some(&textured(50, 40)), &ids).unwrap();
    for (id, (measured, value)) in ids.iter().zip(&together) {
        assert_eq!(id, measured);
        let alone = measure(&picture, Some(&textured(50, 40)), &[*id]).unwrap()[0].1;
        assert_eq!(alone.to_bits(), value.to_bits(), "{id}");
    }
}

#[test]
fn uiqm_is_the_weighted_sum_of_its_parts() {
    let picture = textured(64, 48);
    let sum = |profile: &str, [a, b, c]: [f64; 3]| {
        a * metric(&picture, &format!("uicm@{profile}"))
            + b * metric(&picture, &format!("uism@{profile}"))
            + c * metric(&picture, &format!("uiconm@{profile}"))
    };
    assert_eq!(
        metric(&picture, "uiqm@funie"),
        sum("funie", [0.0282, 0.2953, 3.5753])
    );
    assert_eq!(
        metric(&picture, "uiqm@table1"),
        sum("table1", [0.03712812, 0.33345, -0.34144])
    );
}

/// Illumination that falls off to the right, shown by a picture of a white wall.
fn light_from_the_left(side: usize) -> Illumination {
    let light = Plane::from_fn(side, side, |x, _| 1.0 - 0.9 * x as f32 / side as f32);
    let input = Rgb8::from_fn(side, side, |x, y| [(250.0 * light.row(y)[x]) as u8; 3]);
    Illumination::new(&TrueLight {
        illumination: &light,
        reflectance: &Plane::filled(side, side, 1.0),
        input: &input,
        mask: None,
    })
}

/// All metrics of a picture that the previous frame of its path repeats.
fn measure_everything(picture: &Rgb8, clean: &Rgb8, light: &Illumination) -> Vec<(MetricId, f64)> {
    let (width, height) = (picture.width(), picture.height());
    let motion = Motion {
        positions: Plane::from_fn(width, height, |x, y| [x as f32 + 0.5, y as f32 + 0.5]),
    };
    let focal_px = width as f64 / 2.0;
    let ray = |x: f64, y: f64| vec3(x / focal_px - 1.0, y / focal_px - 1.0, 1.0);
    let camera = CameraMotion {
        current: &ray,
        previous: &ray,
        pose: RelativePose {
            rotation: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
            translation: vec3(0.1, 0.0, 0.0),
        },
        pixel_rad: 1.0 / focal_px,
        seed: 1,
    };
    let features = FrameFeatures::find(picture, None);
    let previous = PreviousFrame {
        features: &features,
        motion: &motion,
    };
    let sequence = Sequence {
        features: &features,
        previous: &[previous],
        camera: Some(camera),
    };
    let subject = Subject {
        clean: Some(clean),
        sequence: Some(&sequence),
        illumination: Some(light),
        ..Subject::new(picture)
    };
    measure_subject(&subject, &MetricId::all().collect::<Vec<_>>()).expect("every metric has its input")
}

#[test]
fn every_metric_of_sixteen_constant_or_black_megapixels_is_finite_and_within_its_range() {
    const SIDE: usize = 4096;
    let (clean, light) = (textured(SIDE, SIDE), light_from_the_left(SIDE));
    std::thread::scope(|scope| {
        for pixel in [[0; 3], [60, 120, 140]] {
            let (clean, light) = (&clean, &light);
            scope.spawn(move || {
                let picture = Rgb8::from_fn(SIDE, SIDE, |_, _| pixel);
                let values = measure_everything(&picture, clean, light);
                assert_eq!(
                    values.len(),
                    MetricId::all().count(),
                    "each metric is defined for {pixel:?}"
                );
                for (id, value) in values {
                    let (low, high) = (id.info().range.start(), id.info().range.end());
                    assert!(
                        value.is_finite() && value >= low - SLACK && value <= high + SLACK,
                        "{id} of {pixel:?} is {value}"
                    );
                }
            });
        }
    });
}

fn picture() -> impl Strategy<Value = (Rgb8, Rgb8)> {
    let code = prop_oneof![Just(0u8), Just(1), Just(2), Just(254), Just(255), any::<u8>()];
    let palette = prop::collection::vec([code.clone(), code.clone(), code], 1..6);
    (1usize..40, 1usize..40, palette, any::<u64>()).prop_map(|(width, height, palette, seed)| {
        let paint = |salt: u64| {
            Rgb8::from_fn(width, height, |x, y| {
                let hash = (x as u64 + 1)
                    .wrapping_mul(seed ^ salt)
                    .wrapping_add((y as u64).wrapping_mul(0x9e37_79b9));
                palette[((hash >> 13) ^ hash) as usize % palette.len()]
            })
        };
        (paint(0), paint(0x5851_f42d))
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn every_metric_of_every_picture_is_finite_within_its_range_and_not_minus_zero((picture, clean) in picture()) {
        let ids = list_metrics();
        for (id, value) in measure(&picture, Some(&clean), &ids).unwrap() {
            prop_assert!(value.is_finite(), "{id} is {value}");
            prop_assert!(value != 0.0 || value.is_sign_positive(), "{id} is -0");
            let (low, high) = (id.info().range.start(), id.info().range.end());
            prop_assert!(value >= low - SLACK && value <= high + SLACK, "{id} is {value}");
        }
    }
}
