//! IBLA: restoration by image blurriness and light absorption (Peng and Cosman 2017).
//!
//! 1. Blurriness: `P = 1/4 Σ |g - Gauss_i(g)|`, g the luma, i = 1..4, windows of `2^i · 4 + 1` pixels a side and σ as
//!    large; its largest value in 7 × 7, holes filled: `P_r`; refined: `P_b`. It is small where the picture is blurred, which is
//!    interpreted as distant.
//! 2. Background light from three candidates: the mean color of the thousandth of the pixels with the smallest `P_b`, of
//!    the quadtree region with the lowest variance of luma, and of the one with the smallest mean `P_b`. For each channel
//!    `BL_c = s · max + (1 - s) · min` of the three, `s = sig(share of pixels with c > 0.5, 0.2)`.
//! 3. Closeness: `e_R = norm(lmax(R))`, `e_D = norm(lmax(R) - lmax(max(G, B)))`, `e_B = norm(P_r)`, lmax in
//!    7 × 7; with `tb = sig(mean R, 0.1)` and `ta = sig(mean BL, 0.5)` the refined
//!    `e = tb (ta e_D + (1 - ta) e_R) + (1 - tb) e_B`.
//! 4. `near = 1 - |BL_k - c_k| / max(BL_k, 1 - BL_k)` of the pixel and the channel k where `|BL_k - c_k|` is largest;
//!    `D = 8 (1 - e + near)`.
//! 5. `b_R = 1/7`, `b_k = b_R F_R m_k / (F_k m_R)` with `F = max(BL, 0.1)` and `m = -0.00113 λ + 1.62517` at 620, 540 and 450 nm;
//!    `t_c = max(exp(-b_c D), 0.1)`; `J_c = (c - BL_c) / t_c + BL_c`.
//!
//! `sig(a, b) = 1 / (1 + exp(-32 (a - b)))`; channels are in 0..=1. Refinement follows the picture by its matting
//! Laplacian, as in the authors' program. The guided filter, which the paper also allows, is much faster and often
//! finds another light.
//!
//! Known failures: a large plain object has no texture and is mistaken for water; if it is bright, the rest turns dark.
//! With a lamp the light is the black water behind, and lit objects turn white. An undecided sigmoid makes the light
//! change between frames of a film. A picture of one color is unchanged.

mod blurriness;
mod light;
#[cfg(test)]
mod tests;

use imaging::{Plane, Raster, Rgb8, vectorized};
use spec::{Ibla, IblaRefinement};

use crate::blocks::{Guide, Matting, Veil, extremes, guided, normalized, restore, window_max};
use crate::result::{Enhanced, OfGray};
use crate::signs::{self, Signs};
use crate::variant::Variant;
use crate::warning::Warning;
use blurriness::{MAXIMUM_PX, blurriness};
use light::{BackgroundLight, sigmoid};

/// Units of distance between the nearest and the farthest pixel.
const DEPTH: f64 = 8.0;
/// Attenuation of red per unit of distance.
const RED_ATTENUATION: f64 = 1.0 / 7.0;
/// Wavelengths of red, green and blue.
const WAVELENGTH_NM: [f64; 3] = [620.0, 540.0, 450.0];
/// Lower limit of the light in the derivation of attenuation.
const LIGHT_MIN: f64 = 0.1;
/// Smallest transmittance, without an upper limit.
const TRANSMITTANCE: (f64, f64) = (0.1, f64::INFINITY);
/// A brighter light that blackens the picture is a bright object.
const BRIGHT_LIGHT: f64 = 0.8;

/// Restores a picture of at least one pixel; `auto` refines by matting. The result is colored; 16 bit is reduced to 8.
#[must_use]
pub(crate) fn enhance(picture: &Raster, parameters: &Ibla, variant: Variant) -> Enhanced {
    let colors = picture.to_rgb8();
    let guide = &Guide::new(&colors).window(parameters.guide_radius_px, parameters.guide_eps);
    let blurriness = blurriness(&colors, variant);
    let (light, mix, closeness) = match parameters.refine {
        IblaRefinement::Auto | IblaRefinement::Matting => {
            let measures = Measures::new(guide, blurriness.clone(), variant);
            // Closeness depends on the light by one factor, which is approximately known: refine it together with
            // blurriness.
            let guess = || {
                Mix::new(guide, BackgroundLight::new(&colors, &blurriness, variant).color)
                    .closeness(&measures)
            };
            let matting = Matting::new(guide, variant);
            let (refined, ahead) = matting.refined_beside(&blurriness, guess);
            let light = BackgroundLight::new(&colors, &refined, variant);
            let mix = Mix::new(guide, light.color);
            let closeness = matting.refined_near(&mix.closeness(&measures), ahead);
            (light, mix, closeness)
        }
        IblaRefinement::Guided => {
            let light = BackgroundLight::new(&colors, &guided(guide, &blurriness, variant), variant);
            let mix = Mix::new(guide, light.color);
            let Measures {
                by_red,
                by_loss,
                by_blur,
            } = Measures::new(guide, blurriness, variant);
            let closeness = guided(guide, &mix.joined(by_red, &by_loss, &by_blur), variant);
            (light, mix, closeness)
        }
    };
    let nearest = nearest(&colors, light.color);
    let mut distance = closeness;
    let values = distance.data_mut().iter_mut();
    values.for_each(|e| *e = DEPTH * (1.0 - *e + nearest));
    let veil = Veil {
        light: light.color,
        attenuation: attenuation(light.color),
        transmittance: TRANSMITTANCE,
    };
    let restored = restore(&colors, &distance, &veil, variant);
    let mut warnings = signs::warnings(&colors, &restored, &[(Warning::Gray, Signs::is_gray)]);
    if warnings.contains(&Warning::Blackened) && light.color.iter().any(|&value| value > BRIGHT_LIGHT) {
        warnings.push(Warning::LampAsBackground);
    }
    if light.is_unstable([mix.by_loss, mix.by_color]) {
        warnings.push(Warning::UnstableLight);
    }
    Enhanced::from_colors(picture, &restored, OfGray::Color, warnings)
}

/// The three candidate colors of the background light of a picture of at least one pixel. With refined blurriness
/// `P_b`, small where the picture is blurred, they are in this order
///
/// - the mean color of the thousandth of the pixels with the smallest `P_b`, at least one pixel,
/// - that of the quadtree region with the lowest variance of luma, the same for all refinements,
/// - that of the quadtree region with the smallest mean `P_b`,
///
/// each red, green and blue in 0..=1 of the codes.
#[must_use]
pub fn candidates(picture: &Rgb8, refine: IblaRefinement, variant: Variant) -> [[f64; 3]; 3] {
    let guide = Guide::new(picture);
    let blurriness = blurriness(picture, variant);
    let refined = match refine {
        IblaRefinement::Auto | IblaRefinement::Matting => Matting::new(&guide, variant).refined(&blurriness),
        IblaRefinement::Guided => guided(&guide, &blurriness, variant),
    };
    BackgroundLight::new(picture, &refined, variant).candidates
}

/// The measures of closeness, each 0..=1.
struct Measures {
    /// `e_R`.
    by_red: Plane<f64>,
    /// `e_D`.
    by_loss: Plane<f64>,
    /// `e_B`.
    by_blur: Plane<f64>,
}

impl Measures {
    fn new(guide: &Guide, blurriness: Plane<f64>, variant: Variant) -> Self {
        let red = &guide.channels()[0];
        let (width, height) = red.size();
        let red_max = window_max(red, MAXIMUM_PX, variant);
        let brighter_max = window_max(&guide.brighter(), MAXIMUM_PX, variant);
        let codes = red_max.data().iter().zip(brighter_max.data());
        let lost = codes
            .map(|(&r, &other)| (f64::from(r) - f64::from(other)) / 255.0)
            .collect();
        Self {
            by_red: normalized(red_max.map(|&code| f64::from(code) / 255.0)),
            by_loss: normalized(Plane::new(width, height, lost).expect("a value for each pixel")),
            by_blur: normalized(blurriness),
        }
    }
}

/// Weights of the measures of closeness.
struct Mix {
    /// `ta`: weight of the loss of red against red.
    by_loss: f64,
    /// `tb`: weight of both against blurriness.
    by_color: f64,
}

impl Mix {
    fn new(guide: &Guide, light: [f64; 3]) -> Self {
        let red = guide.channels()[0].data();
        let red_sum: u64 = red.iter().map(|&code| u64::from(code)).sum();
        Self {
            by_loss: sigmoid(light.iter().sum::<f64>() / 3.0, 0.5),
            by_color: sigmoid(red_sum as f64 / (255 * red.len()) as f64, 0.1),
        }
    }

    /// `e` of step 3 before refinement.
    fn closeness(&self, measures: &Measures) -> Plane<f64> {
        self.joined(measures.by_red.clone(), &measures.by_loss, &measures.by_blur)
    }

    fn joined(&self, by_red: Plane<f64>, by_loss: &Plane<f64>, by_blur: &Plane<f64>) -> Plane<f64> {
        let mut closeness = by_red;
        vectorized!(mix(
            closeness.data_mut(),
            by_loss.data(),
            by_blur.data(),
            self.by_loss,
            self.by_color
        ));
        closeness
    }
}

#[inline(always)]
fn mix(closeness: &mut [f64], by_loss: &[f64], by_blur: &[f64], ta: f64, tb: f64) {
    for ((by_red, by_loss), by_blur) in closeness.iter_mut().zip(by_loss).zip(by_blur) {
        *by_red = tb * (ta * by_loss + (1.0 - ta) * *by_red) + (1.0 - tb) * by_blur;
    }
}

/// `near` of step 4.
fn nearest(picture: &Rgb8, light: [f64; 3]) -> f64 {
    let (low, high) = extremes(picture);
    let differences: [f64; 3] = std::array::from_fn(|c| {
        let (low, high) = (f64::from(low[c]) / 255.0, f64::from(high[c]) / 255.0);
        (light[c] - low).abs().max((high - light[c]).abs())
    });
    let mut farthest = 0;
    for channel in 1..3 {
        if differences[channel] > differences[farthest] {
            farthest = channel;
        }
    }
    1.0 - differences[farthest] / light[farthest].max(1.0 - light[farthest])
}

/// `b_c` of step 5.
fn attenuation(light: [f64; 3]) -> [f64; 3] {
    let m = WAVELENGTH_NM.map(|nm| -0.001_13 * nm + 1.625_17);
    let f = light.map(|value| value.max(LIGHT_MIN));
    std::array::from_fn(|channel| match channel {
        0 => RED_ATTENUATION,
        _ => RED_ATTENUATION * f[0] * m[channel] / (f[channel] * m[0]),
    })
}
