//! Forward scatter of one channel with two kernels in each path, or behind gates.
//!
//! Each layer and each of its kernels has separate nodes: a wide kernel needs few, and only low frequencies.

mod part;
mod two;

use spec::Fidelity;

use crate::forward_scatter::{Bound, Coarseness, Kernels, Nodes, widest_px};
use crate::kernel;
use crate::layering::Layering;
use crate::plan::passages::{Passage, Passages};
use crate::plan::terms::{
    Chosen, MOST_TERMS, SPAN_STEP, ScatterNeed, WORST_MARGIN, largest_share, samples, widened, widened_to,
};
use crate::plan::{Variant, gates};
use crate::water::Scatter;
use part::{Part, Way};
use two::{Behind, Two};

/// Layers between gates have narrow spans, and kernels that follow from the range of the gates: similar frames do not share them.
const GATED_SPAN_STEP: f64 = 1.0 / 256.0;
/// Coarse rows may use up this share of the error of the kernels.
const COARSE_SHARE: f64 = 1.0 / 8.0;
/// Rows of a usual frame, to compare origins.
const USUAL_HEIGHT: usize = 492;
/// Sum of the absolute shares of all nodes in a pixel: below 1.5 for the numbers of nodes of wide kernels, with a margin for one
/// outside its best position.
const LEBESGUE: f64 = 3.0;
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

impl Part {
    fn brightest(&self) -> f64 {
        self.bins.iter().map(|(_, light)| *light).fold(0.0, f64::max)
    }
}

pub(crate) fn choose(need: &ScatterNeed<'_>, fidelity: Fidelity, share: f64) -> Chosen {
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
        let nodes = |part: &Part| part.with_passing(Nodes::chebyshev(part.span.0, part.span.1, terms));
        let kernels = kernels(&layers, |part| (nodes(part), Coarseness::default()));
        return (Variant::Layered(kernels), None);
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
    let coarse = COARSE_SHARE * left;
    let mut choices: Vec<Choice<'_>> = parts().map(Choice::new).collect();
    improve(&mut choices, left - coarse);
    let error = rounding + coarse + choices.iter().map(|choice| choice.error).sum::<f64>();
    let most = coarse / choices.len() as f64;
    let mut chosen = choices.into_iter();
    let kernels = kernels(&layers, |part| {
        let nodes = chosen.by_ref().next().expect("a choice for each part").nodes;
        let coarse = part.coarse(most, &nodes);
        (nodes, coarse)
    });
    (Variant::Layered(kernels), Some(error))
}

impl Part {
    /// Coarse rows whose error arrives with at most `most`.
    fn coarse(&self, most: f64, nodes: &Nodes) -> Coarseness {
        let light = LEBESGUE * (self.brightest() + self.passing_light);
        let origins = self.origins().into_iter().map(|share| {
            let (origin, gain) = match &self.way {
                Some(way) => (share * way.through.gate.gammas[way.kernel], way.gain(share)),
                None => (0.0, 1.0),
            };
            let margin = if share > 0.0 { QUOTIENT_MARGIN } else { 1.0 };
            Coarseness {
                limit: most / (light * gain * margin),
                origin,
            }
        });
        let rows = |coarse: &Coarseness| -> usize {
            let rows = (0..nodes.terms()).map(|k| coarse.rows(nodes.gamma(k), USUAL_HEIGHT));
            rows.map(|rows| rows.unwrap_or(USUAL_HEIGHT)).sum()
        };
        origins.min_by_key(rows).unwrap_or_default()
    }
}

/// Adds nodes to the part with the largest error until all together err by at most `most`.
fn improve(choices: &mut [Choice<'_>], most: f64) {
    while choices.iter().map(|choice| choice.error).sum::<f64>() > most {
        let open = choices.iter_mut().filter(|choice| choice.terms < MOST_TERMS);
        let Some(worst) = open.max_by(|a, b| a.error.total_cmp(&b.error)) else {
            return;
        };
        worst.take(worst.terms + 1);
    }
}

/// Nodes of a part, and those it could have.
struct Choice<'a> {
    part: &'a Part,
    ladders: Vec<Ladder>,
    /// The number of nodes; those of a narrow span are fewer.
    terms: usize,
    nodes: Nodes,
    error: f64,
}

impl<'a> Choice<'a> {
    /// The part with a single node.
    fn new(part: &'a Part) -> Self {
        let mut choice = Self {
            part,
            ladders: part.ladders(),
            terms: 0,
            nodes: Nodes::chebyshev(0.0, 0.0, 1),
            error: f64::INFINITY,
        };
        choice.take(1);
        choice
    }

    /// Chooses the best nodes with this number of terms.
    fn take(&mut self, terms: usize) {
        self.terms = terms;
        let nodes = self.ladders.iter().map(|ladder| ladder.nodes(self.part, terms));
        let best = nodes.min_by(|(_, a), (_, b)| a.total_cmp(b));
        (self.nodes, self.error) = best.expect("at least one origin");
    }
}

/// How nodes of one part are interpolated from one origin.
struct Ladder {
    bound: Bound,
    /// Kernel scales less the origin, pixels.
    span: (f64, f64),
    origin: f64,
    /// Factor of an interpolation error at the camera.
    gain: f64,
}

impl Ladder {
    /// `terms` nodes, and the largest error at the camera.
    fn nodes(&self, part: &Part, terms: usize) -> (Nodes, f64) {
        let span = (self.span.0 + self.origin, self.span.1 + self.origin);
        let nodes = part.with_passing(Nodes::chebyshev_from(self.origin, span, terms));
        let beyond = |k: usize| (nodes.gamma(k) - self.origin).max(0.0);
        let gammas: Vec<f64> = (0..nodes.terms()).map(beyond).collect();
        let error = WORST_MARGIN * self.bound.errors(&gammas).worst * self.gain;
        (nodes, error)
    }
}

impl Part {
    /// Nodes including the scale of the light that passes the gate behind.
    fn with_passing(&self, nodes: Nodes) -> Nodes {
        match self.passing {
            Some(gamma) => nodes.with_node_at(gamma),
            None => nodes,
        }
    }

    /// One ladder for each origin to try.
    fn ladders(&self) -> Vec<Ladder> {
        let Some(way) = &self.way else {
            let step = match self.passing {
                Some(_) => GATED_SPAN_STEP,
                None => SPAN_STEP,
            };
            let span = widened_to(step, self.span.0, self.span.1);
            return vec![Ladder {
                bound: Bound::new(samples(&self.bins, span)),
                span,
                origin: 0.0,
                gain: 1.0,
            }];
        };
        let origins = self.origins().into_iter();
        origins.map(|share| self.ladder_from(way, share)).collect()
    }

    /// Origins to try, as shares of the kernel's scale at the gate in front.
    fn origins(&self) -> Vec<f64> {
        let Some(way) = &self.way else {
            return vec![0.0];
        };
        let shares = if way.gain(0.0) > FEW_TIMES * way.gain(1.0) {
            ORIGINS
        } else {
            &ORIGINS[..1]
        };
        // A kernel narrower than the origin cannot be divided by it.
        let origin = |share: f64| share * way.through.gate.gammas[way.kernel];
        let fits = |share: &f64| *share == 0.0 || origin(*share) <= self.passing.unwrap_or(f64::INFINITY);
        shares.iter().copied().filter(fits).collect()
    }

    /// Kernels interpolated from the origin `share` γ of the gate.
    fn ladder_from(&self, way: &Way, share: f64) -> Ladder {
        let origin = share * way.through.gate.gammas[way.kernel];
        let beyond = |(near, far): (f64, f64)| ((near - origin).max(0.0), (far - origin).max(0.0));
        let bins: Vec<_> = self
            .bins
            .iter()
            .map(|&(scales, light)| (beyond(scales), light))
            .collect();
        let (least, far) = beyond(self.span);
        let span = widened_to(GATED_SPAN_STEP, least, far);
        let margin = if share > 0.0 { QUOTIENT_MARGIN } else { 1.0 };
        Ladder {
            bound: Bound::new(samples(&bins, span)),
            span,
            origin,
            gain: margin * way.gain(share),
        }
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

fn kernels(
    layers: &[[Option<Part>; 2]],
    mut choose: impl FnMut(&Part) -> (Nodes, Coarseness),
) -> Vec<Kernels> {
    let kernels = layers.iter().map(|[narrow, wide]| {
        let (narrow, narrow_coarse) = narrow.as_ref().map(&mut choose).unzip();
        let (wide, wide_coarse) = wide.as_ref().map(&mut choose).unzip();
        Kernels {
            narrow,
            wide,
            narrow_coarse: narrow_coarse.unwrap_or_default(),
            wide_coarse: wide_coarse.unwrap_or_default(),
        }
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
        return vec![kernels.parts((nearest, farthest), &bins.collect::<Vec<_>>(), None, None)];
    };
    let passages = Passages::new(water, channel, layering, bounds.widest_px);
    let of_layer = |(l, span): (usize, &Option<(f64, f64)>)| {
        let through = match passages.of_layer(l) {
            Passage::Open => None,
            Passage::Through(through) => Some(through),
            Passage::Closed => return [None, None],
        };
        let is_last = l + 1 == layering.count();
        let behind = match (!is_last).then(|| passages.of_layer(l + 1)) {
            Some(Passage::Through(behind)) => Some(behind.gate),
            _ => None,
        };
        // Occluded pixels have any combination of the ranges and light of their layer.
        let lit = span.map_or(Vec::new(), |(near, far)| {
            let light = gates::brightest(bounds, water, channel, (near, far));
            let steps = steps((near, far)).map(|step| (step, spread_by(light, step)));
            steps.filter(|(_, light)| *light > 0.0).collect()
        });
        let lights = layering.spans_m[l + 1..].iter().flatten();
        let lights = lights.map(|&span| gates::brightest(bounds, water, channel, span));
        let behind = behind.map(|gate| Behind {
            gate,
            light: lights.fold(0.0, f64::max),
        });
        kernels.parts(span.unwrap_or_default(), &lit, through, behind)
    };
    layering.spans_m.iter().enumerate().map(of_layer).collect()
}

/// A span of ranges in steps of equal ratio.
fn steps((near, far): (f64, f64)) -> impl Iterator<Item = (f64, f64)> {
    let ratio = (far / near).powf(1.0 / f64::from(STEPS));
    (0..STEPS).map(move |step| (near * ratio.powi(step), near * ratio.powi(step + 1)))
}
