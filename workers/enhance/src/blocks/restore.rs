//! Inverts the simplified image model: `J_c = (c - B_c) / t_c + B_c` with the transmittance `t_c = exp(-β_c D)`.

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
            let restored = (f64::from(*code) / 255.0 - light) / t + light;
            *code = (255.0 * restored + 0.5).floor().clamp(0.0, 255.0) as u8;
        }
    }
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
                let value = (values[x] - light[channel]) / t + light[channel] + 0.5;
                let value = if value > 0.0 { value } else { 0.0 };
                let value = if value < 255.0 { value } else { 255.0 };
                restored[x] = value as i32 as u8;
            }
            for (pixel, &code) in codes.chunks_exact_mut(3).zip(&restored) {
                pixel[channel] = code;
            }
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
}
