use imaging::codec::decode_picture;

use super::super::vectors::{VARIANTS, assert_picture, assert_plane, cases, expected, file, numbers};
use super::*;

/// Tolerance of the refined exposure relative to its range.
const EXPOSURE_TOLERANCE: f64 = 2e-3;

#[test]
fn golden_light_exposure_and_pictures() {
    let expected = expected();
    for name in cases() {
        let picture = decode_picture(file(name, "input.png")).unwrap();
        let colors = picture.to_rgb8();
        let stretch = JointStretch::new(&colors);
        for variant in VARIANTS {
            let guide = Guide::new(&colors).scaled(stretch.scale);
            let light = background(&guide, variant).map(|code| stretch.value(code).max(1.0 / 255.0));
            for (got, expected) in light.iter().zip(numbers::<3>(&expected[name]["suir"]["light"])) {
                assert!((got - expected).abs() < 1e-9, "{name} {variant:?}");
            }
            let (_, exposure) = restored(&guide, &stretch, light, variant);
            assert_plane(name, "suir_exposure.npy", &exposure, EXPOSURE_TOLERANCE);
            assert_picture(
                name,
                "suir",
                &enhance(&picture, &Guided::default(), variant).picture.to_rgb8(),
            );
        }
    }
}

fn suir(colors: &Rgb8) -> Rgb8 {
    enhance(&Raster::from(colors.clone()), &Guided::default(), Variant::Fast)
        .picture
        .to_rgb8()
}

#[test]
fn one_value_comes_back_and_one_color_becomes_saturated() {
    let gray = Rgb8::from_fn(20, 20, |_, _| [90; 3]);
    assert_eq!(suir(&gray), gray);
    let blue = suir(&Rgb8::from_fn(20, 20, |_, _| [60, 120, 140])).pixel(10, 10);
    assert!(blue[0] == 0 && blue[2] > blue[1] && blue[2] > 140, "{blue:?}");
}

#[test]
fn a_picture_without_red_keeps_none() {
    let picture = Rgb8::from_fn(50, 40, |x, y| [0, (60 + 2 * x) as u8, (80 + 3 * y) as u8]);
    assert!(suir(&picture).pixels().all(|pixel| pixel[0] == 0));
}

#[test]
fn red_takes_its_whole_range() {
    let picture = Rgb8::from_fn(80, 60, |x, y| {
        let texture = ((x / 5 + y / 4) % 3) as u8;
        [20 + 4 * texture, 90 + 30 * texture, 100 + 35 * texture]
    });
    let stretched = stretched(&Plane::new(3, 1, vec![0.1, 0.2, 0.5]).unwrap());
    assert_eq!(stretched.data(), [0.0, 0.25, 1.0]);
    let red = |picture: &Rgb8| picture.pixels().map(|pixel| pixel[0]).max();
    assert!(red(&suir(&picture)) > Some(200));
    let flat = Plane::filled(3, 1, 0.1);
    assert_eq!(super::stretched(&flat), flat);
}

#[test]
fn the_rim_counts_as_clear() {
    let picture = Rgb8::from_fn(8, 30, |x, y| [20, (100 + 3 * x) as u8, (90 + 2 * y) as u8]);
    let guide = Guide::new(&picture);
    let stretch = JointStretch::new(&picture);
    let dehazed = dehazed(&guide, &stretch, 1, 0.5, Variant::Reference);
    for (value, code) in dehazed.data().iter().zip(guide.channels()[1].data()) {
        let expected = (stretch.value(*code) - 0.5) / TRANSMITTANCE.1 + 0.5;
        assert!((value - expected).abs() < 1e-9, "{value} for {expected}");
    }
}

#[test]
fn the_background_is_where_red_is_weakest() {
    let picture = Rgb8::from_fn(40, 20, |x, _| if x > 30 { [5, 100, 120] } else { [90, 100, 110] });
    assert_eq!(background(&Guide::new(&picture), Variant::Fast), [5, 100, 120]);
}
