//! Projects patches of a picture on the filters and directions of a level, and propagates slopes back to its pixels.

use imaging::vectorized;

use super::draw::{DIRECTIONS, FILTERS, PATCH, PATCH_LENGTH, PatchPosition};
use crate::real::Real;
use crate::tensor::Tensor;

/// Patches that are projected together.
const CHUNK: usize = 64;

/// The filters and directions of a level.
pub(super) struct Slices<T> {
    pub(super) filters: Vec<[T; PATCH_LENGTH]>,
    pub(super) directions: Vec<[T; 3]>,
}

/// Projections of the patches of a picture on all filters and directions: `[slice][patch]`.
pub(super) fn projections<T: Real>(
    picture: &Tensor<T>,
    places: &[PatchPosition],
    slices: &Slices<T>,
) -> Vec<Vec<T>> {
    let mut out = vec![Vec::new(); FILTERS + DIRECTIONS];
    let mut samples = vec![[T::default(); CHUNK]; PATCH_LENGTH];
    for places in places.chunks(CHUNK) {
        for (index, place) in places.iter().enumerate() {
            for line in 0..3 * PATCH {
                let source = &picture.row(line / PATCH, place.y + line % PATCH)[place.x..place.x + PATCH];
                for (to, &source) in samples[line * PATCH..][..PATCH].iter_mut().zip(source) {
                    to[index] = source;
                }
            }
        }
        let mut sums = vec![[T::default(); CHUNK]; FILTERS + DIRECTIONS];
        vectorized!(project(&samples, slices, &mut sums));
        for (out, sums) in out.iter_mut().zip(&sums) {
            out.extend_from_slice(&sums[..places.len()]);
        }
    }
    out
}

/// Index of a patch's center, by channel.
fn center(channel: usize) -> usize {
    (channel * PATCH + PATCH / 2) * PATCH + PATCH / 2
}

#[inline(always)]
fn project<T: Real>(samples: &[[T; CHUNK]], slices: &Slices<T>, sums: &mut [[T; CHUNK]]) {
    for (filter, sums) in slices.filters.iter().zip(&mut *sums) {
        let mut local = [T::default(); CHUNK];
        for (&tap, samples) in filter.iter().zip(samples) {
            for index in 0..CHUNK {
                local[index] += samples[index] * tap;
            }
        }
        *sums = local;
    }
    for (direction, sums) in slices.directions.iter().zip(&mut sums[FILTERS..]) {
        for (channel, &share) in direction.iter().enumerate() {
            let samples = &samples[center(channel)];
            for index in 0..CHUNK {
                sums[index] += samples[index] * share;
            }
        }
    }
}

/// Adds the slopes of all slices to the pixels of the patches; `start` is the index of the first patch's slopes.
pub(super) fn scatter<T: Real>(
    gradient: &mut Tensor<T>,
    places: &[PatchPosition],
    start: usize,
    slices: &Slices<T>,
    slopes: &[Vec<T>],
) {
    let mut samples = vec![[T::default(); CHUNK]; PATCH_LENGTH];
    let mut chunk = vec![[T::default(); CHUNK]; slopes.len()];
    for (index, places) in places.chunks(CHUNK).enumerate() {
        for (chunk, slopes) in chunk.iter_mut().zip(slopes) {
            chunk[..places.len()].copy_from_slice(&slopes[start + index * CHUNK..][..places.len()]);
        }
        vectorized!(unproject(&chunk, slices, &mut samples));
        for (index, place) in places.iter().enumerate() {
            for line in 0..3 * PATCH {
                let source = &samples[line * PATCH..][..PATCH];
                let target = gradient.row_mut(line / PATCH, place.y + line % PATCH);
                for (target, source) in target[place.x..place.x + PATCH].iter_mut().zip(source) {
                    *target += source[index];
                }
            }
        }
    }
}

#[inline(always)]
fn unproject<T: Real>(slopes: &[[T; CHUNK]], slices: &Slices<T>, samples: &mut [[T; CHUNK]]) {
    for (at, samples) in samples.iter_mut().enumerate() {
        let mut sums = [T::default(); CHUNK];
        for (filter, slopes) in slices.filters.iter().zip(slopes) {
            let tap = filter[at];
            for index in 0..CHUNK {
                sums[index] += slopes[index] * tap;
            }
        }
        *samples = sums;
    }
    for (direction, slopes) in slices.directions.iter().zip(&slopes[FILTERS..]) {
        for (channel, &share) in direction.iter().enumerate() {
            let samples = &mut samples[center(channel)];
            for index in 0..CHUNK {
                samples[index] += slopes[index] * share;
            }
        }
    }
}
