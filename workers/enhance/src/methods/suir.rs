//! SUIR: single underwater image restoration by blue-green dehazing and red correction (Li, Cong, Pang and Wang 2016).
//!
//! 1. `c = norm` over all three channels together (one color value: unchanged).
//! 2. Background light: the color of the pixel with the smallest `lmax(R) - lmax(max(G, B))` in 9 × 9, the first of
//!    equals; B_c at least 1/255.
//! 3. For k in G, B: `t_k = guided(1 - lmin(k / B_k))` in 9 × 9, cut to 0.1..=0.9; `J_k = (k - B_k) / t_k + B_k`.
//! 4. `norm` over (R, J_G, J_B) together (one value: unchanged); of its red nothing is used.
//! 5. `R' = R · gain`, cut to 0..=1, with R of step 1 and `gain = (1.5 - mean J_G - mean J_B) / mean R`, at least 0.1;
//!    R is unchanged where it is 0 or of one value.
//! 6. With the lumas Y_i of step 1 and Y_j of (R', J_G, J_B), both cut to 0.01..=1, the result is multiplied by the guided
//!    `s = (Y_j Y_i + 0.3 Y_i²) / (Y_j² + 0.3 Y_i²)` and cut to 0..=1.
//!
//! The guide is the picture of step 1. Where it fails: one color is not one value, and (60, 120, 140) becomes a saturated
//! blue; a little red is multiplied into noise; haze removed where there is none leaves a few values far out, the joint
//! stretch squeezes the rest, and red takes over; a gray picture loses haze and becomes colored.

use imaging::{Plane, Raster, Rgb8, vectorized};

use crate::blocks::{FLAT, Guide, extremes, guided, range, window_max, window_min};
use crate::result::{Enhanced, OfGray};
use crate::signs::{self, Signs};
use crate::variant::Variant;
use crate::warning::Warning;

/// Radius of the windows of local extremes, pixels.
const WINDOW_PX: usize = 4;
/// Least and greatest transmittance.
const TRANSMITTANCE: (f64, f64) = (0.1, 0.9);
/// What the means of the three channels add up to in a balanced picture.
const BALANCED: f64 = 1.5;
const GAIN_MIN: f64 = 0.1;
/// A gain of red above this is worth a warning.
const LARGE_GAIN: f64 = 4.0;
/// Least luma of the exposure map, and the weight of the input in it.
const LUMA_MIN: f64 = 0.01;
const INPUT_WEIGHT: f64 = 0.3;
const LUMA: [f64; 3] = [0.299, 0.587, 0.114];

/// Restores a picture of at least one pixel. The result is colored; 16 bit is reduced to 8.
#[must_use]
pub(crate) fn enhance(picture: &Raster, variant: Variant) -> Enhanced {
    let colors = picture.to_rgb8();
    let stretch = Stretch::new(&colors);
    let guide = Guide::new(&colors).scaled(stretch.scale);
    let light = background(&guide, variant).map(|code| stretch.value(code).max(1.0 / 255.0));
    let channels = guide.channels().each_ref();
    let input = channels.map(|channel| channel.map(|&code| stretch.value(code)));
    let green = dehazed(&guide, &stretch, 1, light[1], variant);
    let blue = dehazed(&guide, &stretch, 2, light[2], variant);
    let [green, blue] = normalized_together(&input[0], [green, blue]);
    let gain = red_gain(&input[0], &green, &blue);
    let red = input[0].map(|value| gain.map_or(*value, |gain| (value * gain).clamp(0.0, 1.0)));
    let exposure = exposure(&input, [&red, &green, &blue]);
    let exposure = guided(&guide, &exposure, variant);

    let mut result = colors.clone();
    for (channel, plane) in [&red, &green, &blue].into_iter().enumerate() {
        let values = plane.data().iter().zip(exposure.data());
        for (pixel, (value, exposure)) in result.data_mut().chunks_exact_mut(3).zip(values) {
            pixel[channel] = (255.0 * (value * exposure).clamp(0.0, 1.0) + 0.5) as u8;
        }
    }
    let others: &[signs::Sign] = &[
        (Warning::Gray, Signs::is_gray),
        (Warning::RedCast, Signs::turned_red),
        (Warning::ChannelWithoutLight, Signs::lacks_a_channel),
    ];
    let mut warnings = signs::warnings(&colors, &result, others);
    if gain.is_some_and(|gain| gain > LARGE_GAIN) {
        warnings.push(Warning::RedAmplified);
    }
    Enhanced::from_colors(picture, &result, OfGray::Color, warnings)
}

/// The joint stretch of step 1.
struct Stretch {
    least: f64,
    scale: f64,
}

impl Stretch {
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

/// The codes of the background light. The stretch keeps the order of differences, so codes are compared.
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
fn dehazed(guide: &Guide, stretch: &Stretch, channel: usize, light: f64, variant: Variant) -> Plane<f64> {
    let codes = &guide.channels()[channel];
    let least = window_min(codes, WINDOW_PX, variant);
    let raw = least.map(|&code| 1.0 - stretch.value(code) / light);
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

/// What red is multiplied by in step 5; `None` where there is nothing to multiply.
fn red_gain(red: &Plane<f64>, green: &Plane<f64>, blue: &Plane<f64>) -> Option<f64> {
    let mean = |plane: &Plane<f64>| plane.data().iter().sum::<f64>() / plane.data().len() as f64;
    let (low, high) = range(red.data());
    let red_mean = mean(red);
    if red_mean <= 0.0 || high - low <= FLAT {
        return None;
    }
    Some(((BALANCED - mean(green) - mean(blue)) / red_mean).max(GAIN_MIN))
}

/// `s` of step 6, before the guided filter.
fn exposure(input: &[Plane<f64>; 3], result: [&Plane<f64>; 3]) -> Plane<f64> {
    let luma = |[r, g, b]: [&Plane<f64>; 3]| {
        let mut luma = r.map(|_| 0.0);
        vectorized!(weighted(luma.data_mut(), [r.data(), g.data(), b.data()]));
        luma
    };
    let mut exposure = luma(result);
    let before = luma(input.each_ref());
    for (after, before) in exposure.data_mut().iter_mut().zip(before.data()) {
        let (y_j, y_i) = (after.clamp(LUMA_MIN, 1.0), before.clamp(LUMA_MIN, 1.0));
        *after = (y_j * y_i + INPUT_WEIGHT * y_i * y_i) / (y_j * y_j + INPUT_WEIGHT * y_i * y_i);
    }
    exposure
}

#[inline(always)]
fn weighted(luma: &mut [f64], [r, g, b]: [&[f64]; 3]) {
    for ((luma, r), (g, b)) in luma.iter_mut().zip(r).zip(g.iter().zip(b)) {
        *luma = LUMA[0] * r + LUMA[1] * g + LUMA[2] * b;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn suir(colors: &Rgb8) -> Rgb8 {
        enhance(&Raster::from(colors.clone()), Variant::Fast)
            .picture
            .to_rgb8()
    }

    #[test]
    fn one_value_comes_back_and_one_color_becomes_saturated() {
        let gray = Rgb8::from_fn(20, 20, |_, _| [90; 3]);
        assert_eq!(suir(&gray), gray);
        let blue = suir(&Rgb8::from_fn(20, 20, |_, _| [60, 120, 140])).pixel(10, 10);
        assert!(blue[0] == 0 && blue[2] > blue[1] && blue[2] > 140, "{blue:?}");
    }

    #[test]
    fn a_picture_without_red_keeps_none() {
        let picture = Rgb8::from_fn(50, 40, |x, y| [0, (60 + 2 * x) as u8, (80 + 3 * y) as u8]);
        assert!(suir(&picture).pixels().all(|pixel| pixel[0] == 0));
    }

    #[test]
    fn red_is_raised_towards_the_balance() {
        let picture = Rgb8::from_fn(80, 60, |x, y| {
            let texture = ((x / 5 + y / 4) % 3) as u8;
            [20 + 4 * texture, 90 + 30 * texture, 100 + 35 * texture]
        });
        let mean = |picture: &Rgb8| picture.pixels().map(|pixel| u64::from(pixel[0])).sum::<u64>() / 4800;
        assert!(mean(&suir(&picture)) > mean(&picture) + 10);
    }

    #[test]
    fn the_background_is_where_red_is_weakest() {
        let picture = Rgb8::from_fn(40, 20, |x, _| if x > 30 { [5, 100, 120] } else { [90, 100, 110] });
        assert_eq!(background(&Guide::new(&picture), Variant::Fast), [5, 100, 120]);
    }
}
