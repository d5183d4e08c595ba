//! Step 5: saturation and value of HSV, with constant hue.
//!
//! `V = max`, `S = (max - min) / max`, 0 for max = 0. At constant hue a channel changes from c to `V' (1 - S' (max - c)
//! / (max - min))`.

use imaging::simd::{larger, smaller};
use imaging::{Rgb8, vectorized};

use crate::blocks::histogram::Curves;
use crate::blocks::tails;
use crate::variant::Variant;

/// Share of the pixels beyond either end of saturation and of value.
const TAIL: f64 = 0.01;

pub(super) fn stretched(picture: &Rgb8, curves: &Curves, variant: Variant) -> Rgb8 {
    let pixels = picture.data().len() / 3;
    let (mut saturation, mut value) = (vec![0.0f64; pixels], vec![0.0f64; pixels]);
    let mut result = picture.clone();
    match variant {
        Variant::Fast => vectorized!(hsv(picture.data(), curves, &mut saturation, &mut value)),
        Variant::Reference => hsv_reference(picture, curves, &mut saturation, &mut value),
    }
    let stretch = SaturationStretch {
        saturation: tails(&saturation, TAIL, variant),
        value: tails(&value, TAIL, variant),
    };
    match variant {
        Variant::Fast => vectorized!(stretch.apply(curves, (&saturation, &value), result.data_mut())),
        Variant::Reference => stretch.apply_reference(curves, &mut result),
    }
    result
}

fn hsv_reference(picture: &Rgb8, curves: &Curves, saturation: &mut [f64], value: &mut [f64]) {
    for (pixel, (saturation, value)) in picture.pixels().zip(saturation.iter_mut().zip(value)) {
        let (s, v) = saturation_and_value(color(curves, pixel));
        (*saturation, *value) = (s, v);
    }
}

/// The color of a pixel after the curves, 0..=1.
fn color(curves: &Curves, pixel: [u8; 3]) -> [f64; 3] {
    [0, 1, 2].map(|c| curves[c][usize::from(pixel[c])] / 255.0)
}

fn saturation_and_value([r, g, b]: [f64; 3]) -> (f64, f64) {
    let (max, min) = (r.max(g).max(b), r.min(g).min(b));
    (if max > 0.0 { (max - min) / max } else { 0.0 }, max)
}

/// Pixels per block.
const BLOCK: usize = 32;

/// The colors of a block of pixels, channel by channel, 0..=1.
#[inline(always)]
fn load(codes: &[u8], curves: &Curves) -> [[f64; BLOCK]; 3] {
    let mut block = [[0.0f64; BLOCK]; 3];
    for (channel, values) in block.iter_mut().enumerate() {
        for (value, pixel) in values.iter_mut().zip(codes.chunks_exact(3)) {
            *value = curves[channel][usize::from(pixel[channel])];
        }
        for value in values {
            *value /= 255.0;
        }
    }
    block
}

#[inline(always)]
fn hsv(codes: &[u8], curves: &Curves, saturation: &mut [f64], value: &mut [f64]) {
    let planes = saturation.chunks_mut(BLOCK).zip(value.chunks_mut(BLOCK));
    for (codes, (saturation, value)) in codes.chunks(3 * BLOCK).zip(planes) {
        let [r, g, b] = load(codes, curves);
        let (mut s, mut v) = ([0.0f64; BLOCK], [0.0f64; BLOCK]);
        for x in 0..BLOCK {
            let max = larger(larger(r[x], g[x]), b[x]);
            let min = smaller(smaller(r[x], g[x]), b[x]);
            let quotient = (max - min) / if max > 0.0 { max } else { 1.0 };
            s[x] = quotient;
            v[x] = max;
        }
        saturation.copy_from_slice(&s[..saturation.len()]);
        value.copy_from_slice(&v[..value.len()]);
    }
}

/// The ends of saturation and of value.
struct SaturationStretch {
    saturation: (f64, f64),
    value: (f64, f64),
}

/// `(z - a) / (b - a)` between the ends; values outside, and all values if the ends meet, are unchanged.
#[inline(always)]
fn stretch(z: f64, (a, b): (f64, f64)) -> f64 {
    let stretched = (z - a) / if b > a { b - a } else { 1.0 };
    if b > a && z >= a && z <= b { stretched } else { z }
}

impl SaturationStretch {
    fn apply_reference(&self, curves: &Curves, picture: &mut Rgb8) {
        for pixel in picture.data_mut().chunks_exact_mut(3) {
            let color = color(curves, [pixel[0], pixel[1], pixel[2]]);
            let (s, v) = saturation_and_value(color);
            let (new_s, new_v) = (stretch(s, self.saturation), stretch(v, self.value));
            let spread = s * v;
            for (code, c) in pixel.iter_mut().zip(color) {
                let share = if spread > 0.0 { (v - c) / spread } else { 0.0 };
                *code = (255.0 * new_v * (1.0 - new_s * share) + 0.5)
                    .floor()
                    .clamp(0.0, 255.0) as u8;
            }
        }
    }

    #[inline(always)]
    fn apply(&self, curves: &Curves, (saturation, value): (&[f64], &[f64]), codes: &mut [u8]) {
        let planes = saturation.chunks(BLOCK).zip(value.chunks(BLOCK));
        for (codes, (saturation, value)) in codes.chunks_mut(3 * BLOCK).zip(planes) {
            let colors = load(codes, curves);
            let (mut s, mut v) = ([0.0f64; BLOCK], [0.0f64; BLOCK]);
            s[..saturation.len()].copy_from_slice(saturation);
            v[..value.len()].copy_from_slice(value);
            let (mut top, mut slope) = ([0.0f64; BLOCK], [0.0f64; BLOCK]);
            for x in 0..BLOCK {
                let spread = s[x] * v[x];
                let light = 255.0 * stretch(v[x], self.value);
                let share = stretch(s[x], self.saturation) / if spread > 0.0 { spread } else { 1.0 };
                top[x] = light;
                slope[x] = light * share;
            }
            for (channel, color) in colors.iter().enumerate() {
                let mut block = [0u8; BLOCK];
                for x in 0..BLOCK {
                    let value = top[x] - slope[x] * (v[x] - color[x]) + 0.5;
                    block[x] = smaller(larger(value, 0.0), 255.0) as i32 as u8;
                }
                for (pixel, &code) in codes.chunks_exact_mut(3).zip(&block) {
                    pixel[channel] = code;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn identity() -> Curves {
        [std::array::from_fn(|code| code as f64); 3]
    }

    #[test]
    fn value_and_saturation_reach_their_ends_and_the_hue_stays() {
        // Values 200, 100 and saturations 0.5, 0.25: the ends are the two pixels.
        let picture = Rgb8::from_fn(2, 1, |x, _| if x == 0 { [200, 150, 100] } else { [100, 75, 100] });
        for variant in [Variant::Fast, Variant::Reference] {
            let result = stretched(&picture, &identity(), variant);
            assert_eq!(result.pixel(0, 0), [255, 128, 0]);
            assert_eq!(result.pixel(1, 0), [0, 0, 0]);
        }
    }

    #[test]
    fn one_color_keeps_everything() {
        let picture = Rgb8::from_fn(3, 3, |_, _| [200, 150, 100]);
        for variant in [Variant::Fast, Variant::Reference] {
            assert_eq!(stretched(&picture, &identity(), variant), picture);
        }
    }
}
