//! ContentPicture pictures generated on the fly: examples of frames for a network to repaint.
//!
//! Two of three are procedural scenes, the others simple shapes in any color, so that no palette is preferred. Random
//! effects follow: water computed by `optics`, gamma, gain, a light gradient, noise; some are flat or nearly black.

mod shapes;

use imaging::geometry::Intrinsics;
use imaging::random::Stream;
use imaging::{Plane, transfer};
use optics::chain;
use optics::medium::Medium;
use optics::water::Water;
use spec::{ForwardScatter, HoleRule, Optics, ScatterModel};

use crate::loss::normals;
use crate::tensor::Tensor;
pub use shapes::SIDE;
use shapes::{Air, ContentChance};

/// The content pictures of a seed.
#[derive(Debug, Clone, Copy)]
pub struct ContentPictures {
    seed: u64,
    stream: Stream,
}

/// A content picture.
#[derive(Debug, Clone, PartialEq)]
pub struct ContentPicture {
    /// Three channels of [`SIDE`]², sRGB-encoded, 0..=1.
    pub picture: Tensor<f32>,
    /// The range of each pixel as network input: 0 at the camera, 1 far away.
    pub range: Tensor<f32>,
}

impl ContentPicture {
    /// A square crop, mirrored or not.
    pub(crate) fn cropped(&self, at: (usize, usize), side: usize, mirrored: bool) -> Self {
        Self {
            picture: self.picture.cropped(at, side, mirrored),
            range: self.range.cropped(at, side, mirrored),
        }
    }
}

/// Converts ranges in meters to network input.
fn given(range: Vec<f32>) -> Tensor<f32> {
    let range = Plane::new(SIDE, SIDE, range).expect("one sample for each pixel");
    Tensor {
        channels: 1,
        height: SIDE,
        width: SIDE,
        data: optics::attenuation::faded(&range, style::RANGE_SCALE_M).into_data(),
    }
}

impl ContentPictures {
    /// Pictures for a purpose. Those of training and of validation are disjoint.
    #[must_use]
    pub fn new(seed: u64, purpose: &str) -> Self {
        Self {
            seed,
            stream: Stream::stage(seed, purpose),
        }
    }

    /// The picture of an index: three channels of [`SIDE`]², sRGB-encoded, 0..=1.
    #[must_use]
    pub fn picture(&self, index: u64) -> Tensor<f32> {
        self.content(index).picture
    }

    /// The picture of an index with its range.
    #[must_use]
    pub fn content(&self, index: u64) -> ContentPicture {
        let chance = ContentChance {
            stream: self.stream,
            index,
        };
        let flat = chance.unit("flat");
        if flat < 0.04 {
            let mut picture = Tensor::zeros(3, SIDE, SIDE);
            for channel in 0..3 {
                let value = chance.uniform("flat color", channel, 0.0, 1.0);
                picture.plane_mut(channel as usize).fill(value as f32);
            }
            let range = chance.uniform("flat range", 0, 0.3, FAR_M) as f32;
            let range = vec![range; SIDE * SIDE];
            return ContentPicture {
                picture,
                range: given(range),
            };
        }
        let air = if index % 3 == 2 {
            shapes::draw(&chance)
        } else {
            self.scene(&chance)
        };
        let gain = if flat < 0.06 {
            0.02
        } else {
            chance.uniform("gain", 0, 0.5, 1.2)
        };
        let light = if chance.unit("water") < 0.4 {
            submerged(&air, &chance)
        } else {
            air.light
        };
        ContentPicture {
            picture: finish(light, gain, &chance),
            range: given(air.range),
        }
    }

    fn scene(&self, chance: &ContentChance) -> Air {
        let seed = self.stream.bits(chance.index, 1) ^ self.seed;
        let lens = Intrinsics::centered(SIDE as f64 * chance.uniform("focal", 0, 0.5, 1.1), SIDE, SIDE);
        let scene = scenes::procedural("structure", seed, SIDE, SIDE, lens).expect("a family that is there");
        Air {
            light: Tensor::from(&scene.radiance),
            range: scene.range.map(Plane::into_data).unwrap_or_default(),
        }
    }
}

/// Largest standard deviation of the noise: that of a good camera under water. A deterministic network can neither
/// remove nor add noise, so more would only be a floor under the distance from the style.
const MAX_NOISE: f64 = 0.01;
/// Pictures are rounded to 16 bits, which removes the CPU-dependent last bits of a transform.
const CODES: f32 = 65_535.0;
/// Range of open water, in meters.
const FAR_M: f64 = 40.0;

/// The picture in a random water, half of the time one with forward scatter. In f64: the f32 transform has other bits
/// on another CPU.
fn submerged(air: &Air, chance: &ContentChance) -> Tensor<f32> {
    let strength = chance.uniform("strength", 0, 0.03, 0.5);
    let attenuation = [0, 1, 2].map(|channel| strength * chance.uniform("attenuation", channel, 0.3, 1.7));
    // A single kernel for the picture needs a single transform.
    let forward_scatter = (chance.unit("blur") < 0.5).then(|| ForwardScatter {
        spread_px_per_m: Some([0.0; 3]),
        spread_offset_px: Some([chance.uniform("sigma", 0, 0.3, 1.7); 3]),
        ..ScatterModel::Simplified.into()
    });
    let mut medium = Medium::from(Optics {
        beam_attenuation_per_m: Some(attenuation),
        veiling_light: Some([0, 1, 2].map(|channel| chance.uniform("veil", channel, 0.0, 0.5))),
        forward_scatter,
        ..Optics::default()
    });
    medium.holes = HoleRule::RangeM(FAR_M);
    let water = Water::resolve(&medium, 1.0).expect("a water with all its numbers");
    let radiance = air.light.to_rgb().map(|&light| f64::from(light));
    let range = air.range.iter().map(|&range| f64::from(range)).collect();
    let range = Plane::new(SIDE, SIDE, range).expect("one sample for each pixel");
    let layers = chain::water_reference(&radiance, &range, &water).expect("a picture of this size");
    Tensor::from(&layers.scattered.map(|&light| light as f32))
}

/// Applies gain and a light gradient, encoding, gamma, noise.
fn finish(light: Tensor<f32>, gain: f64, chance: &ContentChance) -> Tensor<f32> {
    let gamma = chance.uniform("gamma", 0, 0.75, 1.35);
    let slope = [0, 1].map(|axis| chance.uniform("slope", axis, -0.5, 0.5));
    let sigma = chance.uniform("noise", 0, 0.0, MAX_NOISE) as f32;
    let stream = Stream::stage(chance.stream.bits(chance.index, 2), "content noise");
    let mut noise = normals(&stream, chance.index);
    let mut out = light;
    for channel in 0..3 {
        for y in 0..SIDE {
            for (x, value) in out.row_mut(channel, y).iter_mut().enumerate() {
                let [u, v] = [x, y].map(|position| position as f64 / SIDE as f64 - 0.5);
                let lit = gain * (1.0 + slope[0] * u + slope[1] * v);
                let encoded = transfer::encode((f64::from(*value) * lit).clamp(0.0, 1.0));
                let noise = sigma * noise.next().unwrap_or_default() as f32;
                let shown = (libm::pow(encoded, gamma) as f32 + noise).clamp(0.0, 1.0);
                *value = (shown * CODES).round() / CODES;
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pictures_depend_on_index_seed_and_purpose_and_nothing_else() {
        let draw = |seed, purpose: &str, index| ContentPictures::new(seed, purpose).picture(index);
        for index in [0, 2] {
            let picture = draw(7, "a", index);
            assert_eq!(draw(7, "a", index), picture);
            for other in [draw(8, "a", index), draw(7, "b", index), draw(7, "a", index + 3)] {
                assert!(other != picture);
            }
        }
    }

    #[test]
    fn pictures_are_encoded_and_most_are_not_flat() {
        let contents = ContentPictures::new(1, "test");
        let mut lively = 0;
        for index in 0..40 {
            let picture = contents.picture(index);
            assert!(picture.data.iter().all(|value| (0.0..=1.0).contains(value)));
            let (low, high) = picture
                .data
                .iter()
                .fold((1.0f32, 0.0f32), |(low, high), &v| (low.min(v), high.max(v)));
            lively += usize::from(high - low > 0.3);
        }
        assert!(lively > 25, "{lively} of 40");
    }
}
