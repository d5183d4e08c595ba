//! Pictures and options on which naive implementations fail.

use enhance::hscm::{Circle, Luma, Options, Output, Profile, Settings, enhance, homomorphic};
use enhance::{EnhanceError, Variant};
use imaging::{Channels, Plane, Raster, Rgb8, Samples};
use proptest::prelude::*;

const VARIANTS: [Variant; 2] = [Variant::Fast, Variant::Reference];

fn options(settings: Settings) -> Options {
    Options::new(settings).expect("options within their ranges")
}

fn filtered(picture: &Rgb8, settings: Settings, variant: Variant) -> Plane<u8> {
    homomorphic::homomorphic(
        &Luma::of(&Raster::from(picture.clone())),
        &options(settings),
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
            plain.at(x, y)
        }
    });
    for variant in VARIANTS {
        let before = filtered(&plain, Settings::default(), variant);
        let after = filtered(&pierced, Settings::default(), variant);
        for y in 0..150usize {
            for x in 0..200usize {
                if x.abs_diff(100).max(y.abs_diff(75)) > 30 {
                    assert!(before.at(x, y).abs_diff(after.at(x, y)) <= 1, "({x}, {y})");
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
            let code = single_code(&filtered(&black, Settings::default(), variant));
            assert!(matches!(code, Some(25 | 26)), "{width}×{height}: {code:?}");
        }
    }
}

#[test]
fn a_constant_picture_stays_constant_through_the_filter_and_is_no_error() {
    let constant = Rgb8::from_fn(97, 61, |_, _| [60, 120, 140]);
    for variant in VARIANTS {
        assert!(single_code(&filtered(&constant, Settings::default(), variant)).is_some());
        assert!(enhance(&Raster::from(constant.clone()), &Options::default(), variant).is_ok());
    }
}

#[test]
fn sides_of_one_and_sides_below_the_grid_are_enhanced() {
    for (width, height) in [(1, 1), (1, 40), (40, 1), (3, 5), (7, 7)] {
        for variant in VARIANTS {
            let enhanced = enhance(
                &Raster::from(textured(width, height)),
                &Options::default(),
                variant,
            )
            .unwrap();
            assert_eq!(
                (enhanced.picture.width(), enhanced.picture.height()),
                (width, height)
            );
        }
    }
}

#[test]
fn a_narrow_picture_keeps_a_cutoff_of_one_bin_and_an_explicit_cutoff_of_none_is_refused() {
    let high = options(Settings {
        cutoff: 1e6,
        ..Settings::default()
    });
    assert_eq!(high.delta_bins(4), 1.0);
    let errors = Options::new(Settings {
        delta: Some(0.0),
        ..Settings::default()
    })
    .unwrap_err();
    assert_eq!(errors[0].field, "delta");
}

#[test]
fn a_very_large_cutoff_leaves_a_gamma_curve() {
    let picture = textured(64, 48);
    let settings = Settings {
        delta: Some(1e6),
        ..Settings::default()
    };
    for variant in VARIANTS {
        let codes = filtered(&picture, settings, variant);
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
fn a_very_large_gain_drives_codes_to_the_ends_without_overflow() {
    let settings = Settings {
        r_high: 1e6,
        ..Settings::default()
    };
    for variant in VARIANTS {
        let codes = filtered(&textured(97, 61), settings, variant);
        assert!(
            codes
                .data()
                .iter()
                .filter(|&&code| code == 0 || code == 255)
                .count()
                > 97 * 61 * 9 / 10
        );
    }
}

#[test]
fn an_odd_side_is_filtered_without_a_shift() {
    // A mirror image must give the mirrored result: a filter half a bin off center would not.
    let picture = textured(45, 27);
    let mirrored = Rgb8::from_fn(45, 27, |x, y| picture.at(44 - x, y));
    for variant in VARIANTS {
        let codes = filtered(&picture, Settings::default(), variant);
        let codes_mirrored = filtered(&mirrored, Settings::default(), variant);
        for y in 0..27 {
            for x in 0..45 {
                assert!(
                    codes.at(x, y).abs_diff(codes_mirrored.at(44 - x, y)) <= 1,
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
    for settings in [
        Settings::default(),
        Settings {
            r_high: 16.0,
            eps: 1e-6,
            ..Settings::default()
        },
    ] {
        for variant in VARIANTS {
            assert_eq!(filtered(&lamp, settings, variant).at(41, 1), 255);
        }
    }
}

#[test]
fn a_circle_outside_the_picture_leaves_black_and_an_empty_mask() {
    let outside = Circle {
        center_x: -3.0,
        center_y: 9.0,
        radius: 0.4,
    };
    let settings = Settings {
        mask: Some(outside),
        ..Settings::default()
    };
    let enhanced = enhance(&Raster::from(textured(20, 10)), &options(settings), Variant::Fast).unwrap();
    assert!(enhanced.picture.to_rgb8().data().iter().all(|&code| code == 0));
    assert!(enhanced.unmasked.to_rgb8().data().iter().any(|&code| code > 0));
    assert!(enhanced.mask.unwrap().data().iter().all(|&code| code == 0));
}

#[test]
fn a_picture_without_pixels_is_an_error_that_gives_its_size() {
    let empty = Raster::new(3, 0, Channels::Rgb, Samples::U8(Vec::new()), None).unwrap();
    let error = enhance(&empty, &Options::default(), Variant::Fast).unwrap_err();
    assert_eq!(error, EnhanceError::Empty { width: 3, height: 0 });
    assert_eq!(error.to_string(), "picture is 3×0 but needs at least 1×1");
}

#[test]
fn gray_stays_gray_and_equals_the_color_result_of_a_gray_picture() {
    let plane = Plane::from_fn(40, 30, |x, y| (x * y) as u8);
    let gray = Raster::from(plane);
    let color = Raster::from(gray.to_rgb8());
    let from_gray = enhance(&gray, &Options::default(), Variant::Fast).unwrap();
    let from_color = enhance(&color, &Options::default(), Variant::Fast).unwrap();
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
    let expected = enhance(&opaque, &Options::default(), Variant::Fast).unwrap();
    let actual = enhance(&clear, &Options::default(), Variant::Fast).unwrap();
    assert_eq!(actual.picture.samples(), expected.picture.samples());
    assert_eq!(actual.picture.alpha(), Some(&alpha));
    assert_eq!(actual.unmasked.alpha(), Some(&alpha));
}

#[test]
fn table_1_truncates_and_lets_a_bright_band_in_from_the_padding() {
    let dark = Rgb8::from_fn(97, 61, |_, _| [40; 3]);
    let table1 = Settings {
        profile: Profile::Table1,
        ..Settings::default()
    };
    for variant in VARIANTS {
        let codes = filtered(&dark, table1, variant);
        // The white band in the padding darkens the border next to it, since the high gain takes it off.
        assert!(codes.at(96, 30) < codes.at(48, 30));
        // A picture that needs no padding is flat: 255 · sqrt(40 / 255) = 100.996 is cut, not rounded.
        let even = Rgb8::from_fn(100, 64, |_, _| [40; 3]);
        assert_eq!(single_code(&filtered(&even, table1, variant)), Some(100));
    }
}

#[test]
fn gray_output_of_a_color_picture_is_its_luma_alone() {
    let settings = Settings {
        output: Output::Gray,
        mask: None,
        ..Settings::default()
    };
    let enhanced = enhance(&Raster::from(textured(30, 20)), &options(settings), Variant::Fast).unwrap();
    assert_eq!(enhanced.picture.channels(), Channels::Gray);
    assert_eq!(enhanced.picture, enhanced.unmasked);
    assert_eq!(enhanced.mask, None);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn any_picture_and_any_options_give_a_picture_of_the_same_size(
        width in 1usize..40, height in 1usize..40, seed in any::<u32>(), levels in 1u32..=256,
        r_high in 0.5f64..1e3, delta in prop::option::of(1e-12f64..1e6), eps in 1e-12f64..1e3,
        median in 0usize..16, clip_limit in 0.0f64..50.0, across in 1usize..60, down in 1usize..60,
        table1 in any::<bool>(),
    ) {
        let picture = Rgb8::from_fn(width, height, |x, y| {
            let hash = (x as u32 + 1).wrapping_mul(seed | 1) ^ (y as u32 + 7).wrapping_mul(0x9e37_79b1);
            [hash, hash >> 8, hash >> 16].map(|code| (code % levels) as u8)
        });
        let profile = if table1 { Profile::Table1 } else { Profile::Standard };
        let options = options(Settings {
            r_high, delta, eps, median: 2 * median + 1, clip_limit, grid: (across, down), profile,
            ..Settings::default()
        });
        for variant in VARIANTS {
            let x = homomorphic::filtered_log(&Luma::of(&Raster::from(picture.clone())), &options, variant);
            prop_assert!(x.data().iter().all(|value| value.is_finite()));
            let enhanced = enhance(&Raster::from(picture.clone()), &options, variant).unwrap();
            prop_assert_eq!((enhanced.picture.width(), enhanced.picture.height()), (width, height));
        }
    }
}
