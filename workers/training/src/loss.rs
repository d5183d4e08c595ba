//! What training lowers: `4 texture + 15 color + 6.4 content + 20 range`.

mod content;
mod draw;
pub mod pyramid;
mod sliced;
mod slices;

use imaging::random::Stream;
use rayon::prelude::*;

pub(crate) use draw::normals;
use pyramid::Pyramid;
use sliced::sliced;

use crate::real::Real;
use crate::tensor::Tensor;

/// Weights of the parts.
const TEXTURE: f64 = 4.0;
const COLOR: f64 = 15.0;
const CONTENT: f64 = 6.4;
const RANGE: f64 = 20.0;

/// The parts of the loss.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Losses {
    /// Distance of the texture from the style's.
    pub texture: f64,
    /// Distance of the colors from the style's.
    pub color: f64,
    /// Share of the content that is lost, 0..=2.
    pub content: f64,
    /// Mean of what lies below 0 or above 1.
    pub range: f64,
}

impl Losses {
    /// What training lowers.
    #[must_use]
    pub fn total(&self) -> f64 {
        TEXTURE * self.texture + COLOR * self.color + CONTENT * self.content + RANGE * self.range
    }

    /// The mean of several.
    #[must_use]
    pub fn mean(of: &[Self]) -> Self {
        let mean = |part: fn(&Self) -> f64| of.iter().map(part).sum::<f64>() / of.len().max(1) as f64;
        Self {
            texture: mean(|l| l.texture),
            color: mean(|l| l.color),
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
    let found = sliced(&results, style, stream, step);
    let mut gradients = found.gradients;
    let content = content::content(contents, &results, &mut gradients);
    let samples: usize = results.iter().map(|result| result.levels[0].data.len()).sum();
    let slope = T::from_f64(RANGE / samples as f64);
    let (zero, one) = (T::default(), T::from_f64(1.0));
    let mut range = 0.0;
    for (gradient, result) in gradients.iter_mut().zip(&results) {
        let pairs = gradient.levels[0].data.iter_mut().zip(&result.levels[0].data);
        for (gradient, &value) in pairs {
            if value < zero {
                range -= value.to_f64();
                *gradient += -slope;
            } else if value > one {
                range += value.to_f64() - 1.0;
                *gradient += slope;
            }
        }
    }
    let losses = Losses {
        texture: found.texture,
        color: found.color,
        content,
        range: range / samples as f64,
    };
    (losses, gradients.into_par_iter().map(Pyramid::collapse).collect())
}
