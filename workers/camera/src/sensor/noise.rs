//! Random numbers of a sensor: normal ones from two uniform ones (Box and Muller), `√(-2 ln(1-u)) cos 2πv`, u and v at
//! the elements 2e and 2e + 1.

use imaging::random::Stream;
use imaging::vectorized;

use super::model::Chance;
use crate::elementary::{cosine_of_turn, logarithm};

/// Limit on values drawn together.
pub(super) const BLOCK: usize = 256;

/// The streams of a camera.
pub(super) struct Streams {
    pub(super) prnu: Stream,
    pub(super) dcnu: Stream,
    pub(super) dsnu: Stream,
    pub(super) hot: Stream,
    pub(super) shot: Stream,
    pub(super) shot_normal: Stream,
    pub(super) read: Stream,
    pub(super) row: Stream,
}

impl Streams {
    pub(super) fn new(chance: Chance) -> Self {
        let seed = chance.seed;
        Self {
            prnu: Stream::stage(seed, "camera-prnu"),
            dcnu: Stream::stage(seed, "camera-dcnu"),
            dsnu: Stream::stage(seed, "camera-dsnu"),
            hot: Stream::stage(seed, "camera-hot"),
            shot: Stream::stage(seed, "camera-shot"),
            shot_normal: Stream::stage(seed, "camera-shot-normal"),
            read: Stream::stage(seed, "camera-read"),
            row: Stream::stage(seed, "camera-row"),
        }
    }
}

/// Stream elements of neighboring pixels.
#[derive(Clone, Copy)]
pub(super) struct Elements {
    pub(super) first: u64,
    pub(super) step: u64,
}

/// A normal number in f64.
pub(super) fn normal(stream: &Stream, index: u64, element: u64) -> f64 {
    let (u, v) = (
        stream.unit(index, 2 * element),
        stream.unit(index, 2 * element + 1),
    );
    (-2.0 * libm::log(1.0 - u)).sqrt() * libm::cos(std::f64::consts::TAU * v)
}

/// Normal numbers of many elements, within 1e-11 of [`normal`].
///
/// # Panics
/// For more than [`BLOCK`] elements.
pub(super) fn fill_normals(stream: &Stream, index: u64, elements: Elements, normals: &mut [f64]) {
    let Elements { first, step } = elements;
    let mut turns = [0.0; BLOCK];
    let turns = &mut turns[..normals.len()];
    stream.fill_units(index, 2 * first, 2 * step, normals);
    stream.fill_units(index, 2 * first + 1, 2 * step, turns);
    vectorized!(to_normal(&mut *normals, turns));
}

/// Normal numbers of selected elements by position.
///
/// # Panics
/// For more than [`BLOCK`] elements.
pub(super) fn fill_normals_at(
    stream: &Stream,
    index: u64,
    elements: Elements,
    places: &[u8],
    normals: &mut [f64],
) {
    let Elements { first, step } = elements;
    let mut turns = [0.0; BLOCK];
    let turns = &mut turns[..normals.len()];
    stream.fill_units_at(index, (2 * first, 2 * step), places, normals);
    stream.fill_units_at(index, (2 * first + 1, 2 * step), places, turns);
    vectorized!(to_normal(&mut *normals, turns));
}

#[inline(always)]
fn to_normal(units: &mut [f64], turns: &[f64]) {
    for (unit, &turn) in units.iter_mut().zip(turns) {
        // Rounding may leave a logarithm of almost 1 just above 0.
        let square = imaging::simd::larger(-2.0 * logarithm(1.0 - *unit), 0.0);
        *unit = square.sqrt() * cosine_of_turn(turn);
    }
}
