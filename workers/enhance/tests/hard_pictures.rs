//! Pictures and cutoffs that break naive implementations of HSCM.

use enhance::hscm::Luma;
use enhance::hscm::homomorphic::{self, Filter};
use enhance::{EnhanceError, Enhanced, Method, Variant, run_variant};
use imaging::{Channels, Plane, Raster, Rgb8, Samples};
use proptest::prelude::*;
use spec::Hscm;

const VARIANTS: [Variant; 2] = [Variant::Fast, Variant::Reference];

/// The default cutoff.
const CUTOFF: f64 = 32.0;

fn filter(width: usize, cutoff: f64) -> Filter {
    let parameters = Hscm {
        cutoff,
        ..Hscm::default()
    };
    Filter::new(&parameters, width)
}

fn filtered(picture: &Rgb8, cutoff: f64, variant: Variant) -> Plane<u8> {
    let luma = Luma::new(&Raster::from(picture.clone()));
    homomorphic::homomorphic(&luma, &filter(picture.width(), cutoff), variant)
}

fn enhance(picture: &Raster, variant: Variant) -> Result<Enhanced, EnhanceError> {
    run_variant(
        &Method::parse("hscm").expect("a name of the table"),
        picture,
        variant,
    )
}

fn single_code(plane: &Plane<u8>) -> Option<u8> {
    let first = plane.data()[0];
    plane.data().iter().all(|code| *code == first).then_some(first)
}

fn textured(width: usize, height: usize) -> Rgb8 {
    Rgb8::from_fn(width, height, |x, y| {
        [(37 * x + 11 * y) as u8, (5 * x + 91 * y) as u8, (x * y) as u8]
    })
}

#[test]
fn one_black_pixel_changes_only_its_surroundings() {
    let plain = Rgb8::from_fn(200, 150, |x, y| [(x / 2 + 80) as u8, (y / 2 + 80) as u8, 90]);
    let pierced = Rgb8::from_fn(200, 150, |x, y| {
        if (x, y) == (100, 75) {
            [0; 3]
        } else {
            plain.pixel(x, y)
        }
    });
    for variant in VARIANTS {
        let before = filtered(&plain, CUTOFF, variant);
        let after = filtered(&pierced, CUTOFF, variant);
        for y in 0..150usize {
            for x in 0..200usize {
                if x.abs_diff(100).max(y.abs_diff(75)) > 30 {
                    assert!(before.pixel(x, y).abs_diff(after.pixel(x, y)) <= 1, "({x}, {y})");
                }
            }
        }
    }
}

#[test]
fn an_all_black_picture_becomes_one_code_at_the_tie_of_its_gain() {
    for (width, height) in [(1, 1), (11, 3), (97, 61)] {
        for variant in VARIANTS {
            let black = Rgb8::from_fn(width, height, |_, _| [0; 3]);
            // 255 exp(0.5 ln 0.01) = 25.5.
            let code = single_code(&filtered(&black, CUTOFF, variant));
            assert!(matches!(code, Some(25 | 26)), "{width}×{height}: {code:?}");
        }
    }
}

#[test]
fn a_constant_picture_stays_constant_through_the_filter_and_is_no_error() {
    let constant = Rgb8::from_fn(97, 61, |_, _| [60, 120, 140]);
    for variant in VARIANTS {
        assert!(single_code(&filtered(&constant, CUTOFF, variant)).is_some());
        assert!(enhance(&Raster::from(constant.clone()), variant).is_ok());
    }
}

#[test]
fn sides_of_one_and_sides_below_the_grid_are_enhanced() {
    for (width, height) in [(1, 1), (1, 40), (40, 1), (3, 5), (7, 7)] {
        for variant in VARIANTS {
            let enhanced = enhance(&Raster::from(textured(width, height)), variant).unwrap();
            assert_eq!(
                (enhanced.picture.width(), enhanced.picture.height()),
                (width, height)
            );
        }
    }
}

#[test]
fn a_narrow_picture_keeps_a_cutoff_of_one_bin() {
    assert_eq!(filter(4, CUTOFF).delta, 1.0);
    assert_eq!(filter(96, CUTOFF).delta, 3.0);
}

#[test]
fn a_cutoff_beyond_all_bins_leaves_a_gamma_curve() {
    let picture = textured(64, 48);
    for variant in VARIANTS {
        let codes = filtered(&picture, 64.0 / 1e6, variant);
        for (code, pixel) in codes.data().iter().zip(picture.pixels()) {
            let y = f64::from(imaging::luma1000(pixel)) / 255_000.0;
            let gamma = 255.0 * (y + 0.01).sqrt().min(1.0);
            assert!(
                (f64::from(*code) - gamma).abs() <= 0.51,
                "luma {y}: {code} for {gamma}"
            );
        }
    }
}

#[test]
fn an_odd_side_is_filtered_without_a_shift() {
    // A mirrored image must give the mirrored result: a filter half a bin off center would not.
    let picture = textured(45, 27);
    let mirrored = Rgb8::from_fn(45, 27, |x, y| picture.pixel(44 - x, y));
    for variant in VARIANTS {
        let codes = filtered(&picture, CUTOFF, variant);
        let codes_mirrored = filtered(&mirrored, CUTOFF, variant);
        for y in 0..27 {
            for x in 0..45 {
                assert!(
                    codes.pixel(x, y).abs_diff(codes_mirrored.pixel(44 - x, y)) <= 1,
                    "({x}, {y})"
                );
            }
        }
    }
}

#[test]
fn values_above_white_saturate() {
    let lamp = Rgb8::from_fn(90, 90, |x, y| {
        if (40..44).contains(&x) && y < 4 {
            [255; 3]
        } else {
            [1; 3]
        }
    });
    for variant in VARIANTS {
        assert_eq!(filtered(&lamp, CUTOFF, variant).pixel(41, 1), 255);
    }
}

#[test]
fn a_picture_without_pixels_is_an_error_that_gives_its_size() {
    let empty = Raster::new(3, 0, Channels::Rgb, Samples::U8(Vec::new()), None).unwrap();
    let error = enhance(&empty, Variant::Fast).unwrap_err();
    assert_eq!(error, EnhanceError::Empty { width: 3, height: 0 });
    assert_eq!(error.to_string(), "picture is 3×0 but needs at least 1×1");
}

#[test]
fn gray_stays_gray_and_equals_the_color_result_of_a_gray_picture() {
    let plane = Plane::from_fn(40, 30, |x, y| (x * y) as u8);
    let gray = Raster::from(plane);
    let color = Raster::from(gray.to_rgb8());
    let from_gray = enhance(&gray, Variant::Fast).unwrap();
    let from_color = enhance(&color, Variant::Fast).unwrap();
    assert_eq!(from_gray.picture.channels(), Channels::Gray);
    assert_eq!(from_gray.picture.to_rgb8(), from_color.picture.to_rgb8());
}

#[test]
fn alpha_comes_back_and_changes_nothing() {
    let colors = textured(12, 9);
    let alpha = Samples::U8((0..108).collect());
    let opaque = Raster::from(colors.clone());
    let clear = Raster::new(
        12,
        9,
        Channels::Rgb,
        Samples::U8(colors.data().to_vec()),
        Some(alpha.clone()),
    )
    .unwrap();
    let expected = enhance(&opaque, Variant::Fast).unwrap();
    let actual = enhance(&clear, Variant::Fast).unwrap();
    assert_eq!(actual.picture.samples(), expected.picture.samples());
    assert_eq!(actual.picture.alpha(), Some(&alpha));
    assert_eq!(actual.picture.alpha(), Some(&alpha));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn any_picture_and_any_cutoff_give_finite_logarithms_and_a_picture_of_the_same_size(
        width in 1usize..40, height in 1usize..40, seed in any::<u32>(), levels in 1u32..=256,
        cutoff in 1e-5f64..1e12,
    ) {
        let picture = Rgb8::from_fn(width, height, |x, y| {
            let hash = (x as u32 + 1).wrapping_mul(seed | 1) ^ (y as u32 + 7).wrapping_mul(0x9e37_79b1);
            [hash, hash >> 8, hash >> 16].map(|code| (code % levels) as u8)
        });
        let picture = Raster::from(picture);
        for variant in VARIANTS {
            let x = homomorphic::filtered_log(&Luma::new(&picture), &filter(picture.width(), cutoff), variant);
            prop_assert!(x.data().iter().all(|value| value.is_finite()));
            let enhanced = enhance(&picture, variant).unwrap();
            prop_assert_eq!((enhanced.picture.width(), enhanced.picture.height()), (width, height));
        }
    }
}
