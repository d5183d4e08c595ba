//! Forward scatter of one channel: the cheapest form whose error stays within what it is given.

use spec::ScatterSource;

use super::{Fidelity, ScatterStep, SceneStats, gates};
use crate::forward_scatter::{Bound, Nodes, ScaleLight, place, scale_at, widest_px};
use crate::kernel;
use crate::layering::Layering;
use crate::water::{Scatter, Spread, Water};

/// A form and the error that it may make, where it was chosen by one.
pub(super) type Chosen = (ScatterStep, Option<f64>);

/// The worst case is summed at sampled scales and on rings: room for what lies between the samples. Frames that give every offset
/// its worst scale, all errors of one sign, come within 7 % of the sum.
const WORST_MARGIN: f64 = 1.2;
/// Gathering has one scale for each sum; the same room.
const GATHER_MARGIN: f64 = 1.2;
/// Samples of the kernel scale between the narrowest and the widest.
const SAMPLES: usize = 41;
/// No frame needs more kernels.
pub const MOST_TERMS: usize = 64;
/// Spans of scales are widened to multiples of this in s, so that similar frames share their kernels.
const SPAN_STEP: f64 = 1.0 / 16.0;

/// One channel of a frame whose form is to be chosen.
#[derive(Clone, Copy)]
pub(super) struct Asked<'a> {
    pub(super) stats: &'a SceneStats,
    pub(super) water: &'a Water,
    pub(super) channel: usize,
    /// Layers behind gates, where the frame has some.
    pub(super) layering: Option<&'a Layering>,
}

pub(super) fn choose(asked: &Asked<'_>, fidelity: Fidelity, share: f64) -> Chosen {
    let Asked {
        stats,
        water,
        channel,
        layering,
    } = *asked;
    if fidelity == Fidelity::REFERENCE && water.scatter != Scatter::None {
        return (ScatterStep::Reference, None);
    }
    let light = match layering {
        Some(layering) => SpreadLight::behind_gates(stats, water, channel, layering),
        None => SpreadLight::measure(stats, water, channel),
    };
    let Some(light) = light else {
        return (ScatterStep::Skip, None);
    };
    let (least, most) = light.span;
    let one_pixel = stats.widest_px <= widest_px(1, 1);
    if most == 0.0 || one_pixel {
        // The kernel is a delta, or the frame a single pixel in which all light stays.
        let step = if light.gathers {
            ScatterStep::Skip
        } else {
            ScatterStep::Pointwise
        };
        return (step, None);
    }
    let few = |terms: usize| {
        let kernels = 1 + usize::from(light.tail.is_some());
        let distinct = stats
            .distinct_m
            .as_ref()
            .filter(|distinct| kernels * distinct.len() <= terms)
            // What is filled in behind something lies between the ranges of its layer, if there are several.
            .filter(|distinct| layering.is_none_or(|layering| is_one_each(distinct, layering)))?;
        let spreads = std::iter::once(light.spread).chain(light.tail);
        let scales = spreads.flat_map(|spread| {
            let scale = move |&meters: &f32| spread.gamma(channel, f64::from(meters), stats.widest_px);
            distinct.iter().map(scale)
        });
        Some(ScatterStep::Interpolated(Nodes::exact(scales)))
    };
    match fidelity {
        Fidelity::Terms(terms) => {
            let nodes = || ScatterStep::Interpolated(Nodes::chebyshev(least, most, terms));
            (few(terms).unwrap_or_else(nodes), None)
        }
        _ => {
            let amplified = layering.map_or(1.0, |layering| amplification(water, channel, layering));
            let (step, bound) = within(&light, share / amplified);
            let bound = bound * amplified;
            let terms = match &step {
                ScatterStep::Interpolated(nodes) => nodes.terms(),
                _ => return (step, Some(bound)),
            };
            few(terms).map_or((step, Some(bound)), |exact| (exact, Some(0.0)))
        }
    }
}

/// Whether each layer has a single range.
fn is_one_each(distinct: &[f32], layering: &Layering) -> bool {
    let count = |layer: usize| {
        let own = distinct.iter().filter(|&&z| layering.layer_of(f64::from(z)) == layer);
        own.count()
    };
    (0..layering.count()).all(|layer| count(layer) <= 1)
}

/// How much the errors of all layers together can be of the error of one. At a gate light is divided by the response of the way
/// to it, which amplifies the highest frequencies by `e^{(c−G) Z}` at most, and then goes the way again.
fn amplification(water: &Water, channel: usize, layering: &Layering) -> f64 {
    let Scatter::Jaffe { g, .. } = water.scatter else {
        return 1.0;
    };
    let excess = (water.direct_attenuation[channel] - g[channel]).max(0.0);
    let (mut sum, mut amplified) = (1.0, 1.0);
    for gate_m in &layering.gates_m {
        amplified *= (excess * gate_m).exp();
        sum += amplified;
    }
    sum
}

/// The cheapest form with an error of at most `share`, and its bound.
fn within(light: &SpreadLight, share: f64) -> (ScatterStep, f64) {
    let (least, most) = light.span;
    // Light that leaves its own pixel.
    let leaving = 1.0 - kernel::center(most);
    let moved = leaving * light.brightest;
    if moved <= share && light.gathers {
        return (ScatterStep::Skip, moved);
    }
    if moved <= share && most < 0.5 {
        return (ScatterStep::Pointwise, moved);
    }
    // One kernel for all leaves even light as it is.
    let uneven = leaving * light.unevenness;
    if uneven <= share && is_point(least, most) && !light.gathers {
        return (ScatterStep::Pointwise, uneven);
    }
    let wide = widened(least, most);
    let bound = Bound::new(light.samples(wide));
    if !light.gathers {
        let arriving = bound.arriving() * WORST_MARGIN;
        if arriving <= share {
            return (ScatterStep::Skip, arriving);
        }
    }
    let mut best = (ScatterStep::Skip, f64::INFINITY);
    for terms in 1..=MOST_TERMS {
        let nodes = Nodes::chebyshev(wide.0, wide.1, terms);
        let gammas: Vec<f64> = (0..nodes.terms()).map(|k| nodes.gamma(k)).collect();
        let errors = bound.errors(&gammas);
        let error = if light.gathers {
            GATHER_MARGIN * errors.even
        } else {
            WORST_MARGIN * errors.worst
        };
        best = (ScatterStep::Interpolated(nodes), error);
        if error <= share {
            break;
        }
    }
    best
}

fn is_point(least: f64, most: f64) -> bool {
    most - least <= f64::from(f32::EPSILON) * most
}

/// The span in whole steps of s; one of a single scale stays as it is.
fn widened(least: f64, most: f64) -> (f64, f64) {
    if is_point(least, most) {
        return (least, most);
    }
    let low = (place(least) / SPAN_STEP).floor() * SPAN_STEP;
    let high = (place(most) / SPAN_STEP).ceil() * SPAN_STEP;
    (scale_at(low).max(0.0), scale_at(high))
}

/// The light of one channel that is spread or gathered, and from which ranges.
struct SpreadLight {
    /// Its largest value; where it is gathered, the largest difference of two pixels.
    brightest: f64,
    /// Largest less smallest light in a frame of one range; in another the largest.
    unevenness: f64,
    /// Kernel scales of the frame, pixels.
    span: (f64, f64),
    /// Kernel scales of bins of range with the largest light of each.
    bins: Vec<((f64, f64), f64)>,
    spread: Spread,
    /// The wider of two kernels.
    tail: Option<Spread>,
    gathers: bool,
}

impl SpreadLight {
    /// None where there is nothing to spread.
    fn measure(stats: &SceneStats, water: &Water, channel: usize) -> Option<Self> {
        match water.scatter {
            Scatter::None => None,
            Scatter::Simplified { spread } => {
                let gamma = |meters: f64| spread.gamma(channel, meters, stats.widest_px);
                let (nearest, farthest) = stats.range_m?;
                let (low, high) = super::levels::levels(stats, water, channel);
                Some(Self {
                    brightest: high - low,
                    unevenness: high - low,
                    span: (gamma(nearest), gamma(farthest)),
                    bins: vec![((gamma(nearest), gamma(farthest)), high - low)],
                    spread,
                    tail: None,
                    gathers: true,
                })
            }
            Scatter::Jaffe {
                g,
                source,
                spread,
                tail,
                ..
            } => {
                let tail = tail.map(|tail| tail.spread);
                let gamma = |meters: f64| spread.gamma(channel, meters, stats.widest_px);
                let widest = |meters: f64| tail.unwrap_or(spread).gamma(channel, meters, stats.widest_px);
                let (nearest, farthest) = stats.lit_m[channel]?;
                let c = water.direct_attenuation[channel];
                let bins = stats.bins.iter().filter_map(|bin| {
                    let radiance = f64::from(bin.brightest[channel]) * water.radiance_gain[channel];
                    let (near, far) = (bin.meters.0.max(nearest), bin.meters.1.min(farthest));
                    let arriving = if source == ScatterSource::Direct {
                        (-c * near).exp()
                    } else {
                        1.0
                    };
                    let light =
                        radiance * arriving * largest_share(g[channel].min(c), c, near, far.max(near));
                    (near <= far && light > 0.0).then_some(((near, far), light))
                });
                let bins = scaled(bins, channel, stats, (spread, tail));
                let brightest = bins.iter().map(|(_, light)| *light).reduce(f64::max)?;
                let one_range = !stats.holes && stats.range_m.is_some_and(|(near, far)| is_point(near, far));
                let dark = f64::from(stats.darkest[channel])
                    / f64::from(stats.brightest[channel]).max(f64::MIN_POSITIVE);
                Some(Self {
                    brightest,
                    unevenness: if one_range {
                        brightest * (1.0 - dark)
                    } else {
                        brightest
                    },
                    span: (gamma(nearest), widest(farthest)),
                    bins,
                    spread,
                    tail,
                    gathers: false,
                })
            }
        }
    }

    /// The same of layers behind gates: what is hidden takes ranges and light of its layer, in any combination.
    fn behind_gates(stats: &SceneStats, water: &Water, channel: usize, layering: &Layering) -> Option<Self> {
        let Scatter::Jaffe { g, spread, tail, .. } = water.scatter else {
            return None;
        };
        let (nearest, farthest) = stats.range_m?;
        let c = water.direct_attenuation[channel];
        let layers = (0..layering.count()).flat_map(|layer| {
            let span = layering.span(layer, (nearest, farthest));
            let light = gates::brightest(stats, water, channel, span);
            parts(span).map(move |(near, far)| {
                let share = largest_share(g[channel].min(c), c, near, far);
                ((near, far), light * share)
            })
        });
        let lit = layers.filter(|(_, light)| *light > 0.0);
        let tail = tail.map(|tail| tail.spread);
        let bins = scaled(lit, channel, stats, (spread, tail));
        let brightest = bins.iter().map(|(_, light)| *light).reduce(f64::max)?;
        Some(Self {
            brightest,
            unevenness: brightest,
            span: (
                spread.gamma(channel, nearest, stats.widest_px),
                tail.unwrap_or(spread).gamma(channel, farthest, stats.widest_px),
            ),
            bins,
            spread,
            tail,
            gathers: false,
        })
    }

    /// Scales evenly spaced in s, each with the largest light of the bins that touch its surroundings.
    fn samples(&self, (least, most): (f64, f64)) -> Vec<ScaleLight> {
        let (low, width) = (place(least), place(most) - place(least));
        let mut light = [0.0f64; SAMPLES];
        let position = |gamma: f64| {
            if width > 0.0 {
                (place(gamma) - low) / width * (SAMPLES - 1) as f64
            } else {
                0.0
            }
        };
        for ((near, far), brightest) in &self.bins {
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
}

/// The kernel scales of lit ranges, of both kernels where there are two: either may take all of the light.
fn scaled(
    lit: impl Iterator<Item = ((f64, f64), f64)>,
    channel: usize,
    stats: &SceneStats,
    (spread, tail): (Spread, Option<Spread>),
) -> Vec<((f64, f64), f64)> {
    let of = |spread: Spread, (near, far): (f64, f64)| {
        let gamma = |meters: f64| spread.gamma(channel, meters, stats.widest_px);
        (gamma(near), gamma(far))
    };
    let kernels = lit.flat_map(|(span, light)| {
        let wide = tail.map(|tail| (of(tail, span), light));
        std::iter::once((of(spread, span), light)).chain(wide)
    });
    kernels.collect()
}

/// A span of ranges in parts of equal ratio.
fn parts((near, far): (f64, f64)) -> impl Iterator<Item = (f64, f64)> {
    const PARTS: i32 = 16;
    let ratio = (far / near).max(1.0).powf(1.0 / f64::from(PARTS));
    (0..PARTS).map(move |part| (near * ratio.powi(part), near * ratio.powi(part + 1)))
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

    /// The margins have to cover what lies between the samples, for as many kernels as are taken.
    #[test]
    fn what_lies_between_the_samples_of_the_scale_is_within_the_margins() {
        for span in [(0.02, 100.0), (0.0, 2000.0), (0.5, 20.0), (5.0, 8.0)] {
            let (sampled, dense) = (bound(span, SAMPLES), bound(span, 16 * (SAMPLES - 1) + 1));
            for terms in [2, 5, 9, 14, 20, 27, 33, 40, 48, MOST_TERMS] {
                let nodes = Nodes::chebyshev(span.0, span.1, terms);
                let gammas: Vec<f64> = (0..nodes.terms()).map(|k| nodes.gamma(k)).collect();
                let (sampled, dense) = (sampled.errors(&gammas), dense.errors(&gammas));
                // No tolerance is that small.
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
