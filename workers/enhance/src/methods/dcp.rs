//! DCP: the dark channel prior (He, Sun and Tang 2009 and 2011), and UDCP: its form for water, which ignores red (Drews,
//! do Nascimento, Moraes, Botelho and Campos 2013; Drews, Nascimento, Botelho and Campos 2016).
//!
//! 1. Dark channel `d = lmin(min over Ω of c)`, lmin over a window clipped to the picture; Ω is red, green and blue for
//!    DCP, green and blue for UDCP. It grows with haze, since somewhere in a window a channel is dark.
//! 2. Background light `B_c`: the color with the largest R² + G² + B² among the thousandth of the pixels with the largest
//!    d, ties in reading order; B_c at least 1/255.
//! 3. `t = guided(1 - ω lmin(min over Ω of c / B_c))`, clipped to `t_min..=1`; the guide is the picture.
//! 4. `J_c = (c - B_c) / t + B_c` for all three channels.
//!
//! Channels are in 0..=1. The papers refine t by soft matting; the guided filter is the later choice of the same authors
//! (2013). They leave open how the brightest pixel is found in color: this is the rule of ULAP.
//!
//! Known failures: a white object is taken for the background light; then DCP leaves most of the haze and UDCP turns
//! darker parts black. In water that absorbed red the dark channel of DCP is red, which is dark at any distance: t is 1 and
//! the haze stays. UDCP removes that haze and darkens red instead. A gray picture loses contrast in proportion to its brightness. In
//! dense haze t is small, and noise is divided by it. A picture of one color is unchanged up to rounding.

use imaging::{Plane, Raster, vectorized};
use spec::DarkChannel;

use crate::blocks::{Guide, brightest_of, dehaze, guided, window_min};
use crate::result::{Enhanced, OfGray};
use crate::signs::{self, Signs};
use crate::variant::Variant;
use crate::warning::Warning;

/// A transmittance below this amplifies contrast by more than four; in more than this share of the picture it causes a
/// warning.
const LOW_TRANSMITTANCE: f64 = 0.25;
const LOW_PART: f64 = 0.2;
/// Water is not white: a light with all channels above this that blackens the picture is a bright object.
const WHITE: f64 = 0.8;

/// Restores a picture of at least one pixel by DCP. Gray stays gray; 16 bit is reduced to 8.
#[must_use]
pub(crate) fn enhance(picture: &Raster, parameters: &DarkChannel, variant: Variant) -> Enhanced {
    let others: &[signs::FailureSign] = &[
        (Warning::Gray, Signs::is_gray),
        (Warning::ChannelWithoutLight, Signs::lacks_a_channel),
        (Warning::RedCast, Signs::turned_red),
    ];
    restored(picture, parameters, &[0, 1, 2], others, variant)
}

/// Restores a picture of at least one pixel by UDCP. Gray stays gray; 16 bit is reduced to 8.
#[must_use]
pub(crate) fn enhance_underwater(picture: &Raster, parameters: &DarkChannel, variant: Variant) -> Enhanced {
    let others: &[signs::FailureSign] = &[
        (Warning::Gray, Signs::is_gray),
        (Warning::RedCast, Signs::turned_red),
    ];
    restored(picture, parameters, &[1, 2], others, variant)
}

/// The result for a set Ω of channels.
fn restored(
    picture: &Raster,
    parameters: &DarkChannel,
    channels: &[usize],
    others: &[signs::FailureSign],
    variant: Variant,
) -> Enhanced {
    let colors = picture.to_rgb8();
    let guide = Guide::new(&colors).window(parameters.guide_radius_px, parameters.guide_eps);
    let darkest: Vec<Plane<u8>> = channels
        .iter()
        .map(|&c| window_min(&guide.channels()[c], parameters.window_px / 2, variant))
        .collect();
    let dark = combined(&darkest, |_| 1.0);
    let light = brightest_of(&colors, &dark, variant).map(|code| f64::from(code.max(1)) / 255.0);
    drop(dark);
    let mut transmittance = combined(&darkest, |i| 1.0 / (255.0 * light[channels[i]]));
    for t in transmittance.data_mut() {
        *t = 1.0 - parameters.omega * *t;
    }
    let transmittance = guided(&guide, &transmittance, variant);
    let restored = dehaze(
        guide.channels(),
        &transmittance,
        light,
        parameters.transmittance_min,
        variant,
    );

    let mut warnings = signs::warnings(&colors, &restored, others);
    let t = transmittance.data();
    let low = t.iter().filter(|&&t| t < LOW_TRANSMITTANCE).count();
    if low as f64 > LOW_PART * t.len() as f64 && parameters.transmittance_min < LOW_TRANSMITTANCE {
        warnings.push(Warning::NoiseAmplified);
    }
    if warnings.contains(&Warning::Blackened) && light.iter().all(|&value| value > WHITE) {
        warnings.push(Warning::LampAsBackground);
    }
    Enhanced::from_colors(picture, &restored, OfGray::Gray, warnings)
}

/// The smallest of the planes, each multiplied by its scale.
fn combined(planes: &[Plane<u8>], scale: impl Fn(usize) -> f64) -> Plane<f64> {
    let (width, height) = planes[0].size();
    let mut least = Plane::filled(width, height, f64::MAX);
    for (i, plane) in planes.iter().enumerate() {
        let scale = scale(i);
        vectorized!(lower(least.data_mut(), plane.data(), scale));
    }
    least
}

#[inline(always)]
fn lower(least: &mut [f64], codes: &[u8], scale: f64) {
    for (least, &code) in least.iter_mut().zip(codes) {
        let value = scale * f64::from(code);
        *least = if value < *least { value } else { *least };
    }
}

#[cfg(test)]
mod tests {
    use imaging::Rgb8;

    use super::*;

    type Method = fn(&Raster, &DarkChannel, Variant) -> Enhanced;

    fn result(method: Method, colors: &Rgb8, variant: Variant) -> Rgb8 {
        method(&Raster::from(colors.clone()), &DarkChannel::default(), variant)
            .picture
            .to_rgb8()
    }

    /// A board of two colors behind haze that grows to the right, up to the color of the light.
    fn hazed(light: [f64; 3]) -> Rgb8 {
        Rgb8::from_fn(240, 90, |x, y| {
            let t = (1.0 - x as f64 / 200.0).clamp(0.0, 1.0);
            let board = if (x / 5 + y / 5) % 2 == 0 {
                [0.0, 20.0, 0.0]
            } else {
                [160.0, 120.0, 130.0]
            };
            std::array::from_fn(|c| (t * board[c] + (1.0 - t) * light[c] + 0.5) as u8)
        })
    }

    #[test]
    fn one_color_stays() {
        for pixel in [[0; 3], [60, 120, 140], [255; 3]] {
            let picture = Rgb8::from_fn(40, 30, |_, _| pixel);
            for variant in [Variant::Fast, Variant::Reference] {
                for method in [enhance as Method, enhance_underwater] {
                    let result = result(method, &picture, variant);
                    assert_eq!(result, picture, "{pixel:?}");
                }
            }
        }
    }

    #[test]
    fn contrast_behind_haze_grows() {
        let picture = hazed([170.0, 200.0, 210.0]);
        let contrast = |picture: &Rgb8| picture.pixel(122, 42)[1].abs_diff(picture.pixel(127, 42)[1]);
        for method in [enhance as Method, enhance_underwater] {
            let restored = result(method, &picture, Variant::Fast);
            assert!(
                contrast(&restored) > 3 * contrast(&picture) / 2,
                "{} {}",
                contrast(&restored),
                contrast(&picture)
            );
        }
    }

    #[test]
    fn without_red_only_udcp_removes_haze() {
        let picture = hazed([0.0, 200.0, 210.0]);
        let picture = Rgb8::from_fn(picture.width(), picture.height(), |x, y| {
            let [_, g, b] = picture.pixel(x, y);
            [0, g, b]
        });
        assert_eq!(result(enhance, &picture, Variant::Fast), picture);
        assert_ne!(result(enhance_underwater, &picture, Variant::Fast), picture);
    }

    #[test]
    fn nothing_is_removed_with_omega_zero_and_the_floor_limits_the_gain() {
        let picture = hazed([170.0, 200.0, 210.0]);
        for (omega, transmittance_min, is_same) in [(0.0, 0.1, true), (0.95, 1.0, true), (0.95, 0.1, false)] {
            let parameters = DarkChannel {
                omega,
                transmittance_min,
                ..DarkChannel::default()
            };
            let restored = enhance(&Raster::from(picture.clone()), &parameters, Variant::Fast).picture;
            assert!((restored.to_rgb8() == picture) == is_same, "{parameters:?}");
        }
    }
}
