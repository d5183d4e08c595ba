//! MLLE: minimal color loss and locally adaptive contrast (Zhang, Zhuang, Sun, Li, Kwong and Li 2022).
//!
//! 1. Color transfer. The channel with the largest mean m is stretched: `l' = (l - min) / (max - min)` (unchanged if both
//!    are equal), with mean `m_l`. Each other channel is `c + S_c l'`: `c ← c + (m_l - m_c) l'` is repeated K times, until
//!    the color loss `Σ |m_l - m_c|` is at most 0.01. Each repetition multiplies `m_l - m_c` by `1 - m_l`, hence
//!    `S_c = (m_l - m_c) (1 - (1 - m_l)^K) / m_l` with the means of the input. Channels whose mean equals the largest are
//!    stretched over their ranges.
//! 2. Fusion by the attenuation map `A = max over c of 1 - c^γ`: `c₁ = (c - G c) + A c' + (1 - A) c`, clipped; c' is the
//!    result of step 1 and G the binomial blur with 5 × 5 taps.
//! 3. CIE Lab. With mean μ and variance σ² of L in windows clipped to the picture, and its variance v in the whole picture,
//!    `E = μ + min(v / σ², β) (L - μ)`. The guided filter in the same windows, with L as guide, returns the new L:
//!    `a = cov(L, E) / (σ² + ε)`, `b = mean(E) - a μ`, `L₁ = mean(a) L + mean(b)`, clipped to 0..=100; L and ε in units of
//!    100 and its square.
//! 4. The smaller of `a + 128` and `b + 128` in the mean is multiplied by `1 + |ā - b̄| / (ā + b̄)` of these means.
//!
//! Channels are in 0..=1; borders are replicated. The paper leaves open the blur of step 2, β, ε, and whether the windows of
//! step 3 are separate blocks: those above and the defaults are this project's reading. One window for contrast and for
//! the guided filter needs no blocks, and leaves no edges of blocks.
//!
//! Known failures: noise in calm water is contrast below ε only in part, and is raised up to β-fold; a narrow largest
//! channel is stretched into noise. Missing red becomes a copy of the largest channel. Two channels with nearly equal means
//! can change roles from frame to frame. Contrast above that of the whole picture is reduced.

mod color;
mod definition;
mod fast;
mod reference;

use imaging::{Raster, Rgb8};
use spec::Mlle;

use crate::result::{Enhanced, OfGray};
use crate::signs::{self, Signs};
use crate::variant::Variant;
use crate::warning::Warning;
use color::Transfer;

/// A larger stretch of the largest channel causes a warning.
const LARGE_STRETCH: f64 = 4.0;

/// Enhances a picture of at least one pixel. Gray stays gray; 16 bit is reduced to 8.
#[must_use]
pub(crate) fn enhance(picture: &Raster, parameters: &Mlle, variant: Variant) -> Enhanced {
    let colors = picture.to_rgb8();
    let transfer = Transfer::new(&colors);
    let enhanced: Rgb8 = match variant {
        Variant::Fast => fast::enhance(&colors, &transfer, parameters),
        Variant::Reference => reference::enhance(&colors, &transfer, parameters),
    };
    let others: &[signs::FailureSign] = &[
        (Warning::ChannelWithoutLight, Signs::lacks_a_channel),
        (Warning::RedCast, Signs::turned_red),
    ];
    let mut warnings = signs::warnings(&colors, &enhanced, others);
    if transfer.stretch() > LARGE_STRETCH {
        warnings.push(Warning::NoiseAmplified);
    }
    Enhanced::from_colors(picture, &enhanced, OfGray::Gray, warnings)
}

#[cfg(test)]
mod tests {
    use super::definition::balance;
    use super::*;

    fn mlle(colors: &Rgb8, parameters: &Mlle) -> Rgb8 {
        enhance(&Raster::from(colors.clone()), parameters, Variant::Fast)
            .picture
            .to_rgb8()
    }

    fn reef() -> Rgb8 {
        Rgb8::from_fn(160, 120, |x, y| {
            let plate = 60.0 + 10.0 * ((x / 5 + 2 * (y / 4)) % 5) as f64;
            [0.25, 1.0, 0.8].map(|tint| (plate * tint + y as f64 / 3.0 * tint) as u8)
        })
    }

    fn means(picture: &Rgb8) -> [f64; 3] {
        let n = picture.pixels().len() as f64;
        std::array::from_fn(|c| picture.pixels().map(|pixel| f64::from(pixel[c])).sum::<f64>() / n)
    }

    #[test]
    fn black_and_white_stay_and_gray_stays_gray() {
        for pixel in [[0; 3], [255; 3]] {
            let picture = Rgb8::from_fn(9, 9, |_, _| pixel);
            assert!(mlle(&picture, &Mlle::default()) == picture, "{pixel:?}");
        }
        let gray = Rgb8::from_fn(60, 40, |x, y| [(3 * x + y) as u8; 3]);
        assert!(
            mlle(&gray, &Mlle::default())
                .pixels()
                .all(|[r, g, b]| r == g && g == b)
        );
    }

    #[test]
    fn missing_red_returns_and_local_contrast_grows() {
        let picture = reef();
        let result = mlle(&picture, &Mlle::default());
        let ([red, green, _], [red_before, green_before, _]) = (means(&result), means(&picture));
        assert!(red / green > 1.5 * red_before / green_before, "{red} {green}");
        let step = |picture: &Rgb8| i32::from(picture.pixel(82, 61)[1]) - i32::from(picture.pixel(77, 61)[1]);
        assert!(
            step(&result).abs() > step(&picture).abs(),
            "{} {}",
            step(&result),
            step(&picture)
        );
    }

    #[test]
    fn every_parameter_changes_the_result() {
        let picture = reef();
        let default = Mlle::default();
        let plain = mlle(&picture, &default);
        let others = [
            Mlle {
                attenuation_gamma: 0.3,
                ..default
            },
            Mlle {
                window_px: 5,
                ..default
            },
            Mlle {
                contrast_max: 1.2,
                ..default
            },
            Mlle {
                guide_eps: 1e-2,
                ..default
            },
        ];
        for other in others {
            assert!(mlle(&picture, &other) != plain, "{other:?}");
        }
    }

    #[test]
    fn the_smaller_opponent_is_raised_halfway() {
        let [a, b] = balance([100.0, 150.0]);
        assert!((a - 1.2).abs() < 1e-12 && b == 1.0);
        assert_eq!(balance([128.0, 128.0]), [1.0, 1.0]);
    }
}
