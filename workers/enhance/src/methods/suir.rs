//! SUIR: single underwater image restoration by blue-green dehazing and red correction (Li, Guo, Pang, Chen and Wang
//! 2016).
//!
//! 1. `c = norm` over all three channels together (one color value: unchanged).
//! 2. Background light: the color of the pixel with the smallest `lmax(R) - lmax(max(G, B))` in 9 × 9, the first of
//!    ties; B_c at least 1/255.
//! 3. For k in G, B: `t_k = guided(1 - lmin0(k / B_k))` in 9 × 9, clipped to 0.1..=0.9; `J_k = (k - B_k) / t_k + B_k`. `lmin0`
//!    is 0 outside of the picture, so that a rim of 4 pixels counts as clear.
//! 4. `norm` over (R, J_G, J_B) together (one value: unchanged); its red is discarded.
//! 5. `R' = norm(R)`, R of step 1 stretched alone (one value: unchanged).
//! 6. With the lumas Y'_i of step 1 and Y'_j of (R', J_G, J_B), the result is multiplied by the guided
//!    `s = (Y'_j Y'_i + 0.3 Y'_i²) / (Y'_j² + 0.3 Y'_i²)` and clipped to 0..=1. `Y' = (Y - lo) / (hi - lo)`, clipped to 0.01..=1,
//!    where lo and hi are the smallest and the largest value of `Y`, `Cr = 0.713 (R - Y) + 0.5` and `Cb = 0.564 (B - Y) + 0.5`
//!    together.
//!
//! The guide is the picture of step 1. The paper multiplies red until the means of the channels add up to 1.5; the
//! published programs then stretch red to its full range, which cancels the gain. Taken literally the paper turns most
//! of a turbid photo red.
//!
//! Known failures: one color is not one value, and (60, 120, 140) becomes a saturated blue; red that spans a few codes
//! is stretched into noise; a lamp's spot is the only red and turns red; a gray picture loses haze and becomes colored;
//! a picture of fewer than 9 pixels a side is all rim.

use imaging::{Plane, Raster, Rgb8, vectorized};
use spec::Guided;

use crate::blocks::{FLAT, Guide, extremes, guided, range, window_max, window_min};
use crate::result::{Enhanced, OfGray};
use crate::signs::{self, Signs};
use crate::variant::Variant;
use crate::warning::Warning;

/// Radius of the windows of local extremes, pixels.
const WINDOW_PX: usize = 4;
/// Least and greatest transmittance.
const TRANSMITTANCE: (f64, f64) = (0.1, 0.9);
/// A larger stretch of red causes a warning.
const LARGE_STRETCH: f64 = 4.0;
/// Smallest luma of the exposure map, and the weight of the input in it.
const LUMA_MIN: f64 = 0.01;
const INPUT_WEIGHT: f64 = 0.3;
const LUMA: [f64; 3] = [0.299, 0.587, 0.114];
/// Scales of the differences of red and of blue from the luma.
const CHROMA: [f64; 2] = [0.713, 0.564];

/// Restores a picture of at least one pixel. The result is colored; 16 bit is reduced to 8.
#[must_use]
pub(crate) fn enhance(picture: &Raster, parameters: &Guided, variant: Variant) -> Enhanced {
    let colors = picture.to_rgb8();
    let stretch = JointStretch::new(&colors);
    let guide = Guide::new(&colors)
        .scaled(stretch.scale)
        .with_parameters(parameters);
    let light = background(&guide, variant).map(|code| stretch.value(code).max(1.0 / 255.0));
    let (channels, exposure) = restored(&guide, &stretch, light, variant);
    let mut result = colors.clone();
    for (channel, plane) in channels.iter().enumerate() {
        let values = plane.data().iter().zip(exposure.data());
        for (pixel, (value, exposure)) in result.data_mut().chunks_exact_mut(3).zip(values) {
            pixel[channel] = (255.0 * (value * exposure).clamp(0.0, 1.0) + 0.5) as u8;
        }
    }
    let others: &[signs::FailureSign] = &[
        (Warning::Gray, Signs::is_gray),
        (Warning::RedCast, Signs::turned_red),
        (Warning::ChannelWithoutLight, Signs::lacks_a_channel),
    ];
    let mut warnings = signs::warnings(&colors, &result, others);
    let (low, high) = extremes(&colors);
    let codes = f64::from(high[0] - low[0]);
    if codes > 0.0 && codes * LARGE_STRETCH < 255.0 {
        warnings.push(Warning::RedAmplified);
    }
    Enhanced::from_colors(picture, &result, OfGray::Color, warnings)
}

/// `R'`, `J_G` and `J_B`, and the refined exposure map.
fn restored(
    guide: &Guide,
    stretch: &JointStretch,
    light: [f64; 3],
    variant: Variant,
) -> ([Plane<f64>; 3], Plane<f64>) {
    let channels = guide.channels().each_ref();
    let input = channels.map(|channel| channel.map(|&code| stretch.value(code)));
    let green = dehazed(guide, stretch, 1, light[1], variant);
    let blue = dehazed(guide, stretch, 2, light[2], variant);
    let [green, blue] = normalized_together(&input[0], [green, blue]);
    let red = stretched(&input[0]);
    let exposure = exposure(&input, [&red, &green, &blue]);
    let exposure = guided(guide, &exposure, variant);
    ([red, green, blue], exposure)
}

/// The joint stretch of step 1.
struct JointStretch {
    least: f64,
    scale: f64,
}

impl JointStretch {
    fn new(picture: &Rgb8) -> Self {
        let (low, high) = extremes(picture);
        let least = f64::from(low.into_iter().min().unwrap_or(0));
        let greatest = f64::from(high.into_iter().max().unwrap_or(0));
        let (least, greatest) = if greatest > least {
            (least, greatest)
        } else {
            (0.0, 255.0)
        };
        Self {
            least,
            scale: 1.0 / (greatest - least),
        }
    }

    fn value(&self, code: u8) -> f64 {
        (f64::from(code) - self.least) * self.scale
    }
}

/// The codes of the background light. The stretch preserves the order of differences, so codes are compared.
fn background(guide: &Guide, variant: Variant) -> [u8; 3] {
    let red_max = window_max(&guide.channels()[0], WINDOW_PX, variant);
    let brighter_max = window_max(&guide.brighter(), WINDOW_PX, variant);
    let differences = red_max.data().iter().zip(brighter_max.data());
    let farthest = differences
        .map(|(&r, &other)| i16::from(r) - i16::from(other))
        .enumerate()
        .min_by_key(|&(position, difference)| (difference, position));
    let position = farthest.map_or(0, |(position, _)| position);
    let channels = guide.channels().each_ref();
    channels.map(|channel| channel.data()[position])
}

/// `J_k` of step 3.
fn dehazed(
    guide: &Guide,
    stretch: &JointStretch,
    channel: usize,
    light: f64,
    variant: Variant,
) -> Plane<f64> {
    let codes = &guide.channels()[channel];
    let (width, height) = codes.size();
    let least = window_min(codes, WINDOW_PX, variant);
    let raw = Plane::from_fn(width, height, |x, y| {
        let is_rim = [(x, width), (y, height)]
            .into_iter()
            .any(|(position, side)| position < WINDOW_PX || position + WINDOW_PX >= side);
        if !is_rim {
            1.0 - stretch.value(least.pixel(x, y)) / light
        } else {
            1.0
        }
    });
    let mut dehazed = guided(guide, &raw, variant);
    let table: [f64; 256] = std::array::from_fn(|code| stretch.value(code as u8));
    for (t, &code) in dehazed.data_mut().iter_mut().zip(codes.data()) {
        *t = (table[usize::from(code)] - light) / t.clamp(TRANSMITTANCE.0, TRANSMITTANCE.1) + light;
    }
    dehazed
}

/// Step 4.
fn normalized_together(red: &Plane<f64>, planes: [Plane<f64>; 2]) -> [Plane<f64>; 2] {
    let ranges = [red, &planes[0], &planes[1]].map(|plane| range(plane.data()));
    let low = ranges.iter().fold(f64::MAX, |low, range| low.min(range.0));
    let high = ranges.iter().fold(f64::MIN, |high, range| high.max(range.1));
    if high - low <= FLAT {
        return planes;
    }
    let scale = 1.0 / (high - low);
    planes.map(|mut plane| {
        let values = plane.data_mut().iter_mut();
        values.for_each(|value| *value = (*value - low) * scale);
        plane
    })
}

/// Red stretched over its range.
fn stretched(red: &Plane<f64>) -> Plane<f64> {
    let (low, high) = range(red.data());
    if high - low <= FLAT {
        return red.clone();
    }
    red.map(|value| (value - low) / (high - low))
}

/// `s` of step 6, before the guided filter.
fn exposure(input: &[Plane<f64>; 3], result: [&Plane<f64>; 3]) -> Plane<f64> {
    let mut exposure = brightness(result);
    let before = brightness(input.each_ref());
    for (after, before) in exposure.data_mut().iter_mut().zip(before.data()) {
        let (y_j, y_i) = (*after, *before);
        *after = (y_j * y_i + INPUT_WEIGHT * y_i * y_i) / (y_j * y_j + INPUT_WEIGHT * y_i * y_i);
    }
    exposure
}

/// `Y'` of a picture: its luma over the joint range of luma and color differences.
fn brightness([r, g, b]: [&Plane<f64>; 3]) -> Plane<f64> {
    let mut luma = r.map(|_| 0.0);
    vectorized!(weighted(luma.data_mut(), [r.data(), g.data(), b.data()]));
    let (mut low, mut high) = range(luma.data());
    for (channel, scale) in [(r, CHROMA[0]), (b, CHROMA[1])] {
        for (value, luma) in channel.data().iter().zip(luma.data()) {
            let difference = (scale * (value - luma) + 0.5).clamp(0.0, 1.0);
            (low, high) = (low.min(difference), high.max(difference));
        }
    }
    let (low, scale) = if high - low <= FLAT {
        (0.0, 1.0)
    } else {
        (low, 1.0 / (high - low))
    };
    for luma in luma.data_mut() {
        *luma = ((*luma - low) * scale).clamp(LUMA_MIN, 1.0);
    }
    luma
}

#[inline(always)]
fn weighted(luma: &mut [f64], [r, g, b]: [&[f64]; 3]) {
    for ((luma, r), (g, b)) in luma.iter_mut().zip(r).zip(g.iter().zip(b)) {
        *luma = LUMA[0] * r + LUMA[1] * g + LUMA[2] * b;
    }
}

#[cfg(test)]
mod tests;
