//! Fast variants against reference variants: content × size × variant.

use fathom_enhance::hscm::{Luma, MEDIAN_MAX, Options, Profile, Settings, homomorphic, median};
use fathom_enhance::{Variant, hscm};
use imaging::{Channels, Plane, Raster, Rgb8, Samples};

/// Largest difference of the filtered logarithm at the default gains. The weight that the short kernel leaves out
/// accounts for 1e-5 and single precision for about as much; the tolerance of the method itself is 2e-3.
const LOG_AGREEMENT: f32 = 5e-5;
const SIZES: [(usize, usize); 12] = [
    (1, 1),
    (1, 37),
    (53, 1),
    (2, 2),
    (7, 5),
    (11, 3),
    (31, 29),
    (97, 61),
    (127, 101),
    (160, 120),
    (33, 250),
    (320, 239),
];

fn noise(x: usize, y: usize) -> u8 {
    let mut hash = (x as u32).wrapping_mul(0x9e37_79b1) ^ (y as u32).wrapping_mul(0x85eb_ca77);
    hash = (hash ^ (hash >> 15)).wrapping_mul(0x2c1b_3c6d);
    (hash >> 24) as u8
}

type Pixel = fn(usize, usize) -> [u8; 3];

fn pictures(width: usize, height: usize) -> [(&'static str, Rgb8); 5] {
    let pixels: [(&str, Pixel); 5] = [
        ("noise", |x, y| {
            [noise(x, y), noise(x + 999, y), noise(x, y + 999)]
        }),
        ("ramp", |x, y| {
            [(x % 256) as u8, (y % 256) as u8, ((x + y) / 2 % 256) as u8]
        }),
        ("one lamp in the dark", |x, y| {
            if (x, y) == (3, 2) { [255; 3] } else { [0; 3] }
        }),
        ("edge", |x, _| if x % 40 < 20 { [0; 3] } else { [255; 3] }),
        ("constant", |_, _| [60, 120, 140]),
    ];
    pixels.map(|(name, pixel)| (name, Rgb8::from_fn(width, height, pixel)))
}

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
fn every_median_window_gives_the_codes_of_the_definition() {
    for (width, height) in [(1, 1), (1, 9), (70, 1), (5, 5), (64, 3), (65, 7), (131, 20)] {
        let noisy = Plane::from_fn(width, height, noise);
        let few_codes = noisy.map(|code| if code % 3 == 0 { 255 } else { code & 1 });
        for picture in [noisy, few_codes] {
            for window_px in (1..=MEDIAN_MAX).step_by(2) {
                let fast = median::median(&picture, window_px, Variant::Fast);
                let exact = median::median(&picture, window_px, Variant::Reference);
                assert_eq!(fast, exact, "{width}×{height}, window {window_px}");
            }
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
