//! Training, step by step. The numbers depend on photos, seed and step count alone, not on how many threads work.

use imaging::random::Stream;
use rayon::prelude::*;
use style::net::layer::{BLOCKS, COLOR, LAYERS, OUTPUT, PIXEL, Weights};

use crate::content::{Contents, SIDE};
use crate::loss::pyramid::Pyramid;
use crate::loss::{Losses, losses};
use crate::network::{backward, forward};
use crate::optimizer::Adam;
use crate::photo::Photo;
use crate::tensor::Tensor;
use crate::transfer::{ColorStats, transfer};

/// Pictures of a batch: many small ones, since the style's colors must be found over all of them together, and a batch
/// of few is too far from the whole.
const BATCH: usize = 48;
/// Side of a crop in pixels: at the coarsest level it is one patch.
const CROP: usize = 56;
/// Content pictures of each brightness; a step takes one of them.
const CHOICE: usize = 8;
/// Content pictures of a training: many, since the color transfer that it starts from is only as good as they are like
/// those that will come.
const POOL: usize = BATCH * CHOICE;
/// Bias that the features of a pixel begin with.
const PIXEL_BIAS: f32 = 0.25;
/// Steps over which losses are averaged to tell the best weights.
const WINDOW: usize = 50;

/// A training under way.
pub struct Trainer {
    style: Vec<Pyramid<f32>>,
    /// Content pictures from dark to bright.
    pool: Vec<Tensor<f32>>,
    stream: Stream,
    start: Weights,
    weights: Weights,
    optimizer: Adam,
    steps: usize,
    window: Vec<Losses>,
    best: Option<Best>,
}

/// Weights with the lowest loss so far.
#[derive(Debug, Clone)]
pub struct Best {
    /// The weights.
    pub weights: Weights,
    /// After how many steps.
    pub step: usize,
    /// Mean losses of the steps that led to them.
    pub losses: Losses,
}

impl Trainer {
    /// Prepares to learn one water from one or more photos of it: measures colors, and starts from the closed-form
    /// color transfer.
    ///
    /// # Panics
    /// Without a photo.
    #[must_use]
    pub fn new(photos: &[Photo], seed: u64, steps: usize) -> Self {
        assert!(!photos.is_empty(), "there is a photo to learn from");
        let style: Vec<_> = photos.iter().map(|photo| photo.pyramid.clone()).collect();
        let contents = Contents::new(seed, "training content");
        let mut pool: Vec<Tensor<f32>> = (0..POOL as u64)
            .into_par_iter()
            .map(|index| contents.picture(index))
            .collect();
        let content = ColorStats::measure(pool.iter());
        // Floats that are not negative are ordered as their bits are.
        pool.sort_by_cached_key(|picture| {
            picture
                .data
                .iter()
                .map(|&value| f64::from(value))
                .sum::<f64>()
                .to_bits()
        });
        let target = ColorStats::measure(style.iter().map(|pyramid| &pyramid.levels[0]));
        let stream = Stream::stage(seed, "training");
        let (map, offset) = transfer(&content, &target);
        let mut start = Weights::zeros();
        let (weight, bias) = start.layer_mut(COLOR);
        for (weight, &value) in weight.iter_mut().zip(map.as_flattened()) {
            *weight = value as f32;
        }
        for (bias, &value) in bias.iter_mut().zip(&offset) {
            *bias = value as f32;
        }
        Self {
            style,
            pool,
            stream,
            weights: randomized(&start, &stream),
            start,
            optimizer: Adam::new(),
            steps,
            window: Vec::new(),
            best: None,
        }
    }

    /// The color transfer alone, as a network.
    #[must_use]
    pub fn color_transfer(&self) -> &Weights {
        &self.start
    }

    /// Whether all steps are done.
    #[must_use]
    pub fn is_done(&self) -> bool {
        self.optimizer.done() >= self.steps
    }

    /// One step, and the losses before it.
    pub fn step(&mut self) -> Losses {
        let step = self.optimizer.done() as u64;
        let crops: Vec<Tensor<f32>> = (0..BATCH)
            .into_par_iter()
            .map(|place| self.crop(step, place))
            .collect();
        let traces: Vec<_> = crops
            .par_iter()
            .map(|crop| forward(&self.weights, crop))
            .collect();
        let results = traces.iter().map(|trace| trace.styled.clone()).collect();
        let contents: Vec<_> = crops.into_par_iter().map(Pyramid::new).collect();
        let (losses, gradients) = losses(&contents, results, &self.style, &self.stream, step);
        let parts: Vec<Weights> = traces
            .par_iter()
            .zip(&gradients)
            .map(|(trace, gradient)| backward(&self.weights, trace, gradient))
            .collect();
        // In the order of the pictures, whichever was ready first.
        let mut gradient = Weights::zeros();
        for part in &parts {
            for (sum, value) in gradient.values_mut().iter_mut().zip(part.values()) {
                *sum += value;
            }
        }
        self.optimizer.step(&mut self.weights, gradient, self.steps);
        self.remember(losses);
        losses
    }

    /// The weights with the lowest loss so far; before the end of the first step those of the color transfer.
    #[must_use]
    pub fn best(&self) -> Best {
        self.best.clone().unwrap_or_else(|| Best {
            weights: self.start.clone(),
            step: 0,
            losses: Losses::default(),
        })
    }

    /// Keeps the weights at the end of each window of steps, if the window was the best.
    fn remember(&mut self, losses: Losses) {
        self.window.push(losses);
        if self.window.len() < WINDOW && !self.is_done() {
            return;
        }
        let losses = Losses::mean(&self.window);
        self.window.clear();
        if self
            .best
            .as_ref()
            .is_none_or(|best| losses.total() < best.losses.total())
        {
            self.best = Some(Best {
                weights: self.weights.clone(),
                step: self.optimizer.done(),
                losses,
            });
        }
    }

    /// A crop of a picture of the brightness that belongs to a place of the batch. So each batch has about the colors of
    /// all pictures, as if it were several times as large.
    fn crop(&self, step: u64, place: usize) -> Tensor<f32> {
        let draw = |purpose: u64| self.stream.unit(1 << 40 | step, place as u64 * 4 + purpose);
        let picture = &self.pool[place * CHOICE + (draw(3) * CHOICE as f64) as usize];
        let offset = |purpose| (draw(purpose) * (SIDE - CROP + 1) as f64) as usize;
        cropped(picture, (offset(0), offset(1)), CROP, draw(2) < 0.5)
    }
}

/// A square crop, mirrored or not.
pub(crate) fn cropped(
    picture: &Tensor<f32>,
    (left, top): (usize, usize),
    side: usize,
    mirrored: bool,
) -> Tensor<f32> {
    let mut crop = Tensor::zeros(3, side, side);
    for channel in 0..3 {
        for y in 0..side {
            let row = crop.row_mut(channel, y);
            row.copy_from_slice(&picture.row(channel, top + y)[left..left + side]);
            if mirrored {
                row.reverse();
            }
        }
    }
    crop
}

/// Uniform in ±1/sqrt(fan-in), smaller at the ends of the residual branches, beside the color map of the start.
fn randomized(start: &Weights, stream: &Stream) -> Weights {
    let mut weights = start.clone();
    for (index, layer) in LAYERS.into_iter().enumerate() {
        if layer == COLOR {
            continue;
        }
        let reach = 1.0 / (layer.fan_in() as f64).sqrt();
        let is_tail = BLOCKS.iter().any(|block| block[3] == layer);
        let factor = match layer {
            OUTPUT => 0.1,
            _ if is_tail => 0.2,
            _ => 1.0,
        };
        let draw = |at: usize| (2.0 * stream.unit(2 << 40 | index as u64, at as u64) - 1.0) * reach;
        let (weight, bias) = weights.layer_mut(layer);
        for (at, weight) in weight.iter_mut().enumerate() {
            *weight = (draw(at) * factor) as f32;
        }
        for (at, bias) in bias.iter_mut().enumerate() {
            *bias = match layer {
                OUTPUT => 0.0,
                // Features begin alive: the context can push all of them below the ReLU for good.
                PIXEL => PIXEL_BIAS,
                _ => draw(1 << 20 | at) as f32,
            };
        }
    }
    weights
}
