//! Inverts the simplified image model: `J_c = (c - B_c) / t_c + B_c` with the transmittance `t_c = exp(-β_c D)`, or with
//! one transmittance for all channels.

use imaging::simd::{larger, smaller};
use imaging::{Plane, Rgb8, vectorized};

use crate::elementary::exp;
use crate::variant::Variant;

/// Parameters of the water between scene and camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Veil {
    /// Background light `B_c`, 0..=1.
    pub light: [f64; 3],
    /// Attenuation `β_c` per unit of distance, not negative.
    pub attenuation: [f64; 3],
    /// Smallest and largest transmittance, above 0.
    pub transmittance: (f64, f64),
}

/// The codes of `J`, rounded and clipped, from the distance of every pixel.
///
/// # Panics
/// If the sizes differ.
#[must_use]
pub fn restore(picture: &Rgb8, distance: &Plane<f64>, veil: &Veil, variant: Variant) -> Rgb8 {
    assert_eq!(
        (picture.width(), picture.height()),
        distance.size(),
        "a distance for each pixel"
    );
    let mut restored = picture.clone();
    match variant {
        Variant::Reference => reference(restored.data_mut(), distance.data(), veil),
        Variant::Fast => vectorized!(fast(restored.data_mut(), distance.data(), veil)),
    }
    restored
}

fn reference(codes: &mut [u8], distances: &[f64], veil: &Veil) {
    for (pixel, distance) in codes.chunks_exact_mut(3).zip(distances) {
        for (channel, code) in pixel.iter_mut().enumerate() {
            let light = veil.light[channel];
            let (least, greatest) = veil.transmittance;
            let t = (-veil.attenuation[channel] * distance)
                .exp()
                .clamp(least, greatest);
            *code = exact_code(*code, light, t);
        }
    }
}

/// The code of `J` from a code, with the light in 0..=1.
fn exact_code(code: u8, light: f64, t: f64) -> u8 {
    let restored = (f64::from(code) / 255.0 - light) / t + light;
    (255.0 * restored + 0.5).floor().clamp(0.0, 255.0) as u8
}

/// Pixels per block.
const BLOCK: usize = 32;

#[inline(always)]
fn fast(codes: &mut [u8], distances: &[f64], veil: &Veil) {
    let attenuation = veil.attenuation.map(|value| value as f32);
    let light = veil.light.map(|value| 255.0 * value as f32);
    let (least, greatest) = (veil.transmittance.0 as f32, veil.transmittance.1 as f32);
    for (codes, distances) in codes.chunks_mut(3 * BLOCK).zip(distances.chunks(BLOCK)) {
        let mut distance = [0.0f32; BLOCK];
        for (to, &from) in distance.iter_mut().zip(distances) {
            *to = from as f32;
        }
        for channel in 0..3 {
            let mut values = [0.0f32; BLOCK];
            for (value, pixel) in values.iter_mut().zip(codes.chunks_exact(3)) {
                *value = f32::from(pixel[channel]);
            }
            let mut restored = [0u8; BLOCK];
            for x in 0..BLOCK {
                let t = exp(-attenuation[channel] * distance[x]);
                let t = if t < least { least } else { t };
                let t = if t > greatest { greatest } else { t };
                restored[x] = single_code(values[x], light[channel], t);
            }
            for (pixel, &code) in codes.chunks_exact_mut(3).zip(&restored) {
                pixel[channel] = code;
            }
        }
    }
}

/// The code of `J` from a code, with the light in codes.
#[inline(always)]
fn single_code(value: f32, light: f32, t: f32) -> u8 {
    let value = (value - light) / t + light + 0.5;
    let value = if value > 0.0 { value } else { 0.0 };
    let value = if value < 255.0 { value } else { 255.0 };
    value as i32 as u8
}

/// The codes of `J`, rounded and clipped, from the codes of red, green and blue and the transmittance of every pixel, at
/// least `least`; light `B_c` in 0..=1.
///
/// # Panics
/// If the sizes differ.
#[must_use]
pub fn dehaze(
    channels: &[Plane<u8>; 3],
    transmittance: &Plane<f64>,
    light: [f64; 3],
    least: f64,
    variant: Variant,
) -> Rgb8 {
    let (width, height) = transmittance.size();
    assert!(
        channels.iter().all(|channel| channel.size() == (width, height)),
        "a transmittance for each pixel"
    );
    if variant == Variant::Reference {
        return Rgb8::from_fn(width, height, |x, y| {
            let t = transmittance.pixel(x, y).clamp(least, 1.0);
            std::array::from_fn(|c| exact_code(channels[c].pixel(x, y), light[c], t))
        });
    }
    let mut codes = vec![0; 3 * width * height];
    let channels = channels.each_ref().map(Plane::data);
    vectorized!(dehaze_fast(
        channels,
        transmittance.data(),
        light,
        least,
        &mut codes
    ));
    Rgb8::new(width, height, codes).expect("three codes for each pixel")
}

#[inline(always)]
fn dehaze_fast(channels: [&[u8]; 3], transmittance: &[f64], light: [f64; 3], least: f64, codes: &mut [u8]) {
    let light = light.map(|value| 255.0 * value as f32);
    let least = least as f32;
    let mut t = [1.0f32; BLOCK];
    let mut restored = [[0u8; BLOCK]; 3];
    for (start, codes) in (0..).step_by(BLOCK).zip(codes.chunks_mut(3 * BLOCK)) {
        let end = start + codes.len() / 3;
        for (t, &value) in t.iter_mut().zip(&transmittance[start..end]) {
            *t = smaller(larger(value as f32, least), 1.0);
        }
        for channel in 0..3 {
            let values = channels[channel][start..end].iter().zip(&t);
            for (to, (&code, &t)) in restored[channel].iter_mut().zip(values) {
                *to = single_code(f32::from(code), light[channel], t);
            }
        }
        let (pixels, _) = codes.as_chunks_mut::<3>();
        for (x, pixel) in pixels.iter_mut().enumerate() {
            *pixel = [restored[0][x], restored[1][x], restored[2][x]];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const VEIL: Veil = Veil {
        light: [0.2, 0.4, 0.6],
        attenuation: [0.2, 0.1, 0.0],
        transmittance: (0.1, 0.9),
    };

    #[test]
    fn the_color_of_the_light_stays_what_it_is() {
        let picture = Rgb8::from_fn(3, 1, |_, _| [51, 102, 153]);
        let distance = Plane::new(3, 1, vec![0.0, 5.0, 100.0]).unwrap();
        for variant in [Variant::Fast, Variant::Reference] {
            assert_eq!(restore(&picture, &distance, &VEIL, variant), picture);
        }
    }

    #[test]
    fn a_tenth_of_the_light_is_the_least_that_is_divided_by() {
        let picture = Rgb8::from_fn(1, 1, |_, _| [56, 102, 144]);
        let distance = Plane::new(1, 1, vec![1e9]).unwrap();
        for variant in [Variant::Fast, Variant::Reference] {
            // Red: 5 / 0.1 + 51. Blue is not attenuated; its transmittance is clipped to 0.9: 153 - 9 / 0.9.
            assert_eq!(
                restore(&picture, &distance, &VEIL, variant).pixel(0, 0),
                [101, 102, 143]
            );
        }
    }

    #[test]
    fn one_transmittance_serves_all_channels() {
        let picture = Rgb8::from_fn(3, 1, |_, _| [56, 102, 144]);
        let transmittance = Plane::new(3, 1, vec![-1.0, 0.5, 2.0]).unwrap();
        for variant in [Variant::Fast, Variant::Reference] {
            let restored = dehaze(&picture.to_planes(), &transmittance, VEIL.light, 0.1, variant);
            // 5 / 0.1 + 51 and 153 - 9 / 0.1; then halves; then clipped to 1.
            assert_eq!(restored.data(), &[101, 102, 63, 61, 102, 135, 56, 102, 144]);
        }
    }
}
