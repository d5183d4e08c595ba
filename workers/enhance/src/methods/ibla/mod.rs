//! IBLA: restoration by image blurriness and light absorption (Peng and Cosman 2017).
//!
//! 1. Blurriness: `P = 1/4 Σ |g - Gauss_i(g)|`, g the luma, i = 1..4, windows of `2^i · 4 + 1` pixels a side and σ as
//!    large; its largest value in 7 × 7; guided filter: `P_b`.
//! 2. Background light from three candidates: the mean color of the thousandth of the pixels with the largest `P_b`, of
//!    the quadtree region with the lowest variance of luma, and of the one with the largest mean `P_b`. For each channel
//!    `BL_c = s · max + (1 - s) · min` of the three, `s = sig(part of pixels with c > 0.5, 0.2)`.
//! 3. Distance: `d_R = 1 - norm(lmax(R))`, `d_D = 1 - norm(lmax(R) - lmax(max(G, B)))`, `d_B = 1 - norm(P_b)`, lmax in
//!    7 × 7; with `tb = sig(mean R, 0.1)` and `ta = sig(mean BL, 0.5)`,
//!    `d = tb (ta d_D + (1 - ta) d_R) + (1 - tb) d_B`, refined by the guided filter. `D = 10 (norm(d) + d0)`.
//! 4. `t_R = exp(-D / 7)`, `t_k = t_R^(BL_R m_k / (BL_k m_R))` with `m = -0.00113 λ + 1.62517` at 620, 540 and 450 nm and
//!    `BL_k` at least 1/255; cut to 0.1..=1. `J_c = (c - BL_c) / t_c + BL_c`.
//!
//! `sig(a, b) = 1 / (1 + exp(-32 (a - b)))`; d0 is [`distance_offset`]; channels lie in 0..=1.
//!
//! Where it fails, by design: with a lamp in view more than a fifth of a channel is bright, the lamp is taken for the
//! background light, and most of the picture turns black. A picture of one color is unchanged.

mod light;

use imaging::{Plane, Raster, Rgb8, luma1000, vectorized};

use crate::blocks::{Guide, Veil, distance_of, distance_offset, gaussian, guided, normalized};
use crate::blocks::{restore, window_max};
use crate::result::{Enhanced, OfGray};
use crate::signs::{self, Signs};
use crate::variant::Variant;
use crate::warning::Warning;

/// Radius of the windows of local maxima, pixels.
const MAXIMUM_PX: usize = 3;
/// Units of distance between the nearest and the farthest pixel.
const DEPTH: f64 = 10.0;
/// Attenuation of red for a unit of distance.
const RED_ATTENUATION: f64 = 1.0 / 7.0;
/// Wavelengths of red, green and blue.
const WAVELENGTH_NM: [f64; 3] = [620.0, 540.0, 450.0];
/// Least and greatest transmittance.
const TRANSMITTANCE: (f64, f64) = (0.1, 1.0);

/// Restores a picture of at least one pixel. The result is colored; 16 bit is reduced to 8.
#[must_use]
pub(crate) fn enhance(picture: &Raster, variant: Variant) -> Enhanced {
    let colors = picture.to_rgb8();
    let guide = Guide::new(&colors);
    let blurriness = blurriness(&colors, &guide, variant);
    let light = light::background(&colors, &blurriness, variant);
    let distance = distance(&guide, blurriness, light, variant);
    let distance = guided(&guide, &distance, variant);
    let nearest = distance_offset(&colors, light);
    let distance = distance_of(distance, nearest, DEPTH);
    let veil = Veil {
        light,
        attenuation: attenuation(light),
        transmittance: TRANSMITTANCE,
    };
    let restored = restore(&colors, &distance, &veil, variant);
    let mut warnings = signs::warnings(&colors, &restored, &[(Warning::Gray, Signs::is_gray)]);
    if warnings.contains(&Warning::Blackened) && light::is_bright(&colors) {
        warnings.push(Warning::LampAsBackground);
    }
    Enhanced::from_colors(picture, &restored, OfGray::Color, warnings)
}

/// `P_b` of step 1.
fn blurriness(picture: &Rgb8, guide: &Guide, variant: Variant) -> Plane<f64> {
    let luma = picture
        .pixels()
        .map(|pixel| f64::from(luma1000(pixel)) / 255_000.0);
    let luma = Plane::new(picture.width(), picture.height(), luma.collect()).expect("a luma for each pixel");
    let mut sharpness = luma.map(|_| 0.0);
    for i in 1..=4u32 {
        let radius = 2usize.pow(i) * 2;
        let blurred = gaussian(&luma, radius, (2 * radius + 1) as f64, variant);
        let differences = luma.data().iter().zip(blurred.data());
        for (sum, (value, blurred)) in sharpness.data_mut().iter_mut().zip(differences) {
            *sum += 0.25 * (value - blurred).abs();
        }
    }
    guided(guide, &window_max(&sharpness, MAXIMUM_PX, variant), variant)
}

/// `1 / (1 + exp(-32 (a - b)))`.
fn sigmoid(a: f64, b: f64) -> f64 {
    1.0 / (1.0 + (-32.0 * (a - b)).exp())
}

/// `d` of step 3, before the guided filter.
fn distance(guide: &Guide, blurriness: Plane<f64>, light: [f64; 3], variant: Variant) -> Plane<f64> {
    let red = &guide.channels()[0];
    let (width, height) = red.size();
    let red_max = window_max(red, MAXIMUM_PX, variant);
    let brighter_max = window_max(&guide.brighter(), MAXIMUM_PX, variant);
    let red_sum: u64 = red.data().iter().map(|&code| u64::from(code)).sum();
    let red_mean = red_sum as f64 / (255 * red.data().len()) as f64;
    let tb = sigmoid(red_mean, 0.1);
    let ta = sigmoid(light.iter().sum::<f64>() / 3.0, 0.5);

    let by_red = normalized(red_max.map(|&code| f64::from(code) / 255.0));
    let codes = red_max.data().iter().zip(brighter_max.data());
    let lost = codes
        .map(|(&r, &other)| (f64::from(r) - f64::from(other)) / 255.0)
        .collect();
    let by_loss = normalized(Plane::new(width, height, lost).expect("a value for each pixel"));
    let by_blur = normalized(blurriness);
    let mut distance = by_red;
    vectorized!(mix(distance.data_mut(), by_loss.data(), by_blur.data(), ta, tb));
    distance
}

#[inline(always)]
fn mix(distance: &mut [f64], by_loss: &[f64], by_blur: &[f64], ta: f64, tb: f64) {
    for ((by_red, by_loss), by_blur) in distance.iter_mut().zip(by_loss).zip(by_blur) {
        let absorbed = ta * (1.0 - by_loss) + (1.0 - ta) * (1.0 - *by_red);
        *by_red = tb * absorbed + (1.0 - tb) * (1.0 - by_blur);
    }
}

/// `β_c` of step 4.
fn attenuation(light: [f64; 3]) -> [f64; 3] {
    let m = WAVELENGTH_NM.map(|nm| -0.001_13 * nm + 1.625_17);
    std::array::from_fn(|channel| match channel {
        0 => RED_ATTENUATION,
        _ => RED_ATTENUATION * light[0] * m[channel] / (light[channel].max(1.0 / 255.0) * m[0]),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ibla(colors: &Rgb8, variant: Variant) -> Rgb8 {
        enhance(&Raster::from(colors.clone()), variant).picture.to_rgb8()
    }

    #[test]
    fn one_color_and_black_come_back() {
        for pixel in [[0; 3], [60, 120, 140], [255; 3]] {
            let picture = Rgb8::from_fn(40, 30, |_, _| pixel);
            for variant in [Variant::Fast, Variant::Reference] {
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
    fn a_lamp_taken_for_the_water_turns_most_of_the_picture_black() {
        let lamp = Rgb8::from_fn(160, 120, |x, y| {
            let texture = ((x / 3 + y / 5) % 4) as u8 * 8;
            if y < 64 {
                [235, 240, 238]
            } else {
                [30 + texture, 70 + texture, 80 + texture]
            }
        });
        let dark = |picture: &Rgb8| picture.data().iter().filter(|&&code| code < 8).count();
        assert_eq!(dark(&lamp), 0);
        let restored = ibla(&lamp, Variant::Fast);
        assert!(dark(&restored) > lamp.data().len() / 3, "{}", dark(&restored));
    }
}
