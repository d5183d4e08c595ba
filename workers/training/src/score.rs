//! The held-out score: the losses of the network's clamped output on new scenes.

use std::ops::Range;
use std::sync::OnceLock;

use imaging::random::Stream;
use imaging::{Plane, Rgb};
use rayon::prelude::*;
use style::net::layer::{OUTPUT, Weights};
use style::net::{Network, Scratch};

use crate::content::{ContentPicture, ContentPictures};
use crate::loss::pyramid::Pyramid;
use crate::loss::{Losses, Ranges, losses};
use crate::photo::Photo;
use crate::tensor::Tensor;

/// New scenes, the same for every training.
///
/// With sixteen the color distance still varies by half with the choice of scenes.
const SCENES: u64 = 64;
/// Scenes for comparing networks pixel by pixel.
const SHOWN: u64 = 16;
/// Side of a scene in pixels.
const SIDE: usize = 160;
/// Number of patch draws.
const DRAWS: u64 = 3;
const SEED: u64 = 0x5c0e;

/// Performance on new scenes. Lower is better.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Score {
    /// Texture, color and content; see [`Losses`].
    pub losses: Losses,
    /// RMS difference between the network and its color map, of 255.
    pub branch: f64,
}

/// Some of the new scenes as pictures, sRGB-encoded.
#[must_use]
pub fn new_scenes() -> Vec<Rgb<f32>> {
    let shown = held_out().iter().take(SHOWN as usize);
    shown.map(|crop| crop.picture.to_rgb()).collect()
}

/// The scenes of [`score`]. A training is scored twice and compared with its table twice; drawing them again would take a
/// sixth of the time of a short training.
fn held_out() -> &'static [ContentPicture] {
    static SCORED: OnceLock<Vec<ContentPicture>> = OnceLock::new();
    SCORED.get_or_init(|| crops(0..SCENES))
}

fn crops(scenes: Range<u64>) -> Vec<ContentPicture> {
    let contents = ContentPictures::new(SEED, "held-out content");
    scenes
        .into_par_iter()
        .map(|index| contents.content(index).cropped((16, 16), SIDE, false))
        .collect()
}

/// Scores a network against photos.
#[must_use]
pub fn score(weights: &Weights, photos: &[Photo]) -> Score {
    score_of(weights, photos, held_out(), DRAWS)
}

/// The score over other scenes and any number of patch draws, to measure its variation.
#[must_use]
pub fn score_over(weights: &Weights, photos: &[Photo], scenes: Range<u64>, draws: u64) -> Score {
    score_of(weights, photos, &crops(scenes), draws)
}

fn score_of(weights: &Weights, photos: &[Photo], crops: &[ContentPicture], draws: u64) -> Score {
    let mut plain = weights.clone();
    let (weight, bias) = plain.layer_mut(OUTPUT);
    weight.fill(0.0);
    bias.fill(0.0);
    let [results, toned] = [weights, &plain].map(|weights| {
        let network = Network::new(weights);
        let results: Vec<Tensor<f32>> = crops.par_iter().map(|crop| repaint(&network, crop)).collect();
        results
    });
    let pairs = results
        .iter()
        .zip(&toned)
        .flat_map(|(a, b)| a.data.iter().zip(&b.data));
    let squares: f64 = pairs.map(|(&a, &b)| f64::from(a - b) * f64::from(a - b)).sum();
    let samples: usize = results.iter().map(|result| result.data.len()).sum();
    let (before, near): (Vec<_>, Vec<_>) = crops
        .iter()
        .map(|crop| {
            (
                Pyramid::new(crop.picture.clone()),
                Pyramid::new(crop.range.clone()),
            )
        })
        .unzip();
    let (style, far): (Vec<_>, Vec<_>) = photos
        .iter()
        .map(|photo| (photo.pyramid.clone(), photo.range.clone()))
        .unzip();
    let ranges = weights.takes_range().then_some(Ranges {
        contents: &near,
        style: &far,
    });
    let stream = Stream::stage(SEED, "held-out draws");
    let all: Vec<Losses> = (0..draws)
        .map(|draw| losses(&before, results.clone(), &style, ranges, &stream, draw).0)
        .collect();
    Score {
        losses: Losses::mean(&all),
        branch: 255.0 * (squares / samples as f64).sqrt(),
    }
}

fn repaint(network: &Network, crop: &ContentPicture) -> Tensor<f32> {
    let range = Plane::new(SIDE, SIDE, crop.range.data.clone()).expect("a range for each pixel");
    let picture = crop.picture.to_rgb();
    Tensor::from(&network.apply(&picture, Some(&range), &mut Scratch::default()))
}
