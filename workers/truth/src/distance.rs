//! Distance of a picture from the truth in three numbers, over all channels.

use imaging::{Rgb, transfer};
use serde::Serialize;

use crate::estimate::{Estimate, LightPart, PixelBlocks};

/// The error e = model − truth of the means of blocks, over all blocks and channels.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Distance {
    /// Mean of e over the mean of the truth.
    pub bias: f64,
    /// Root of the mean of e², less the variance of the truth's noise, over the mean of the truth; 0 if the noise hides it.
    pub rms: f64,
    /// Mean absolute difference of the exposed and encoded means of blocks, 8-bit codes, not rounded.
    pub codes: f64,
    /// Root mean square of the standard errors of the truth's blocks, over the mean of the truth.
    pub noise: f64,
}

impl Distance {
    /// Compares linear light with the truth of the same frame. Blocks have `side` pixels on a side. Codes are those of the light times
    /// `gain`, the exposure; light beyond white counts as white. All numbers are 0 if the truth is dark.
    #[must_use]
    pub fn new(model: &Rgb<f32>, truth: &Estimate, side: usize, gain: f64) -> Self {
        let blocks = PixelBlocks {
            size: truth.size,
            side,
        };
        let mut sums = Sums::default();
        for block in blocks.pixels() {
            for (channel, plane) in model.planes().iter().enumerate() {
                let level = truth.mean(&block, channel, LightPart::All);
                let light = block.iter().map(|&i| f64::from(plane.data()[i])).sum::<f64>();
                let light = light / block.len() as f64;
                let pixels = block.len() as f64;
                let error = light - level.mean;
                sums.pixels += pixels;
                sums.truth += pixels * level.mean;
                sums.error += pixels * error;
                sums.square += pixels * error * error;
                sums.noise += pixels * level.error * level.error;
                sums.codes += pixels * (encode(gain * light) - encode(gain * level.mean)).abs();
            }
        }
        sums.finish()
    }
}

/// Sums over blocks and channels, weighted by their pixels.
#[derive(Debug, Clone, Copy, Default)]
struct Sums {
    pixels: f64,
    truth: f64,
    error: f64,
    square: f64,
    noise: f64,
    codes: f64,
}

impl Sums {
    fn finish(self) -> Distance {
        if self.truth <= 0.0 {
            return Distance::default();
        }
        let mean = self.truth / self.pixels;
        let [square, noise] = [self.square, self.noise].map(|sum| sum / self.pixels);
        Distance {
            bias: self.error / self.truth,
            rms: (square - noise).max(0.0).sqrt() / mean,
            codes: self.codes / self.pixels,
            noise: noise.sqrt() / mean,
        }
    }
}

/// The code of light between 0 and 255, not rounded.
fn encode(light: f64) -> f64 {
    255.0 * transfer::encode(light.clamp(0.0, 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimate::{BATCHES, PixelSums};
    use crate::walk::PathTally;

    const SIZE: (usize, usize) = (4, 2);

    /// A truth of two blocks, 1 in all channels, whose batches alternate between 1 ± `scatter`.
    fn truth(scatter: f64) -> Estimate {
        let mut pixel = PixelSums::NOTHING;
        for sample in 0..BATCHES as u64 {
            let light = 1.0 + if sample % 2 == 0 { scatter } else { -scatter };
            let orders = [[light; 3], [0.0; 3], [0.0; 3]];
            let is_cut = false;
            pixel.add([0, 1, 2], sample, PathTally { orders, is_cut });
        }
        Estimate {
            size: SIZE,
            paths: BATCHES as u64,
            pixels: vec![pixel; SIZE.0 * SIZE.1],
        }
    }

    fn model(left: f32, right: f32) -> Rgb<f32> {
        Rgb::from_fn(SIZE.0, SIZE.1, |x, _| [if x < 2 { left } else { right }; 3])
    }

    #[test]
    fn bias_and_rms_are_those_of_two_blocks() {
        let distance = Distance::new(&model(1.3, 0.9), &truth(0.0), 2, 1.0);
        assert!((distance.bias - 0.1).abs() < 1e-6, "{distance:?}");
        assert!((distance.rms - 0.05_f64.sqrt()).abs() < 1e-6, "{distance:?}");
        assert_eq!(distance.noise, 0.0);
    }

    #[test]
    fn codes_are_those_after_the_exposure_up_to_white() {
        let distance = Distance::new(&model(1.3, 0.5), &truth(0.0), 2, 0.5);
        let codes = |light: f64| 255.0 * transfer::encode(light);
        let expected = ((codes(0.65) - codes(0.5)) + (codes(0.5) - codes(0.25))) / 2.0;
        assert!((distance.codes - expected).abs() < 1e-4, "{distance:?}");
        assert!(Distance::new(&model(1.3, 2.0), &truth(0.0), 2, 1.0).codes == 0.0);
    }

    #[test]
    fn the_noise_of_the_truth_is_no_distance() {
        let distance = Distance::new(&model(1.0, 1.0), &truth(0.2), 2, 1.0);
        assert!(distance.noise > 0.01 && distance.rms == 0.0, "{distance:?}");
        let far = Distance::new(&model(2.0, 2.0), &truth(0.2), 2, 1.0);
        assert!(
            (far.rms - (1.0 - far.noise * far.noise).sqrt()).abs() < 1e-6,
            "{far:?}"
        );
    }
}
