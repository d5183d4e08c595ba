//! Need of scattered light, and the number of terms of its kernels.

use crate::forward_scatter::{Bound, Nodes, ScaleLight, place, scale_at};
use crate::layering::Layering;
use crate::plan::{SceneBounds, Variant};
use crate::water::Water;

/// A form and the error that it may make, where it was chosen by one.
pub(super) type Chosen = (Variant, Option<f64>);

/// The worst case is summed at sampled scales and on rings: a margin for values between the samples. Frames with the worst scale at
/// every offset, all errors of one sign, come within 7 % of the sum.
pub(super) const WORST_MARGIN: f64 = 1.2;

/// Gathering has one scale for each sum; the same room.
pub(super) const GATHER_MARGIN: f64 = 1.2;

/// Samples of the kernel scale between the narrowest and the widest.
pub(super) const SAMPLES: usize = 41;

/// Limit of the number of kernels.
pub const MOST_TERMS: usize = 64;

/// Spans of scales are widened to multiples of this in s, so that similar frames share their kernels.
pub(super) const SPAN_STEP: f64 = 1.0 / 16.0;

/// One channel of a frame and the inputs for its choice of variant.
#[derive(Clone, Copy)]
pub(super) struct ScatterNeed<'a> {
    pub(super) bounds: &'a SceneBounds,
    pub(super) water: &'a Water,
    pub(super) channel: usize,
    /// Layers behind gates, where the frame has some.
    pub(super) layering: Option<&'a Layering>,
}

/// The fewest nodes over a span of scales whose error is at most `share`, and that error. Errors fall about as a power of the number of
/// nodes, so the search interpolates their logarithms between a number that is too small and one that suffices.
pub(super) fn fewest(bound: &Bound, wide: (f64, f64), share: f64, gathers: bool) -> (Nodes, f64) {
    let mut too_few = Search::new(bound, wide, gathers, 1);
    if too_few.error <= share {
        return (too_few.nodes, too_few.error);
    }
    let mut enough = Search::new(bound, wide, gathers, GALLOP[0]);
    for terms in GALLOP.into_iter().skip(1) {
        if enough.error <= share {
            break;
        }
        too_few = std::mem::replace(&mut enough, Search::new(bound, wide, gathers, terms));
    }
    while enough.error <= share && enough.terms > too_few.terms + 1 {
        let between = Search::new(bound, wide, gathers, too_few.guess(&enough, share));
        if between.error <= share {
            enough = between;
        } else {
            too_few = between;
        }
    }
    (enough.nodes, enough.error)
}

/// First numbers of nodes of the search.
pub(super) const GALLOP: [usize; 6] = [3, 6, 12, 20, 36, MOST_TERMS];

/// A number of nodes and its error.
pub(super) struct Search {
    pub(super) terms: usize,
    pub(super) nodes: Nodes,
    pub(super) error: f64,
}

impl Search {
    pub(super) fn new(bound: &Bound, (least, most): (f64, f64), gathers: bool, terms: usize) -> Self {
        let nodes = Nodes::chebyshev(least, most, terms);
        let gammas: Vec<f64> = (0..nodes.terms()).map(|k| nodes.gamma(k)).collect();
        let errors = bound.errors(&gammas);
        let error = if gathers {
            GATHER_MARGIN * errors.even
        } else {
            WORST_MARGIN * errors.worst
        };
        Self { terms, nodes, error }
    }

    /// The number of nodes at the expected crossing of `share`, between this one and one that suffices.
    pub(super) fn guess(&self, enough: &Self, share: f64) -> usize {
        let fallen = (self.error / share).ln() / (self.error / enough.error).ln();
        let span = (enough.terms - self.terms) as f64;
        let steps = (fallen * span).ceil();
        let steps = if steps.is_finite() { steps as usize } else { 1 };
        self.terms + steps.clamp(1, enough.terms - self.terms - 1)
    }
}

pub(super) fn is_point(least: f64, most: f64) -> bool {
    most - least <= f64::from(f32::EPSILON) * most
}

/// The span in whole steps of s; one of a single scale stays as it is.
pub(super) fn widened(least: f64, most: f64) -> (f64, f64) {
    widened_to(SPAN_STEP, least, most)
}

/// The same with steps of another size.
pub(super) fn widened_to(step: f64, least: f64, most: f64) -> (f64, f64) {
    if is_point(least, most) {
        return (least, most);
    }
    let low = (place(least) / step).floor() * step;
    let high = (place(most) / step).ceil() * step;
    (scale_at(low).max(0.0), scale_at(high))
}

/// Scales evenly spaced in s, each with the largest light of the bins that touch its surroundings.
pub(super) fn samples(bins: &[((f64, f64), f64)], (least, most): (f64, f64)) -> Vec<ScaleLight> {
    let (low, width) = (place(least), place(most) - place(least));
    let mut light = [0.0f64; SAMPLES];
    let position = |gamma: f64| {
        if width > 0.0 {
            (place(gamma) - low) / width * (SAMPLES - 1) as f64
        } else {
            0.0
        }
    };
    for ((near, far), brightest) in bins {
        let (from, to) = (position(*near).floor().max(0.0), position(*far).ceil());
        for sample in &mut light[from as usize..=(to as usize).min(SAMPLES - 1)] {
            *sample = sample.max(*brightest);
        }
    }
    let scale = |(j, light): (usize, f64)| ScaleLight {
        gamma: scale_at(low + width * j as f64 / (SAMPLES - 1) as f64).max(0.0),
        light,
    };
    let lit = light.into_iter().enumerate().filter(|(_, light)| *light > 0.0);
    lit.map(scale).collect()
}

/// The largest `e^{−GZ} − e^{−cZ}` between two ranges: it rises to its peak at `ln(c/G)/(c − G)` and then falls.
pub(super) fn largest_share(g: f64, c: f64, nearest_m: f64, farthest_m: f64) -> f64 {
    let peak = if g > 0.0 && c > g {
        (c / g).ln() / (c - g)
    } else {
        f64::INFINITY
    };
    let at = peak.clamp(nearest_m, farthest_m);
    (-g * at).exp() * -(-(c - g) * at).exp_m1()
}

/// Spread light of several pixels with kernels of different widths may add up in one pixel to this much.
pub(super) const PILED_UP: f64 = 2.0;

#[cfg(test)]
mod tests {
    use super::*;

    fn bound((least, most): (f64, f64), samples: usize) -> Bound {
        let (low, width) = (place(least), place(most) - place(least));
        let scale = |j: usize| scale_at(low + width * j as f64 / (samples - 1) as f64).max(0.0);
        let scales = (0..samples).map(|j| ScaleLight {
            gamma: scale(j),
            light: 1.0,
        });
        Bound::new(scales.collect())
    }

    /// The margins have to cover scales between the samples, for all numbers of kernels.
    #[test]
    fn what_lies_between_the_samples_of_the_scale_is_within_the_margins() {
        for span in [(0.02, 100.0), (0.0, 2000.0), (0.5, 20.0), (5.0, 8.0)] {
            let (sampled, dense) = (bound(span, SAMPLES), bound(span, 16 * (SAMPLES - 1) + 1));
            for terms in [2, 5, 9, 14, 20, 27, 33, 40, 48, MOST_TERMS] {
                let nodes = Nodes::chebyshev(span.0, span.1, terms);
                let gammas: Vec<f64> = (0..nodes.terms()).map(|k| nodes.gamma(k)).collect();
                let (sampled, dense) = (sampled.errors(&gammas), dense.errors(&gammas));
                // All tolerances are larger.
                let least = 1e-8;
                assert!(
                    dense.worst <= WORST_MARGIN * sampled.worst.max(least),
                    "{span:?}, {terms}: {sampled:?} {dense:?}"
                );
                assert!(
                    dense.even <= GATHER_MARGIN * sampled.even.max(least),
                    "{span:?}, {terms}: {sampled:?} {dense:?}"
                );
            }
        }
    }
}
