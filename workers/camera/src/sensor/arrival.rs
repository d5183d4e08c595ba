//! Arriving electrons from mean electrons: Poisson for small means, skewed normal for large ones. Random numbers are
//! drawn only for the distribution in use.

use imaging::vectorized;

use super::counting::Counter;
use super::model::POISSON_SWITCH;
use super::noise::{BLOCK, Elements, Streams, fill_normals, fill_normals_at};

/// Draws arriving electrons block by block.
#[derive(Default)]
pub(super) struct ArrivalSampler {
    counter: Counter,
}

impl ArrivalSampler {
    /// Replaces the means of neighboring pixels by arriving electrons.
    ///
    /// # Panics
    /// For more than [`BLOCK`] pixels.
    pub(super) fn arrive(
        &mut self,
        streams: &Streams,
        frame: u64,
        elements: Elements,
        electrons: &mut [f64],
    ) {
        let mut buffer = [0.0; BLOCK];
        let random = &mut buffer[..electrons.len()];
        let few = vectorized!(few(electrons));
        if few == 0 {
            fill_normals(&streams.shot_normal, frame, elements, random);
            vectorized!(scatter(&mut *electrons, random));
        } else if few == electrons.len() {
            (streams.shot).fill_units(frame, 2 * elements.first, 2 * elements.step, random);
            self.counter.count(electrons, random);
        } else {
            self.arrive_apart(streams, frame, elements, electrons);
        }
    }

    /// For a mix of small and large means: gathers both groups, draws each, and scatters the results.
    fn arrive_apart(&mut self, streams: &Streams, frame: u64, elements: Elements, electrons: &mut [f64]) {
        let (mut gathered, mut order, mut random) = ([0.0; BLOCK], [0; BLOCK], [0.0; BLOCK]);
        let gathered = &mut gathered[..electrons.len()];
        let order = &mut order[..electrons.len()];
        let few = gather(electrons, gathered, order);
        let (few_electrons, many_electrons) = gathered.split_at_mut(few);
        let (few_places, many_places) = order.split_at(few);
        let (few_random, many_random) = random[..electrons.len()].split_at_mut(few);
        let steps = (2 * elements.first, 2 * elements.step);
        (streams.shot).fill_units_at(frame, steps, few_places, few_random);
        self.counter.count(few_electrons, few_random);
        fill_normals_at(&streams.shot_normal, frame, elements, many_places, many_random);
        vectorized!(scatter(&mut *many_electrons, many_random));
        for (&place, &gathered) in order.iter().zip(&*gathered) {
            electrons[usize::from(place)] = gathered;
        }
    }
}

/// Number of pixels with small means.
#[inline(always)]
fn few(means: &[f64]) -> usize {
    let mut few = 0;
    for &mean in means {
        few += usize::from(mean < POISSON_SWITCH);
    }
    few
}

/// Gathers pixels with small means from the front and those with large ones from the back, with their positions;
/// returns the number of the former.
fn gather(means: &[f64], gathered: &mut [f64], order: &mut [u8]) -> usize {
    let (mut few, mut free) = (0, means.len());
    for (place, &mean) in means.iter().enumerate() {
        let is_few = usize::from(mean < POISSON_SWITCH);
        // Both ends are still free. Branch-free, because neighbors of a mosaic alternate.
        (gathered[few], order[few]) = (mean, place as u8);
        (gathered[free - 1], order[free - 1]) = (mean, place as u8);
        few += is_few;
        free -= 1 - is_few;
    }
    few
}

/// Replaces large means by normal numbers with Poisson's skewness.
#[inline(always)]
fn scatter(electrons: &mut [f64], normals: &[f64]) {
    for (electrons, &n) in electrons.iter_mut().zip(normals) {
        let whole = (*electrons + electrons.sqrt() * n + (n * n - 1.0) * (1.0 / 6.0) + 0.5).floor();
        *electrons = imaging::simd::larger(whole, 0.0);
    }
}
