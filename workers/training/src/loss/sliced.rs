//! Distance between the patches of two sets of pictures: sliced Wasserstein distances (Rabin, Peyré, Delon and Bernot
//! 2011, "Wasserstein barycenter and its application to texture mixing").
//!
//! `distance(f) = mean over i of |sorted(f·a)_i - sorted(f·b)_i| / (s + e)`, for patches a of the results and b of the
//! style, a direction f, and the standard deviation s of f·b. Texture: random filters over 7×7×3 samples, e = 0.002.
//! Color: random directions in the color of the center, e = 0.02. Both are means over directions and levels. Patches
//! are pooled over the batch: a single picture need not look like the complete style. With ranges, the patches of
//! either side are sorted by the range at their center and split into [`BANDS`] of equal size; the distance is the mean
//! over bands, each with its s. Bands are compared in order.

use imaging::random::Stream;
use rayon::prelude::*;

use super::draw::{DIRECTIONS, FILTERS, PATCH, PatchPosition, directions, filters, places};
use super::pyramid::{LEVELS, Pyramid};
use super::slices::{Slices, projections, scatter};
use super::weights::{COLOR, Ranges, TEXTURE};
use crate::real::Real;
use crate::tensor::Tensor;

/// Patches per level.
const PATCHES: [usize; LEVELS] = [2048, 2048, 1024, 1024];
/// Bands of range.
const BANDS: usize = 4;
/// Added to the standard deviation of the style.
const TEXTURE_FLOOR: f64 = 0.002;
const COLOR_FLOOR: f64 = 0.02;

/// Distances, and the gradient for each picture of the batch.
pub(crate) struct Sliced<T> {
    pub(crate) texture: f64,
    pub(crate) color: f64,
    pub(crate) gradients: Vec<Pyramid<T>>,
}

/// Compares the pictures of a batch with those of the style.
pub(crate) fn sliced<T: Real>(
    batch: &[Pyramid<T>],
    style: &[Pyramid<T>],
    ranges: Option<Ranges<'_, T>>,
    stream: &Stream,
    step: u64,
) -> Sliced<T> {
    let levels = (0..LEVELS).into_par_iter().map(|level| {
        let address = (step * LEVELS as u64 + level as u64) * 1024;
        let slices = Slices {
            filters: filters(stream, address),
            directions: directions(stream, address + 1),
        };
        let ours = PatchDraw::new(batch, level, stream, address + 2);
        let theirs = PatchDraw::new(style, level, stream, address + 512);
        let bands = ranges.map(|ranges| {
            [(&ours, ranges.contents), (&theirs, ranges.style)]
                .map(|(drawn, ranges)| drawn.by_range(ranges, level))
        });
        compare(&ours, &theirs, bands.as_ref(), &slices)
    });
    let levels: Vec<_> = levels.collect();
    let mut gradients: Vec<Pyramid<T>> = batch.iter().map(Pyramid::like).collect();
    let (mut texture, mut color) = (0.0, 0.0);
    for (level, found) in levels.into_iter().enumerate() {
        texture += found.texture / LEVELS as f64;
        color += found.color / LEVELS as f64;
        for (pyramid, gradient) in gradients.iter_mut().zip(found.gradients) {
            pyramid.levels[level] = gradient;
        }
    }
    Sliced {
        texture,
        color,
        gradients,
    }
}

/// Splits a number of patches as evenly as possible.
fn shared_out(patches: usize, pictures: usize) -> impl Iterator<Item = usize> {
    (0..pictures).map(move |index| patches * (index + 1) / pictures - patches * index / pictures)
}

/// Pictures of a level and the positions of their patches.
struct PatchDraw<'a, T> {
    pictures: Vec<&'a Tensor<T>>,
    places: Vec<Vec<PatchPosition>>,
}

impl<'a, T: Real> PatchDraw<'a, T> {
    /// Draws patches of all pictures, at the stream addresses from `first` on.
    fn new(pictures: &'a [Pyramid<T>], level: usize, stream: &Stream, first: u64) -> Self {
        let pictures: Vec<_> = pictures.iter().map(|picture| &picture.levels[level]).collect();
        let counts = shared_out(PATCHES[level], pictures.len());
        let drawn = (first..).zip(&pictures).zip(counts);
        let places = drawn.map(|((address, picture), count)| {
            places(stream, address, count, (picture.width, picture.height))
        });
        Self {
            places: places.collect(),
            pictures,
        }
    }

    /// The patches from near to far, by the range at their center.
    fn by_range(&self, ranges: &[Pyramid<T>], level: usize) -> Vec<u32> {
        let pairs = ranges.iter().zip(&self.places);
        let at_centers = pairs.flat_map(|(range, places)| {
            let range = &range.levels[level];
            places
                .iter()
                .map(|place| range.row(0, place.y + PATCH / 2)[place.x + PATCH / 2])
        });
        T::ascending(&at_centers.collect::<Vec<_>>())
    }

    /// Projections of all patches, slice by slice.
    fn projected(&self, slices: &Slices<T>) -> Vec<Vec<T>> {
        let pairs = self.pictures.par_iter().zip(&self.places);
        let parts: Vec<_> = pairs
            .map(|(picture, places)| projections(picture, places, slices))
            .collect();
        (0..FILTERS + DIRECTIONS)
            .map(|slice| parts.iter().flat_map(|part| &part[slice]).copied().collect())
            .collect()
    }
}

struct LevelDistances<T> {
    texture: f64,
    color: f64,
    gradients: Vec<Tensor<T>>,
}

fn compare<T: Real>(
    ours: &PatchDraw<'_, T>,
    theirs: &PatchDraw<'_, T>,
    bands: Option<&[Vec<u32>; 2]>,
    slices: &Slices<T>,
) -> LevelDistances<T> {
    let (results, styles) = (ours.projected(slices), theirs.projected(slices));
    let found = (0..FILTERS + DIRECTIONS).into_par_iter().map(|slice| {
        let (share, floor, slices) = if slice < FILTERS {
            (TEXTURE, TEXTURE_FLOOR, FILTERS)
        } else {
            (COLOR, COLOR_FLOOR, DIRECTIONS)
        };
        let factor = share / (slices * LEVELS * results[slice].len()) as f64;
        match bands {
            Some(orders) => banded([&results[slice], &styles[slice]], orders, floor, factor),
            None => wasserstein(&results[slice], &styles[slice], floor, factor),
        }
    });
    let found: Vec<(f64, Vec<T>)> = found.collect();
    let [texture, color] = [&found[..FILTERS], &found[FILTERS..]]
        .map(|found| found.iter().map(|f| f.0).sum::<f64>() / found.len() as f64);
    let slopes: Vec<Vec<T>> = found.into_iter().map(|(_, slopes)| slopes).collect();
    let starts: Vec<usize> = (0..ours.places.len())
        .map(|index| ours.places[..index].iter().map(Vec::len).sum())
        .collect();
    let gradients = (0..ours.pictures.len()).into_par_iter().map(|index| {
        let mut gradient = ours.pictures[index].like();
        scatter(&mut gradient, &ours.places[index], starts[index], slices, &slopes);
        gradient
    });
    LevelDistances {
        texture,
        color,
        gradients: gradients.collect(),
    }
}

/// The mean distance over bands of two sets of equal size, each in its order, and its slope for each element of the
/// first.
fn banded<T: Real>(
    [ours, theirs]: [&[T]; 2],
    [our_order, their_order]: &[Vec<u32>; 2],
    floor: f64,
    factor: f64,
) -> (f64, Vec<T>) {
    let (mut sum, mut slopes) = (0.0, vec![T::default(); ours.len()]);
    for band in 0..BANDS {
        let range = ours.len() * band / BANDS..ours.len() * (band + 1) / BANDS;
        let (our_order, their_order) = (&our_order[range.clone()], &their_order[range]);
        let (ours, theirs) = (reorder(ours, our_order), reorder(theirs, their_order));
        let (distance, found) = wasserstein(&ours, &theirs, floor, factor);
        sum += distance;
        for (&place, slope) in our_order.iter().zip(found) {
            slopes[place as usize] = slope;
        }
    }
    (sum / BANDS as f64, slopes)
}

/// Distance of two sets of equal size, and its slope for each element of the first.
fn wasserstein<T: Real>(ours: &[T], theirs: &[T], floor: f64, factor: f64) -> (f64, Vec<T>) {
    let count = theirs.len() as f64;
    let mean = theirs.iter().map(|v| v.to_f64()).sum::<f64>() / count;
    let squares = theirs.iter().map(|v| (v.to_f64() - mean) * (v.to_f64() - mean));
    let deviation = (squares.sum::<f64>() / (count - 1.0)).sqrt();
    let scale = 1.0 / (deviation + floor);
    let (up, down) = (T::from_f64(factor * scale), T::from_f64(-factor * scale));
    let mut slopes = vec![T::default(); ours.len()];
    let mut sum = 0.0;
    for (&place, &other) in T::ascending(ours).iter().zip(&T::ascending(theirs)) {
        let (ours, theirs) = (ours[place as usize], theirs[other as usize]);
        sum += (ours.to_f64() - theirs.to_f64()).abs();
        if ours > theirs {
            slopes[place as usize] = up;
        } else if ours < theirs {
            slopes[place as usize] = down;
        }
    }
    (sum / count * scale, slopes)
}

fn reorder<T: Copy>(values: &[T], order: &[u32]) -> Vec<T> {
    order.iter().map(|&place| values[place as usize]).collect()
}
