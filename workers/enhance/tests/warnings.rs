//! Pictures that make methods fail, and their warnings.

#![allow(clippy::unwrap_used)]

use enhance::{METHODS, Method, Warning, run};
use imaging::{Raster, Rgb8};

fn warnings(name: &str, picture: &Rgb8) -> Vec<Warning> {
    run(&Method::parse(name).unwrap(), &Raster::from(picture.clone()))
        .unwrap()
        .warnings
}

fn grain(x: usize, y: usize) -> u8 {
    let mut hash = (x as u32).wrapping_mul(0x9e37_79b1) ^ (y as u32).wrapping_mul(0x85eb_ca77);
    hash = (hash ^ (hash >> 15)).wrapping_mul(0x2c1b_3c6d);
    (hash >> 29) as u8
}

/// Plates of several brightnesses with this much red that fade into water.
fn reef_with(red: f64) -> Rgb8 {
    Rgb8::from_fn(240, 160, |x, y| {
        let near = 1.0 - x as f64 / 300.0;
        let plate = 40.0 + 25.0 * ((x / 20 + 2 * (y / 16)) % 5) as f64;
        let channel =
            |weight: f64, water: f64| (plate * weight * near + water * (1.0 - near)) as u8 + grain(x, y);
        [channel(red, 30.0), channel(1.0, 110.0), channel(0.95, 105.0)]
    })
}

fn reef() -> Rgb8 {
    reef_with(0.4)
}

#[test]
fn an_ordinary_picture_has_no_warning() {
    for name in [
        "hscm",
        "clahe",
        "gray_world",
        "ibla",
        "rd",
        "dcp",
        "fusion",
        "mlle",
    ] {
        assert_eq!(warnings(name, &reef()), [], "{name}");
    }
}

#[test]
fn a_bright_part_without_texture_is_taken_for_the_background_by_ibla() {
    let base = reef_with(0.8);
    let lamp = Rgb8::from_fn(240, 160, |x, y| {
        let lit = [225 + grain(x, y), 240, 235];
        if y < 90 {
            lit
        } else {
            base.pixel(x, y).map(|code| code / 2)
        }
    });
    assert_eq!(
        warnings("ibla", &lamp),
        [Warning::Blackened, Warning::LampAsBackground]
    );
}

#[test]
fn ulap_and_suir_say_what_they_did_to_red() {
    assert_eq!(warnings("ulap", &reef_with(0.8)), [Warning::RedCast]);
    // Less red: the far end turns black in red instead.
    assert_eq!(warnings("ulap", &reef()), [Warning::Blackened]);
    assert_eq!(warnings("suir", &reef()), [Warning::RedAmplified]);
}

#[test]
fn one_color_darkness_gray_and_small_pictures_are_named() {
    let flat = Rgb8::from_fn(80, 70, |_, _| [60, 120, 140]);
    let dark = Rgb8::from_fn(80, 70, |x, y| [grain(x, y); 3].map(|code| code + (x / 20) as u8));
    let gray = Rgb8::from_fn(80, 70, |x, y| [(x + y) as u8 + 20; 3]);
    let small = Rgb8::from_fn(20, 20, |x, y| [(9 * x) as u8, (7 * y + 40) as u8, 90]);
    for name in METHODS {
        assert!(warnings(name, &flat).contains(&Warning::Constant), "{name}");
        assert!(warnings(name, &dark).contains(&Warning::Dark), "{name}");
    }
    for name in ["ulap", "ibla", "suir", "dcp", "udcp"] {
        assert!(warnings(name, &gray).contains(&Warning::Gray), "{name}");
        assert!(warnings(name, &small).contains(&Warning::FewPixels), "{name}");
    }
    for name in ["hscm", "clahe"] {
        assert!(warnings(name, &small).contains(&Warning::SmallTiles), "{name}");
    }
}

#[test]
fn missing_and_weak_channels_are_named() {
    let without_red = Rgb8::from_fn(80, 70, |x, y| [0, (x + y) as u8 + 40, 2 * x as u8 + 60]);
    for name in ["suir", "rd", "gray_world", "dcp", "fusion", "mlle"] {
        assert!(
            warnings(name, &without_red).contains(&Warning::ChannelWithoutLight),
            "{name}"
        );
    }
    let weak_red = Rgb8::from_fn(80, 70, |x, y| [grain(x, y), (x + y) as u8 + 40, 2 * x as u8 + 60]);
    assert!(warnings("suir", &weak_red).contains(&Warning::RedAmplified));
    let reef = reef();
    let night = Rgb8::from_fn(
        80,
        70,
        |x, y| if (x + y) % 3 < 2 { [0; 3] } else { reef.pixel(x, y) },
    );
    assert!(warnings("rghs", &night).contains(&Warning::BlackMode));
}

#[test]
fn a_white_object_is_named_if_udcp_blackens_the_rest() {
    let base = reef_with(0.8);
    let names_lamp = |object: [u8; 3]| {
        let scene = Rgb8::from_fn(240, 160, |x, y| {
            if (60..120).contains(&x) && y < 60 {
                object
            } else {
                base.pixel(x, y)
            }
        });
        warnings("udcp", &scene).contains(&Warning::LampAsBackground)
    };
    assert!(names_lamp([235, 240, 238]));
    assert!(!names_lamp([30, 240, 235]));
}

#[test]
fn amplified_noise_is_named() {
    let calm = Rgb8::from_fn(160, 120, |x, y| [60 + grain(x, y), 110, 120 + (x / 12) as u8]);
    for name in ["dcp", "udcp", "fusion", "mlle"] {
        assert!(warnings(name, &calm).contains(&Warning::NoiseAmplified), "{name}");
        assert!(
            !warnings(name, &reef_with(0.8)).contains(&Warning::NoiseAmplified),
            "{name}"
        );
    }
}
