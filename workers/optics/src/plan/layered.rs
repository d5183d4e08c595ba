//! Forward scatter of one channel with two kernels in each path, or behind gates.
//!
//! Each layer and each of its kernels has nodes of its own: a wide kernel needs few, and those of low frequencies only.

use spec::Fidelity;

use super::Variant;
use super::gates;
use super::scatter::{Chosen, ScatterNeed, WORST_MARGIN, fewest, largest_share, samples, widened};
use crate::forward_scatter::{Bound, Kernels, Nodes, widest_px};
use crate::kernel;
use crate::layering::Layering;
use crate::water::{Scatter, Spread, Tail, Water};

/// A layer is divided into this many ranges of equal ratio.
const STEPS: i32 = 16;

/// The light of one layer that one of its kernels spreads.
struct Part {
    /// Kernel scales, pixels.
    span: (f64, f64),
    /// Parts of it with the largest light of each.
    bins: Vec<((f64, f64), f64)>,
}

impl Part {
    fn brightest(&self) -> f64 {
        self.bins.iter().map(|(_, light)| *light).fold(0.0, f64::max)
    }
}

pub(super) fn choose(need: &ScatterNeed<'_>, fidelity: Fidelity, share: f64) -> Chosen {
    let layers = parts_of_layers(need);
    let parts = || layers.iter().flatten().flatten();
    let most = parts().map(|part| part.span.1).fold(0.0, f64::max);
    let brightest = parts().map(Part::brightest).fold(0.0, f64::max);
    if parts().next().is_none() || brightest == 0.0 {
        return (Variant::Skip, None);
    }
    if most == 0.0 || need.bounds.widest_px <= widest_px(1, 1) {
        return (Variant::Pointwise, None);
    }
    if let Fidelity::Terms(terms) = fidelity {
        let nodes = |part: &Part| Nodes::chebyshev(part.span.0, part.span.1, terms);
        return (Variant::Layered(kernels(&layers, nodes)), None);
    }
    // Both kernels of all layers may move light onto one pixel.
    let moved = 2.0 * layers.len() as f64 * (1.0 - kernel::center(most)) * brightest;
    if moved <= share && most < 0.5 {
        return (Variant::Pointwise, Some(moved));
    }
    let bound = |part: &Part| Bound::new(samples(&part.bins, widened(part.span.0, part.span.1)));
    let arriving = WORST_MARGIN * parts().map(|part| bound(part).arriving()).sum::<f64>();
    if arriving <= share {
        return (Variant::Skip, Some(arriving));
    }
    let amplified = need
        .layering
        .map_or(1.0, |layering| amplification(need.water, need.channel, layering));
    let each = share / (amplified * parts().count() as f64);
    let mut left = 0.0;
    let nodes = |part: &Part| {
        let (nodes, error) = fewest(&bound(part), widened(part.span.0, part.span.1), each, false);
        left += error;
        nodes
    };
    let kernels = kernels(&layers, nodes);
    (Variant::Layered(kernels), Some(left * amplified))
}

fn kernels(layers: &[[Option<Part>; 2]], mut nodes: impl FnMut(&Part) -> Nodes) -> Vec<Kernels> {
    let kernels = layers.iter().map(|[narrow, wide]| Kernels {
        narrow: narrow.as_ref().map(&mut nodes),
        wide: wide.as_ref().map(&mut nodes),
    });
    kernels.collect()
}

/// How much larger than where it is made an error may arrive. At a gate light is divided by the response of the way to it, which
/// amplifies the highest frequencies by `e^{(c−G) Z}` at most, and then goes the way again.
fn amplification(water: &Water, channel: usize, layering: &Layering) -> f64 {
    let Scatter::Jaffe { g, .. } = water.scatter else {
        return 1.0;
    };
    let excess = (water.direct_attenuation[channel] - g[channel]).max(0.0);
    layering
        .gates_m
        .iter()
        .map(|gate_m| (excess * gate_m).exp())
        .product()
}

/// The narrow and the wide part of each layer; of one layer without gates.
fn parts_of_layers(need: &ScatterNeed<'_>) -> Vec<[Option<Part>; 2]> {
    let ScatterNeed {
        bounds,
        water,
        channel,
        layering,
    } = *need;
    let Scatter::Jaffe { g, spread, tail, .. } = water.scatter else {
        return Vec::new();
    };
    let c = water.direct_attenuation[channel];
    let kernels = Two {
        channel,
        spread,
        tail,
        widest_px: bounds.widest_px,
    };
    let spread_by =
        |light: f64, (near, far): (f64, f64)| light * largest_share(g[channel].min(c), c, near, far);
    let Some(layering) = layering else {
        let Some((nearest, farthest)) = bounds.lit_m[channel] else {
            return Vec::new();
        };
        let bins = bounds.bins.iter().filter_map(|bin| {
            let radiance = f64::from(bin.brightest[channel]) * water.radiance_gain[channel];
            let (near, far) = (bin.meters.0.max(nearest), bin.meters.1.min(farthest));
            let light = spread_by(radiance, (near, far.max(near)));
            (near <= far && light > 0.0).then_some(((near, far), light))
        });
        return vec![kernels.parts((nearest, farthest), &bins.collect::<Vec<_>>())];
    };
    let of_layer = |span: &Option<(f64, f64)>| {
        let Some((near, far)) = *span else {
            return [None, None];
        };
        // What is hidden takes ranges and light of its layer, in any combination.
        let light = gates::brightest(bounds, water, channel, (near, far));
        let steps = steps((near, far)).map(|step| (step, spread_by(light, step)));
        let lit = steps.filter(|(_, light)| *light > 0.0);
        kernels.parts((near, far), &lit.collect::<Vec<_>>())
    };
    layering.spans_m.iter().map(of_layer).collect()
}

/// A span of ranges in steps of equal ratio.
fn steps((near, far): (f64, f64)) -> impl Iterator<Item = (f64, f64)> {
    let ratio = (far / near).powf(1.0 / f64::from(STEPS));
    (0..STEPS).map(move |step| (near * ratio.powi(step), near * ratio.powi(step + 1)))
}

/// The kernels of a channel.
struct Two {
    channel: usize,
    spread: Spread,
    tail: Option<Tail>,
    widest_px: f64,
}

impl Two {
    /// What the narrow and the wide kernel spread of lit ranges.
    fn parts(&self, span: (f64, f64), lit: &[((f64, f64), f64)]) -> [Option<Part>; 2] {
        let of = |spread: Spread, taken: &dyn Fn((f64, f64)) -> f64| {
            let gammas = |(near, far): (f64, f64)| {
                let gamma = |meters: f64| spread.gamma(self.channel, meters, self.widest_px);
                (gamma(near), gamma(far))
            };
            let bins = lit
                .iter()
                .map(|&(step, light)| (gammas(step), light * taken(step)));
            let bins: Vec<_> = bins.filter(|(_, light)| *light > 0.0).collect();
            (!bins.is_empty()).then(|| Part {
                span: gammas(span),
                bins,
            })
        };
        match self.tail {
            None => [of(self.spread, &|_| 1.0), None],
            Some(tail) => [
                of(self.spread, &|(near, _)| 1.0 - tail.share_at(self.channel, near)),
                of(tail.spread, &|(_, far)| tail.share_at(self.channel, far)),
            ],
        }
    }
}
