//! The stages of HSCM.

use enhance::hscm::{Luma, Options, Profile, Settings, homomorphic, median};
use enhance::{Variant, hscm};
use imaging::{Channels, Plane, Raster, Samples};

use crate::{SIZES, noise, pictures};

/// Largest difference of the filtered logarithm at the default gains. The weight that the short kernels leave out
/// accounts for up to 1.4e-4 and single precision for 1e-5; aliasing of full-scale noise for 5e-5. The tolerance of the method itself is 2e-3.
const LOG_AGREEMENT: f32 = 3e-4;
fn settings() -> [(&'static str, Settings); 5] {
    let default = Settings::default();
    [
        ("default", default),
        (
            "table 1",
            Settings {
                profile: Profile::Table1,
                ..default
            },
        ),
        (
            "high cut-off",
            Settings {
                delta: Some(40.0),
                ..default
            },
        ),
        (
            "low cut-off",
            Settings {
                delta: Some(0.3),
                ..default
            },
        ),
        (
            "equal gains",
            Settings {
                r_high: 0.7,
                r_low: 0.7,
                ..default
            },
        ),
    ]
}

#[test]
fn the_short_passes_agree_with_the_transform() {
    for (width, height) in SIZES {
        for (content, picture) in pictures(width, height) {
            let luma = Luma::of(&Raster::from(picture));
            for (name, settings) in settings() {
                assert_variants_agree(&luma, settings, &format!("{width}×{height} {content}, {name}"));
            }
        }
    }
}

fn assert_variants_agree(luma: &Luma, settings: Settings, what: &str) {
    let options = Options::new(settings).expect("options within their ranges");
    // The table 1 logarithm reaches down to -11.5 instead of -4.6, and its padding is 0.
    let (tolerance, rounding) = match settings.profile {
        Profile::Standard => (LOG_AGREEMENT, 0.5),
        Profile::Table1 => (2.5 * LOG_AGREEMENT, 0.0),
    };
    let exact = homomorphic::filtered_log(luma, &options, Variant::Reference);
    let fast = homomorphic::filtered_log(luma, &options, Variant::Fast);
    for (a, b) in fast.data().iter().zip(exact.data()) {
        assert!((a - b).abs() <= tolerance, "{what}: logarithms {a} and {b}");
    }
    let codes = homomorphic::homomorphic(luma, &options, Variant::Fast);
    for (&code, &x) in codes.data().iter().zip(exact.data()) {
        let code_of = |x: f32| (255.0 * f64::from(x).min(0.0).exp() + rounding) as u8;
        let allowed = code_of(x - tolerance)..=code_of(x + tolerance);
        assert!(
            allowed.contains(&code),
            "{what}: code {code} where {allowed:?} is exact"
        );
    }
}

#[test]
fn the_network_of_five_gives_the_codes_of_the_definition() {
    for (width, height) in [(1, 1), (1, 9), (70, 1), (5, 5), (64, 3), (65, 7), (131, 20)] {
        let noisy = Plane::from_fn(width, height, noise);
        let few_codes = noisy.map(|code| if code % 3 == 0 { 255 } else { code & 1 });
        for picture in [noisy, few_codes] {
            let [fast, exact] = [Variant::Fast, Variant::Reference].map(|v| median::median(&picture, 5, v));
            assert_eq!(fast, exact, "{width}×{height}");
        }
    }
}

#[test]
fn sixteen_bit_pictures_take_the_same_way() {
    let samples = (0..97 * 61)
        .map(|i| 257 * u16::from(noise(i % 97, i / 97)) / 3 + 11)
        .collect();
    let picture = Raster::new(97, 61, Channels::Gray, Samples::U16(samples), None).unwrap();
    let luma = Luma::of(&picture);
    let [fast, exact] = [Variant::Fast, Variant::Reference]
        .map(|variant| homomorphic::filtered_log(&luma, &Options::default(), variant));
    for (a, b) in fast.data().iter().zip(exact.data()) {
        assert!((a - b).abs() <= LOG_AGREEMENT);
    }
    let enhanced = hscm::enhance(&picture, &Options::default(), Variant::Fast).unwrap();
    assert_eq!(enhanced.unmasked.channels(), Channels::Gray);
    assert!(matches!(enhanced.unmasked.samples(), Samples::U8(_)));
}
