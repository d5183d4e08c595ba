//! Fusion: color balance and multi-scale fusion (Ancuti, Ancuti, De Vleeschouwer and Bekaert 2018).
//!
//! 1. Compensation, with channel means `m`: `R' = R + a_R max(m_G - m_R, 0) (1 - R) G` (eq. 4) and
//!    `B' = B + a_B max(m_G - m_B, 0) (1 - B) G` (eq. 5), at most 1. The paper uses a = 1 for red, and compensates blue only
//!    in turbid water: the default of a_B is 0.
//! 2. Gray world: `c = min(c' m / m_c, 1)` with the means of step 1; m is the mean of the three. A channel without light
//!    stays black.
//! 3. Input 1 is `c^γ`. Input 2 is `(c + N(c - G c)) / 2`: G is the binomial blur with 5 × 5 taps, and N one shift and one
//!    scale for all channels that map the least difference to 0 and the greatest to 1. If all differences are equal,
//!    input 2 is c.
//! 4. Weight of an input: `w = w_L + w_S + w_sat`, with its luma `Y = 0.299 R + 0.587 G + 0.114 B`:
//!    `w_L = |4 Y - left - right - above - below|`; `w_S` a hundredth of the distance in CIE Lab between the mean color and
//!    the color blurred by G; `w_sat = sqrt(((R - Y)² + (G - Y)² + (B - Y)²) / 3)`. Then
//!    `W_k = (w_k + 0.1) / (w_1 + w_2 + 0.2)`.
//! 5. `Σ_k G_l(W_k) L_l(input k)` on every level l of Gaussian and Laplacian pyramids, collapsed and clipped. A level has
//!    half the sides, rounded up, of the previous one: blurred by G, every second sample. The inverse doubles by the same
//!    kernel: `(a + 6 b + c) / 8` at samples, `(b + c) / 2` between them. The number of levels is
//!    at most `1 + floor(log2(shorter side))`.
//!
//! Channels are in 0..=1; borders are replicated. The paper leaves open γ, the kernels, the scale of `w_S` and the number of
//! levels: those above and the defaults are this project's reading.
//!
//! The fast variant uses `W_2 = 1 - W_1`, so that the result is input 2 plus the collapsed `G_l(W_1) L_l(input 1 - input 2)`.
//!
//! Known failures: N stretches the differences of a picture without edges, which are noise. Compensation copies green
//! into missing red. Gray world turns a picture of one color gray and shifts with colored objects.

mod definition;
mod fast;
mod pyramid;
mod reference;
mod weight;

use imaging::Raster;
use spec::Fusion;

use crate::result::{Enhanced, OfGray};
use crate::signs::{self, Signs};
use crate::variant::Variant;
use crate::warning::Warning;

/// A larger gain causes a warning.
const LARGE_GAIN: f64 = 4.0;
/// Enhances a picture of at least one pixel. Gray stays gray; 16 bit is reduced to 8.
#[must_use]
pub(crate) fn enhance(picture: &Raster, parameters: &Fusion, variant: Variant) -> Enhanced {
    let colors = picture.to_rgb8();
    let fused = match variant {
        Variant::Fast => fast::fuse(&colors, parameters),
        Variant::Reference => reference::fuse(&colors, parameters),
    };
    let others: &[signs::FailureSign] = &[
        (Warning::ChannelWithoutLight, Signs::lacks_a_channel),
        (Warning::RedCast, Signs::turned_red),
    ];
    let mut warnings = signs::warnings(&colors, &fused.picture, others);
    if fused.balance[0] > LARGE_GAIN {
        warnings.push(Warning::RedAmplified);
    }
    if fused.detail > LARGE_GAIN || fused.balance[1..].iter().any(|&gain| gain > LARGE_GAIN) {
        warnings.push(Warning::NoiseAmplified);
    }
    Enhanced::from_colors(picture, &fused.picture, OfGray::Gray, warnings)
}

#[cfg(test)]
mod tests {
    use imaging::Rgb8;

    use super::definition::count_levels;
    use super::*;

    fn fused(colors: &Rgb8, parameters: &Fusion) -> Rgb8 {
        enhance(&Raster::from(colors.clone()), parameters, Variant::Fast)
            .picture
            .to_rgb8()
    }

    fn means(picture: &Rgb8) -> [f64; 3] {
        let n = picture.pixels().len() as f64;
        std::array::from_fn(|c| picture.pixels().map(|pixel| f64::from(pixel[c])).sum::<f64>() / n)
    }

    fn reef() -> Rgb8 {
        Rgb8::from_fn(120, 90, |x, y| {
            let plate = 30.0 + 20.0 * ((x / 12 + 2 * (y / 9)) % 6) as f64;
            [0.3, 1.0, 0.8].map(|tint| (plate * tint) as u8)
        })
    }

    #[test]
    fn black_stays_and_one_color_turns_gray() {
        let one_color = |pixel: [u8; 3]| fused(&Rgb8::from_fn(9, 7, |_, _| pixel), &Fusion::default());
        assert!(one_color([0; 3]).data().iter().all(|&code| code == 0));
        let gray = one_color([60, 120, 140]);
        assert!(
            gray.pixels().all(|[r, g, b]| r == g && g == b && r > 90),
            "{:?}",
            gray.pixel(0, 0)
        );
    }

    #[test]
    fn channels_are_balanced_and_edges_sharpened() {
        let picture = reef();
        let result = fused(&picture, &Fusion::default());
        let [r, g, b] = means(&result);
        assert!((r - g).abs() < 6.0 && (b - g).abs() < 6.0, "{r} {g} {b}");
        // Across the edge of two plates, and between their middles, which are equally far apart before.
        let [edge, plates] = [(59, 60), (54, 66)]
            .map(|(left, right)| result.pixel(left, 40)[1].abs_diff(result.pixel(right, 40)[1]));
        assert!(2 * edge > 3 * plates, "{edge} {plates}");
    }

    #[test]
    fn without_compensation_gray_world_amplifies_the_noise_of_red() {
        let picture = Rgb8::from_fn(120, 90, |x, y| {
            let [_, g, b] = reef().pixel(x, y);
            [((x * 7 + y * 3) % 5) as u8, g, b]
        });
        let spread = |parameters: &Fusion| {
            let result = fused(&picture, parameters);
            let reds: Vec<u8> = (0..8).map(|x| result.pixel(x, 3)[0]).collect();
            reds.iter().max().unwrap() - reds.iter().min().unwrap()
        };
        let none = Fusion {
            red_gain: 0.0,
            ..Fusion::default()
        };
        assert!(
            spread(&none) > 2 * spread(&Fusion::default()),
            "{}",
            spread(&none)
        );
    }

    #[test]
    fn every_parameter_changes_the_result() {
        let picture = reef();
        let default = Fusion::default();
        let plain = fused(&picture, &default);
        let others = [
            Fusion {
                red_gain: 0.5,
                ..default
            },
            Fusion {
                blue_gain: 1.0,
                ..default
            },
            Fusion {
                gamma: 2.0,
                ..default
            },
            Fusion { levels: 1, ..default },
        ];
        for other in others {
            assert!(fused(&picture, &other) != plain, "{other:?}");
        }
        assert_eq!((count_levels(16, 120, 90), count_levels(5, 120, 90)), (7, 5));
        assert_eq!(count_levels(16, 1, 300), 1);
    }
}
