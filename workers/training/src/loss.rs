//! What training lowers: `4 texture + 15 colour + 6.4 content + 20 range`.

mod content;
mod draw;
pub mod pyramid;
mod sliced;
mod slices;

use imaging::random::Stream;
use rayon::prelude::*;

pub(crate) use draw::normals;
use pyramid::Pyramid;
use sliced::{Shares, sliced};

use crate::real::Real;
use crate::tensor::Tensor;

/// Weights of the parts.
const TEXTURE: f64 = 4.0;
const COLOUR: f64 = 15.0;
const CONTENT: f64 = 6.4;
const RANGE: f64 = 20.0;

/// The parts of the loss.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Losses {
    /// Distance of the texture from the style's.
    pub texture: f64,
    /// Distance of the colours from the style's.
    pub colour: f64,
    /// Share of the content that is lost, 0..=2.
    pub content: f64,
    /// Mean of what lies below 0 or above 1.
    pub range: f64,
}

impl Losses {
    /// What training lowers.
    #[must_use]
    pub fn total(&self) -> f64 {
        TEXTURE * self.texture + COLOUR * self.colour + CONTENT * self.content + RANGE * self.range
    }

    /// The mean of several.
    #[must_use]
    pub fn mean(of: &[Self]) -> Self {
        let mean = |part: fn(&Self) -> f64| of.iter().map(part).sum::<f64>() / of.len().max(1) as f64;
        Self {
            texture: mean(|l| l.texture),
            colour: mean(|l| l.colour),
            content: mean(|l| l.content),
            range: mean(|l| l.range),
        }
    }
}

/// The losses of a batch and the gradient for each of its results. The losses see results before they are clamped.
#[must_use]
pub fn losses<T: Real>(
    contents: &[Pyramid<T>],
    results: Vec<Tensor<T>>,
    style: &[Pyramid<T>],
    stream: &Stream,
    step: u64,
) -> (Losses, Vec<Tensor<T>>) {
    let results: Vec<Pyramid<T>> = results.into_par_iter().map(Pyramid::new).collect();
    let shares = Shares {
        texture: TEXTURE,
        colour: COLOUR,
    };
    let found = sliced(&results, style, stream, step, shares);
    let mut gradients = found.gradients;
    let content = content::content(contents, &results, CONTENT, &mut gradients);
    let samples: usize = results.iter().map(|result| result.levels[0].data.len()).sum();
    let slope = T::of(RANGE / samples as f64);
    let (zero, one) = (T::default(), T::of(1.0));
    let mut range = 0.0;
    for (gradient, result) in gradients.iter_mut().zip(&results) {
        let pairs = gradient.levels[0].data.iter_mut().zip(&result.levels[0].data);
        for (gradient, &value) in pairs {
            if value < zero {
                range -= value.wide();
                *gradient += -slope;
            } else if value > one {
                range += value.wide() - 1.0;
                *gradient += slope;
            }
        }
    }
    let losses = Losses {
        texture: found.texture,
        colour: found.colour,
        content,
        range: range / samples as f64,
    };
    (losses, gradients.into_par_iter().map(Pyramid::collapse).collect())
}
