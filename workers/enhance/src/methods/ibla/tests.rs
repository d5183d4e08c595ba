use imaging::codec::decode_picture;

use super::super::vectors::{VARIANTS, assert_picture, assert_plane, cases, expected, file, numbers};
use super::*;
use crate::blocks::{calmest, lowest};

/// Near ties flip single pixels of a candidate.
const LIGHT_TOLERANCE: f64 = 0.01;
/// Tolerance of refined planes relative to their range.
const PLANE_TOLERANCE: f64 = 1e-3;

/// A variant: its name in the vectors, its refinement of a plane, and the parameter.
type Refined<'a> = (
    &'static str,
    &'a dyn Fn(&Plane<f64>) -> Plane<f64>,
    IblaRefinement,
);

fn restored(picture: &Raster, refine: IblaRefinement, variant: Variant) -> Rgb8 {
    let parameters = Ibla {
        refine,
        ..Ibla::default()
    };
    enhance(picture, &parameters, variant).picture.to_rgb8()
}

#[test]
fn golden_stages_and_pictures() {
    let expected = expected();
    for name in cases() {
        let picture = decode_picture(file(name, "input.png")).unwrap();
        let colors = picture.to_rgb8();
        let guide = Guide::new(&colors);
        for variant in VARIANTS {
            let matting = Matting::new(&guide, variant);
            let by_guide = |plane: &Plane<f64>| guided(&guide, plane, variant);
            let by_matting = |plane: &Plane<f64>| matting.refined(plane);
            let forms: [Refined; 2] = [
                ("ibla", &by_matting, IblaRefinement::Auto),
                ("ibla_guided", &by_guide, IblaRefinement::Guided),
            ];
            for (form, refine, refinement) in forms {
                let expected = &expected[name][form];
                let raw = blurriness(&colors, variant);
                let refined = refine(&raw);
                let light = BackgroundLight::new(&colors, &refined, variant);
                let boxes = [calmest(&colors), lowest(&refined)].map(|region| {
                    let (x, y) = (&region.columns, &region.rows);
                    [x.start, y.start, x.len(), y.len()].map(|number| number as f64)
                });
                for (region, expected) in boxes.iter().zip(expected["boxes"].as_array().unwrap()) {
                    assert_eq!(*region, numbers(expected), "{name} {form} {variant:?}");
                }
                for (got, expected) in light.color.iter().zip(numbers::<3>(&expected["light"])) {
                    assert!(
                        (got - expected).abs() < LIGHT_TOLERANCE,
                        "{name} {form} {variant:?}"
                    );
                }
                let mix = Mix::new(&guide, light.color);
                if form == "ibla" {
                    assert_plane(name, "ibla_blur.npy", &refined, PLANE_TOLERANCE);
                    let closeness = refine(&mix.closeness(&Measures::new(&guide, raw.clone(), variant)));
                    assert_plane(name, "ibla_closeness.npy", &closeness, PLANE_TOLERANCE);
                }
                let got = [mix.by_loss, mix.by_color, nearest(&colors, light.color)];
                for (got, key) in got.into_iter().zip(["ta", "tb", "near"]) {
                    let expected = expected[key].as_f64().unwrap();
                    assert!(
                        (got - expected).abs() < 0.05,
                        "{name} {form} {key}: {got} for {expected}"
                    );
                }
                assert_picture(name, form, &restored(&picture, refinement, variant));
            }
        }
    }
}

fn ibla(colors: &Rgb8, variant: Variant) -> Rgb8 {
    restored(&Raster::from(colors.clone()), IblaRefinement::Auto, variant)
}

#[test]
fn one_color_and_black_come_back() {
    for pixel in [[0; 3], [60, 120, 140], [255; 3]] {
        let picture = Rgb8::from_fn(40, 30, |_, _| pixel);
        for variant in VARIANTS {
            assert_eq!(ibla(&picture, variant), picture, "{pixel:?}");
        }
    }
}

#[test]
fn shorter_waves_fade_less_under_white_light() {
    let [red, green, blue] = attenuation([0.5; 3]);
    assert_eq!(red, 1.0 / 7.0);
    // m = 0.92457, 1.01497 and 1.11667: under equal light the shorter waves scatter more.
    assert!((green / red - 1.01497 / 0.92457).abs() < 1e-9 && blue > green);
    // Without blue light the division has a floor.
    assert!(attenuation([0.5, 0.5, 0.0])[2].is_finite());
}

#[test]
fn bright_haze_is_not_blackened_and_a_bright_wall_is_named() {
    let haze = decode_picture(file("peers_hazy_160x120", "input.png")).unwrap();
    assert!(
        !enhance(&haze, &Ibla::default(), Variant::Fast)
            .warnings
            .contains(&Warning::Blackened)
    );
    let wall = Rgb8::from_fn(160, 120, |x, y| {
        let texture = ((x / 3 + y / 5) % 4) as u8 * 8;
        if y < 64 {
            [235, 240, 238]
        } else {
            [30 + texture, 70 + texture, 80 + texture]
        }
    });
    let warnings = enhance(&Raster::from(wall), &Ibla::default(), Variant::Fast).warnings;
    assert!(warnings.contains(&Warning::Blackened) && warnings.contains(&Warning::LampAsBackground));
}
