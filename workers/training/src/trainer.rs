//! Training, step by step. The result depends on photos, seed and step count only, not on the number of threads.

use imaging::random::Stream;
use rayon::prelude::*;
use style::net::layer::{BLOCKS, COLOR, Layer, OUTPUT, PIXEL, RANGE_COLOR, RANGE_PIXEL, Weights};

use crate::content::{ContentPicture, ContentPictures, SIDE};
use crate::loss::pyramid::Pyramid;
use crate::loss::{Losses, Ranges, losses};
use crate::network::{backward, forward, ranged};
use crate::optimizer::Adam;
use crate::photo::Photo;
use crate::transfer::{ColorStats, RangedTransfer, ranged_transfer, transfer};

/// Pictures of a batch: many small ones, since the style's colors are matched over all of them together, and a small
/// batch is too far from the complete set.
const BATCH: usize = 48;
/// Side of a crop in pixels: at the coarsest level it is one patch.
const CROP: usize = 56;
/// ContentPicture pictures per brightness class; a step uses one of them.
const CHOICE: usize = 8;
/// ContentPicture pictures of a training: many, since the initial color transfer is only as good as their similarity to later
/// frames.
const POOL: usize = BATCH * CHOICE;
/// Initial bias of the pixel features.
const PIXEL_BIAS: f32 = 0.25;
/// Steps over which losses are averaged to select the best weights.
const WINDOW: usize = 50;

/// A training in progress.
pub struct Trainer {
    style: Vec<Pyramid<f32>>,
    /// Ranges of the style, estimated from the veil.
    style_ranges: Vec<Pyramid<f32>>,
    /// ContentPicture pictures from dark to bright.
    pool: Vec<ContentPicture>,
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
    /// The step of these weights.
    pub step: usize,
    /// Mean losses of the steps before it.
    pub losses: Losses,
}

impl Trainer {
    /// Prepares to learn one water from one or more photos, by a network with or without a range: measures colors and
    /// starts from the closed-form color transfer.
    ///
    /// # Panics
    /// Without a photo.
    #[must_use]
    pub fn new(photos: &[Photo], takes_range: bool, seed: u64, steps: usize) -> Self {
        assert!(!photos.is_empty(), "there is a photo to learn from");
        let style: Vec<_> = photos.iter().map(|photo| photo.pyramid.clone()).collect();
        let style_ranges: Vec<_> = photos.iter().map(|photo| photo.range.clone()).collect();
        let contents = ContentPictures::new(seed, "training content");
        let mut pool: Vec<ContentPicture> = (0..POOL as u64)
            .into_par_iter()
            .map(|index| contents.content(index))
            .collect();
        let start = started(&pool, photos, takes_range);
        // Non-negative floats have the order of their bits.
        pool.sort_by_cached_key(|content| {
            content
                .picture
                .data
                .iter()
                .map(|&value| f64::from(value))
                .sum::<f64>()
                .to_bits()
        });
        let stream = Stream::stage(seed, "training");
        Self {
            style,
            style_ranges,
            pool,
            stream,
            weights: randomized(&start, &stream),
            optimizer: Adam::new(start.values().len()),
            start,
            steps,
            window: Vec::new(),
            best: None,
        }
    }

    /// The color transfer as a network.
    #[must_use]
    pub fn color_transfer(&self) -> &Weights {
        &self.start
    }

    /// The weights after the newest step.
    #[must_use]
    pub fn weights(&self) -> &Weights {
        &self.weights
    }

    /// Whether all steps are done.
    #[must_use]
    pub fn is_done(&self) -> bool {
        self.optimizer.done() >= self.steps
    }

    /// Performs one step and returns the losses before it.
    pub fn step(&mut self) -> Losses {
        let step = self.optimizer.done() as u64;
        let takes_range = self.weights.takes_range();
        let crops: Vec<ContentPicture> = (0..BATCH)
            .into_par_iter()
            .map(|place| self.crop(step, place))
            .collect();
        let traces = crops.par_iter().map(|crop| {
            let ranged = takes_range.then(|| ranged(&crop.picture, &crop.range));
            forward(&self.weights, &crop.picture, ranged.as_ref())
        });
        let traces: Vec<_> = traces.collect();
        let results = traces.iter().map(|trace| trace.styled.clone()).collect();
        let pyramids = crops
            .into_par_iter()
            .map(|crop| (Pyramid::new(crop.picture), Pyramid::new(crop.range)));
        let (contents, near): (Vec<_>, Vec<_>) = pyramids.unzip();
        let ranges = takes_range.then_some(Ranges {
            contents: &near,
            style: &self.style_ranges,
        });
        let (losses, gradients) = losses(&contents, results, &self.style, ranges, &self.stream, step);
        let parts: Vec<Weights> = traces
            .par_iter()
            .zip(&gradients)
            .map(|(trace, gradient)| backward(&self.weights, trace, gradient))
            .collect();
        // In the order of the pictures, independent of thread timing.
        let mut gradient = Weights::zeros(takes_range);
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

    /// Keeps the weights at the end of a window of steps if the window was the best.
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

    /// A crop of a picture whose brightness class belongs to a position of the batch. Each batch therefore has about
    /// the colors of all pictures, as if it were several times as large.
    fn crop(&self, step: u64, place: usize) -> ContentPicture {
        let [left, top, mirror, choice] =
            [0, 1, 2, 3].map(|purpose| self.stream.unit(1 << 40 | step, place as u64 * 4 + purpose));
        let content = &self.pool[place * CHOICE + (choice * CHOICE as f64) as usize];
        let [left, top] = [left, top].map(|share| (share * (SIDE - CROP + 1) as f64) as usize);
        content.cropped((left, top), CROP, mirror < 0.5)
    }
}

/// The color transfer, for either half of the range if the network has one.
fn started(pool: &[ContentPicture], photos: &[Photo], takes_range: bool) -> Weights {
    let mut start = Weights::zeros(takes_range);
    if takes_range {
        let contents = pool.iter().map(|content| (&content.picture, &content.range));
        let styles = photos
            .iter()
            .map(|photo| (&photo.pyramid.levels[0], &photo.range.levels[0]));
        let RangedTransfer { near, change } = ranged_transfer(contents, styles);
        set_layer(&mut start, COLOR, near.0.as_flattened(), &near.1);
        let change: Vec<f64> = (0..3)
            .flat_map(|row| change.0[row].into_iter().chain([change.1[row]]))
            .collect();
        set_layer(&mut start, RANGE_COLOR, &change, &[]);
    } else {
        let content = ColorStats::measure(pool.iter().map(|content| &content.picture));
        let target = ColorStats::measure(photos.iter().map(|photo| &photo.pyramid.levels[0]));
        let (map, offset) = transfer(&content, &target);
        set_layer(&mut start, COLOR, map.as_flattened(), &offset);
    }
    start
}

/// Sets the weights of a layer, then its biases.
fn set_layer(weights: &mut Weights, layer: Layer, values: &[f64], offsets: &[f64]) {
    let (weight, bias) = weights.layer_mut(layer);
    let numbers = weight.iter_mut().chain(bias);
    for (number, &value) in numbers.zip(values.iter().chain(offsets)) {
        *number = value as f32;
    }
}

/// Uniform in ±1/sqrt(fan-in), smaller at the ends of the residual branches, with the initial color map.
fn randomized(start: &Weights, stream: &Stream) -> Weights {
    let mut weights = start.clone();
    for (index, &layer) in start.layers().iter().enumerate() {
        if layer == COLOR || layer == RANGE_COLOR {
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
                // Features begin active: the context could push all of them below the ReLU permanently.
                PIXEL => PIXEL_BIAS,
                RANGE_PIXEL => 0.0,
                _ => draw(1 << 20 | at) as f32,
            };
        }
    }
    weights
}
