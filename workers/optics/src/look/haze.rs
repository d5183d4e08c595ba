//! Haze from lights: the paper's Gaussian overlay (Algorithm 1, with the lights laid one over the other).
//!
//! `α_l(x) = k exp(−|x − p|² / 2σ²)`, distances in image heights; `over`: `I ← I (1 − α_l) + color α_l` in list order;
//! `add`: `I ← I + color α_l`. It is an overlay, not physics: it knows neither range nor water.

use imaging::{Rgb, transfer};
use spec::{Haze, HazeBlend, HazeSpace};

/// Lays every light over a linear picture, in the space of the first: it is the same for all.
#[must_use]
pub fn haze(image: Rgb<f32>, lights: &[Haze]) -> Rgb<f32> {
    let mut shining = lights.iter().filter(|light| light.shines()).peekable();
    let Some(first) = shining.peek() else {
        return image;
    };
    match first.space {
        HazeSpace::Linear => shining.fold(image, lay),
        HazeSpace::Display => {
            let encoded = shining.fold(transfer::encode_unit(&image), lay);
            transfer::decode_unit(&encoded.map(|v| v.clamp(0.0, 1.0)))
        }
    }
}

/// Weaker light does not change an f32 of ordinary brightness.
const NOTHING: f64 = 1e-9;

fn lay(mut image: Rgb<f32>, light: &Haze) -> Rgb<f32> {
    let (width, height) = image.size();
    let falloff = |distance: f64| (-distance * distance / (2.0 * light.size * light.size)).exp();
    let aspect = width as f64 / height as f64;
    let strength = light.intensity.min(1.0);
    // The Gaussian is a product of one along the row and one along the column.
    let across: Vec<f64> = (0..width)
        .map(|x| falloff(((x as f64 + 0.5) / width as f64 - light.x) * aspect))
        .collect();
    let down: Vec<f64> = (0..height)
        .map(|y| strength * falloff((y as f64 + 0.5) / height as f64 - light.y))
        .collect();
    let (Some(left), Some(right)) = (
        across.iter().position(|&a| a > NOTHING),
        across.iter().rposition(|&a| a > NOTHING),
    ) else {
        return image;
    };
    let across: Vec<f32> = across[left..=right].iter().map(|&a| a as f32).collect();
    for (plane, color) in image.planes_mut().into_iter().zip(light.color) {
        for (row, &strength) in plane
            .chunks_exact_mut(width)
            .zip(&down)
            .filter(|(_, s)| **s > NOTHING)
        {
            let row = &mut row[left..=right];
            match light.blend {
                HazeBlend::Over => cover(row, &across, strength as f32, color as f32),
                HazeBlend::Add => add(row, &across, strength as f32, color as f32),
            }
        }
    }
    image
}

fn cover(row: &mut [f32], across: &[f32], strength: f32, color: f32) {
    for (sample, across) in row.iter_mut().zip(across) {
        let alpha = strength * across;
        *sample = *sample * (1.0 - alpha) + color * alpha;
    }
}

fn add(row: &mut [f32], across: &[f32], strength: f32, color: f32) {
    for (sample, across) in row.iter_mut().zip(across) {
        *sample += color * (strength * across);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn light(x: f64, color: [f64; 3], blend: HazeBlend) -> Haze {
        Haze {
            x,
            y: 0.5,
            size: 0.3,
            intensity: 1.0,
            color,
            blend,
            space: HazeSpace::Linear,
        }
    }

    #[test]
    fn the_middle_of_a_full_light_has_its_color() {
        let image = Rgb::from_fn(1, 1, |_, _| [0.1f32; 3]);
        let lit = haze(image, &[light(0.5, [1.0, 0.5, 2.0], HazeBlend::Over)]);
        assert_eq!(lit.pixel(0, 0), [1.0, 0.5, 2.0]);
    }

    #[test]
    fn over_depends_on_the_order_and_add_does_not() {
        let image = Rgb::from_fn(4, 4, |_, _| [0.2f32; 3]);
        for (blend, commutes) in [(HazeBlend::Over, false), (HazeBlend::Add, true)] {
            let (a, b) = (
                light(0.4, [1.0, 0.0, 0.0], blend),
                light(0.6, [0.0, 1.0, 0.0], blend),
            );
            let ordered = haze(image.clone(), &[a, b]);
            let reversed = haze(image.clone(), &[b, a]);
            let worst = ordered
                .pixel(1, 1)
                .iter()
                .zip(reversed.pixel(1, 1))
                .map(|(a, b)| (a - b).abs())
                .fold(0.0, f32::max);
            assert_eq!(worst < 1e-6, commutes, "{blend:?}: {worst}");
        }
    }

    #[test]
    fn a_light_without_size_or_strength_changes_nothing() {
        let image = Rgb::from_fn(3, 2, |x, _| [1.5 * x as f32; 3]);
        for (size, intensity) in [
            (0.0, 1.0),
            (-1.0, 1.0),
            (f64::NAN, 1.0),
            (0.2, 0.0),
            (0.2, f64::NAN),
        ] {
            let dark = Haze {
                size,
                intensity,
                space: HazeSpace::Display,
                ..light(0.5, [1.0; 3], HazeBlend::Over)
            };
            assert_eq!(haze(image.clone(), &[dark]), image);
        }
    }
}
