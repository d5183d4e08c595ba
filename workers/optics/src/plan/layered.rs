//! Forward scatter of one channel with two kernels in each path, or behind gates.
//!
//! Each layer and each of its kernels has nodes of its own: a wide kernel needs few, and those of low frequencies only.

use spec::Fidelity;

use super::Variant;
use super::gates;
use super::passages::{Passage, Passages, Through};
use super::scatter::{Chosen, ScatterNeed, WORST_MARGIN, fewest, largest_share, samples, widened};
use crate::forward_scatter::{Bound, Kernels, Nodes, widest_px};
use crate::kernel;
use crate::layering::Layering;
use crate::water::{Scatter, Spread, Tail};

/// A layer is divided into this many ranges of equal ratio.
const STEPS: i32 = 16;
/// Origins to try behind a gate, as shares of the kernel's scale at the gate.
const ORIGINS: &[f64] = &[0.0, 0.5, 1.0];
/// Below this ratio of the gains of the first and the last origin, the first one needs the fewest nodes.
const FEW_TIMES: f64 = 30.0;
/// Kernels divided by one at the gate are not integrated over pixels: their error may be larger by this factor. The largest
/// seen is 1.1.
const QUOTIENT_MARGIN: f64 = 1.5;
/// Minimum part of the share reserved for interpolation if rounding at gates exceeds it.
const LEAST_SHARE: f64 = 0.125;

/// The light of one layer that one of its kernels spreads.
struct Part {
    /// Kernel scales, pixels.
    span: (f64, f64),
    /// Parts of it with the largest light of each.
    bins: Vec<((f64, f64), f64)>,
    /// The gate in front.
    way: Option<Way>,
}

/// The way of a layer's light through gates.
struct Way {
    through: Through,
    /// 0 of the narrow kernel, 1 of the wide one.
    kernel: usize,
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
    let rounding = need
        .layering
        .map_or(0.0, |layering| gate_rounding(need, layering));
    let left = (share - rounding).max(LEAST_SHARE * share);
    let each = left / parts().count() as f64;
    let mut error = rounding;
    let nodes = |part: &Part| {
        let (nodes, added) = part.nodes(each);
        error += added;
        nodes
    };
    let kernels = kernels(&layers, nodes);
    (Variant::Layered(kernels), Some(error))
}

impl Part {
    /// The fewest nodes whose error arrives with at most `most`, and that error.
    fn nodes(&self, most: f64) -> (Nodes, f64) {
        let Some(way) = &self.way else {
            let bound = Bound::new(samples(&self.bins, widened(self.span.0, self.span.1)));
            return fewest(&bound, widened(self.span.0, self.span.1), most, false);
        };
        let shares = if way.gain(0.0) > FEW_TIMES * way.gain(1.0) {
            ORIGINS
        } else {
            &ORIGINS[..1]
        };
        let choices = shares.iter().map(|&share| self.nodes_from(way, share, most));
        let best = choices.min_by(|(a, a_error), (b, b_error)| {
            let exceeds = |error: f64| (error / most).max(1.0);
            exceeds(*a_error)
                .total_cmp(&exceeds(*b_error))
                .then(a.terms().cmp(&b.terms()))
        });
        best.expect("at least one origin")
    }

    /// The same with kernels interpolated from the origin `share` γ of the gate.
    fn nodes_from(&self, way: &Way, share: f64, most: f64) -> (Nodes, f64) {
        let origin = share * way.through.gate.gammas[way.kernel];
        let beyond = |(near, far): (f64, f64)| ((near - origin).max(0.0), (far - origin).max(0.0));
        let bins: Vec<_> = self
            .bins
            .iter()
            .map(|&(scales, light)| (beyond(scales), light))
            .collect();
        let (least, far) = beyond(self.span);
        let wide = widened(least, far);
        let margin = if share > 0.0 { QUOTIENT_MARGIN } else { 1.0 };
        let gain = margin * way.gain(share);
        let (nodes, error) = fewest(&Bound::new(samples(&bins, wide)), wide, most / gain, false);
        let span = (wide.0 + origin, wide.1 + origin);
        let nodes = if origin > 0.0 {
            Nodes::chebyshev_from(origin, span, nodes.terms())
        } else {
            nodes
        };
        (nodes, error * gain)
    }
}

impl Way {
    fn gain(&self, share: f64) -> f64 {
        self.through.gain(self.kernel, share)
    }
}

/// Bound of the rounding at all gates.
fn gate_rounding(need: &ScatterNeed<'_>, layering: &Layering) -> f64 {
    let ScatterNeed {
        bounds,
        water,
        channel,
        ..
    } = *need;
    let passages = Passages::new(water, channel, layering, bounds.widest_px);
    // Channels share transforms, so each has the rounding of the brightest.
    let light = |l: usize| {
        let spans = layering.spans_m.iter().skip(l).flatten();
        let lights = spans.flat_map(|&span| [0, 1, 2].map(|c| gates::brightest(bounds, water, c, span)));
        lights.fold(0.0, f64::max)
    };
    let layers = 1..layering.count();
    let rounding = layers.map(|l| match passages.of_layer(l) {
        Passage::Through(through) => through.rounding(light(l)),
        Passage::Open | Passage::Closed => 0.0,
    });
    rounding.sum()
}

fn kernels(layers: &[[Option<Part>; 2]], mut nodes: impl FnMut(&Part) -> Nodes) -> Vec<Kernels> {
    let kernels = layers.iter().map(|[narrow, wide]| Kernels {
        narrow: narrow.as_ref().map(&mut nodes),
        wide: wide.as_ref().map(&mut nodes),
    });
    kernels.collect()
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
        return vec![kernels.parts((nearest, farthest), &bins.collect::<Vec<_>>(), None)];
    };
    let passages = Passages::new(water, channel, layering, bounds.widest_px);
    let of_layer = |(l, span): (usize, &Option<(f64, f64)>)| {
        let Some((near, far)) = *span else {
            return [None, None];
        };
        let through = match passages.of_layer(l) {
            Passage::Open => None,
            Passage::Through(through) => Some(through),
            Passage::Closed => return [None, None],
        };
        // What is hidden takes ranges and light of its layer, in any combination.
        let light = gates::brightest(bounds, water, channel, (near, far));
        let steps = steps((near, far)).map(|step| (step, spread_by(light, step)));
        let lit = steps.filter(|(_, light)| *light > 0.0);
        kernels.parts((near, far), &lit.collect::<Vec<_>>(), through)
    };
    layering.spans_m.iter().enumerate().map(of_layer).collect()
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
    fn parts(
        &self,
        span: (f64, f64),
        lit: &[((f64, f64), f64)],
        through: Option<Through>,
    ) -> [Option<Part>; 2] {
        let of = |kernel: usize, spread: Spread, taken: &dyn Fn((f64, f64)) -> f64| {
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
                way: through.map(|through| Way { through, kernel }),
            })
        };
        match self.tail {
            None => [of(0, self.spread, &|_| 1.0), None],
            Some(tail) => [
                of(0, self.spread, &|(near, _)| {
                    1.0 - tail.share_at(self.channel, near)
                }),
                of(1, tail.spread, &|(_, far)| tail.share_at(self.channel, far)),
            ],
        }
    }
}
