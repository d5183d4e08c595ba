//! The curve from light to codes of n bits: `floor((2^n − 1) v + 1/2)` with `v = curve(clamp(x, 0, 1))`.

use imaging::{Channels, Raster, Rgb, Rgb8, Samples, transfer};
use spec::Tone;

/// Steps of light; at most a few codes begin within one.
const STEPS: usize = 4096;
/// Half step around the end of the linear part of the sRGB curve.
const SRGB_SEAM: f64 = 1e-7;

/// The codes of a picture, and the number of clamped samples.
#[must_use]
pub fn codes(light: &Rgb<f32>, tone: Tone) -> (Rgb8, u64) {
    let exponent = match tone {
        Tone::Srgb => return transfer::encode_rgb8(light),
        Tone::Linear => 1.0,
        Tone::Gamma(gamma) => gamma,
    };
    let table = ToneTable::new(exponent);
    let (width, height) = light.size();
    let [r, g, b] = light.planes().each_ref().map(|plane| plane.data());
    let mut clamped = 0;
    let mut data = Vec::with_capacity(3 * r.len());
    for ((&r, &g), &b) in r.iter().zip(g).zip(b) {
        for v in [r, g, b] {
            clamped += u64::from(!(0.0..=1.0).contains(&v));
            data.push(table.code(v));
        }
    }
    let codes = Rgb8::new(width, height, data).expect("three codes for each pixel");
    (codes, clamped)
}

/// The 16-bit codes of a picture.
#[must_use]
pub fn deep_codes(light: &Rgb<f32>, tone: Tone) -> Raster {
    let (width, height) = light.size();
    let [r, g, b] = light.planes().each_ref().map(|plane| plane.data());
    let mut data = Vec::with_capacity(3 * r.len());
    for ((&r, &g), &b) in r.iter().zip(g).zip(b) {
        data.extend([r, g, b].map(|v| (65_535.0 * curve(f64::from(v), tone) + 0.5).floor() as u16));
    }
    let samples = Samples::U16(data);
    Raster::new(width, height, Channels::Rgb, samples, None).expect("three codes for each pixel")
}

/// The code of a sample by the formula.
#[must_use]
pub fn code_reference(light: f64, tone: Tone) -> u8 {
    (255.0 * curve(light, tone) + 0.5).floor() as u8
}

fn curve(light: f64, tone: Tone) -> f64 {
    let light = light.clamp(0.0, 1.0);
    match tone {
        Tone::Srgb => transfer::encode(light),
        Tone::Linear => light,
        Tone::Gamma(gamma) => libm::pow(light, 1.0 / gamma),
    }
}

/// The largest step of a curve between lights that differ by `error`: at most 1 in the last code.
///
/// Curves that flatten towards white are steepest at black, the others at white.
#[must_use]
pub fn largest_change(error: f64, tone: Tone) -> f64 {
    let error = error.clamp(0.0, 1.0);
    match tone {
        Tone::Srgb => (curve(error, tone) + SRGB_SEAM).min(1.0),
        Tone::Gamma(gamma) if gamma < 1.0 => 1.0 - curve(1.0 - error, tone),
        Tone::Linear | Tone::Gamma(_) => curve(error, tone),
    }
}

/// The light at the start of each code, and the code at the start of each step of light.
struct ToneTable {
    starts: [f64; 256],
    first: Vec<u8>,
}

impl ToneTable {
    /// For the power `1/exponent`.
    fn new(exponent: f64) -> Self {
        let starts = std::array::from_fn(|code| match code {
            0 => 0.0,
            _ => libm::pow((code as f64 - 0.5) / 255.0, exponent),
        });
        let first = (0..=STEPS).map(|step| {
            let light = step as f64 / STEPS as f64;
            (starts.partition_point(|&start| start <= light) - 1) as u8
        });
        Self {
            first: first.collect(),
            starts,
        }
    }

    fn code(&self, light: f32) -> u8 {
        let light = f64::from(light).max(0.0).min(1.0);
        let mut code = self.first[(light * STEPS as f64) as usize];
        while code < u8::MAX && self.starts[usize::from(code) + 1] <= light {
            code += 1;
        }
        code
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_those_of_the_formula() {
        let light = Rgb::from_fn(700, 3, |x, y| {
            [-0.1, 0.0, 0.7].map(|v| v + 0.0016 * (x + 5 * y) as f32)
        });
        for tone in [
            Tone::Srgb,
            Tone::Linear,
            Tone::Gamma(2.2),
            Tone::Gamma(0.5),
            Tone::Gamma(5.0),
        ] {
            let (codes, clamped) = codes(&light, tone);
            assert!(clamped > 0);
            let expected = |(i, code): (usize, &u8)| {
                let light = f64::from(light.planes()[i % 3].data()[i / 3]);
                // Rounding of the power may move the start of a code.
                let [lower, upper] = [-1e-14, 1e-14].map(|by| code_reference(light + by, tone));
                lower <= *code && *code <= upper
            };
            assert!(codes.data().iter().enumerate().all(expected), "{tone:?}");
        }
    }

    #[test]
    fn no_error_of_light_changes_the_curve_by_more_than_its_bound() {
        let tones = [0.2, 0.5, 1.0, 2.2, 5.0].map(Tone::Gamma);
        for tone in tones.into_iter().chain([Tone::Srgb, Tone::Linear]) {
            for error in [0.0, 1e-9, 1e-5, 3e-4, 0.02, 0.7] {
                let bound = largest_change(error, tone);
                let mut largest = 0.0f64;
                let seam = transfer::decode(0.040_45);
                let places = (0..=20_000).map(|i| f64::from(i) / 20_000.0);
                for light in places.chain([seam, seam - error / 2.0, 1.0 - error]) {
                    let change = (curve(light + error, tone) - curve(light, tone)).abs();
                    largest = largest.max(change);
                }
                assert!(
                    largest <= bound + 1e-15,
                    "{tone:?} of {error}: {largest:e} of {bound:e}"
                );
                assert!(
                    largest >= 0.99 * (bound - SRGB_SEAM),
                    "{tone:?} of {error}: {largest:e} of {bound:e}"
                );
            }
        }
    }

    #[test]
    fn deep_codes_are_the_picture_s_own_at_257_times_the_resolution() {
        let light = Rgb::from_fn(701, 2, |x, y| [x as f32 / 700.0, 0.3 * y as f32, 1.2]);
        for tone in [Tone::Srgb, Tone::Linear, Tone::Gamma(2.2)] {
            let deep = deep_codes(&light, tone);
            let (codes, _) = codes(&light, tone);
            let Samples::U16(deep) = deep.samples() else {
                panic!("16 bits were requested")
            };
            // Within half a code of the coarse one.
            let near = |(&deep, &code): (&u16, &u8)| (i32::from(deep) - 257 * i32::from(code)).abs() <= 129;
            assert!(deep.iter().zip(codes.data()).all(near), "{tone:?}");
            assert!(
                deep.windows(7)
                    .any(|some| some[0] != some[3] && some[3] - some[0] < 257),
                "{tone:?}"
            );
        }
    }
}
