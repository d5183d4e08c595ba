//! The stages of HSCM.

use enhance::hscm::homomorphic::{self, Filter};
use enhance::hscm::{Luma, median};
use enhance::{Method, Variant, run};
use imaging::{Channels, Plane, Raster, Samples};
use spec::Hscm;

use crate::{SIZES, noise, pictures};

/// Largest difference of the filtered logarithm at the default gains: up to 1.4e-4 from truncated kernels, 1e-5 from
/// f32, 5e-5 from aliasing of full-scale noise. The tolerance of the method is 2e-3.
const LOG_AGREEMENT: f32 = 3e-4;
/// Largest difference at the largest gains and the least `eps`, where rounding in f32 is amplified thirty times.
const LOG_AGREEMENT_EXTREME: f32 = 3e-3;

#[test]
fn the_short_passes_agree_with_the_transform() {
    for (width, height) in SIZES {
        let usual = Hscm::default();
        // Cutoffs that leave many bins and hardly any.
        let cutoffs = [usual.cutoff, width as f64 / 40.0, 1e9];
        let filters = cutoffs.map(|cutoff| (Hscm { cutoff, ..usual }, LOG_AGREEMENT));
        let extreme = Hscm {
            gain_high: 20.0,
            gain_low: 0.01,
            eps: 1e-6,
            ..usual
        };
        let filters = filters.into_iter().chain([(extreme, LOG_AGREEMENT_EXTREME)]);
        for (parameters, agreement) in filters {
            let filter = Filter::new(&parameters, width);
            for (content, picture) in pictures(width, height) {
                let luma = Luma::new(&Raster::from(picture));
                let what = format!("{width}×{height} {content}, {parameters:?}");
                assert_variants_agree(&luma, &filter, agreement, &what);
            }
        }
    }
}

fn assert_variants_agree(luma: &Luma, filter: &Filter, agreement: f32, what: &str) {
    let exact = homomorphic::filtered_log(luma, filter, Variant::Reference);
    let fast = homomorphic::filtered_log(luma, filter, Variant::Fast);
    for (a, b) in fast.data().iter().zip(exact.data()) {
        assert!((a - b).abs() <= agreement, "{what}: logarithms {a} and {b}");
    }
    let codes = homomorphic::homomorphic(luma, filter, Variant::Fast);
    for (&code, &x) in codes.data().iter().zip(exact.data()) {
        let code_of = |x: f32| (255.0 * f64::from(x).min(0.0).exp() + 0.5) as u8;
        let allowed = code_of(x - agreement)..=code_of(x + agreement);
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
    let luma = Luma::new(&picture);
    let filter = Filter::new(&Hscm::default(), 97);
    let [fast, exact] =
        [Variant::Fast, Variant::Reference].map(|variant| homomorphic::filtered_log(&luma, &filter, variant));
    for (a, b) in fast.data().iter().zip(exact.data()) {
        assert!((a - b).abs() <= LOG_AGREEMENT);
    }
    let enhanced = run(&Method::parse("hscm").unwrap(), &picture).unwrap();
    assert_eq!(enhanced.picture.channels(), Channels::Gray);
    assert!(matches!(enhanced.picture.samples(), Samples::U8(_)));
}
