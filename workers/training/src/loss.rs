//! The training loss: `4 texture + 15 color + 6.4 content + 20 outside`.
//!
//! For a network with a range, texture and color are compared within bands of range: near parts of the results with
//! near parts of the photos, and far with far. Contrast must therefore fall with the range as in the photos. ContentPicture
//! counts less with range.

mod content;
mod draw;
pub mod pyramid;
mod sliced;
mod slices;
mod weights;

use imaging::random::Stream;
use rayon::prelude::*;

pub(crate) use draw::normals;
use pyramid::Pyramid;
use sliced::sliced;

use crate::real::Real;
use crate::tensor::Tensor;
pub use weights::Ranges;
use weights::{COLOR, CONTENT, TEXTURE};

const OUTSIDE: f64 = 20.0;

/// The terms of the loss.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Losses {
    /// Texture distance from the style.
    pub texture: f64,
    /// Color distance from the style.
    pub color: f64,
    /// Lost share of the content, 0..=2.
    pub content: f64,
    /// Mean excess below 0 or above 1.
    pub outside: f64,
}

impl Losses {
    /// The weighted sum.
    #[must_use]
    pub fn total(&self) -> f64 {
        TEXTURE * self.texture + COLOR * self.color + CONTENT * self.content + OUTSIDE * self.outside
    }

    /// The mean of several losses.
    #[must_use]
    pub fn mean(losses: &[Self]) -> Self {
        let count = losses.len().max(1) as f64;
        Self {
            texture: losses.iter().map(|l| l.texture).sum::<f64>() / count,
            color: losses.iter().map(|l| l.color).sum::<f64>() / count,
            content: losses.iter().map(|l| l.content).sum::<f64>() / count,
            outside: losses.iter().map(|l| l.outside).sum::<f64>() / count,
        }
    }
}

/// The losses of a batch and the gradient for each of its results before clamping. With ranges, texture and color are
/// compared within bands of range.
#[must_use]
pub fn losses<T: Real>(
    contents: &[Pyramid<T>],
    results: Vec<Tensor<T>>,
    style: &[Pyramid<T>],
    ranges: Option<Ranges<'_, T>>,
    stream: &Stream,
    step: u64,
) -> (Losses, Vec<Tensor<T>>) {
    let results: Vec<Pyramid<T>> = results.into_par_iter().map(Pyramid::new).collect();
    let found = sliced(&results, style, ranges, stream, step);
    let mut gradients = found.gradients;
    let content = content::content(
        contents,
        &results,
        ranges.map(|ranges| ranges.contents),
        &mut gradients,
    );
    let samples: usize = results.iter().map(|result| result.levels[0].data.len()).sum();
    let slope = T::from_f64(OUTSIDE / samples as f64);
    let (zero, one) = (T::default(), T::from_f64(1.0));
    let mut outside = 0.0;
    for (gradient, result) in gradients.iter_mut().zip(&results) {
        let pairs = gradient.levels[0].data.iter_mut().zip(&result.levels[0].data);
        for (gradient, &value) in pairs {
            if value < zero {
                outside -= value.to_f64();
                *gradient += -slope;
            } else if value > one {
                outside += value.to_f64() - 1.0;
                *gradient += slope;
            }
        }
    }
    let losses = Losses {
        texture: found.texture,
        color: found.color,
        content,
        outside: outside / samples as f64,
    };
    (losses, gradients.into_par_iter().map(Pyramid::collapse).collect())
}
