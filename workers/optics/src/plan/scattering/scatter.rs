//! Forward scatter of one channel: the cheapest variant within its tolerance.

use spec::ScatterSource;

use crate::forward_scatter::{Bound, Nodes, widest_px};
use crate::kernel;
use crate::plan::terms::{
    Chosen, ScatterNeed, WORST_MARGIN, fewest, is_point, largest_share, samples, widened,
};
use crate::plan::{Fidelity, SceneBounds, Variant, layered};
use crate::water::{Scatter, Spread, Water};

pub(crate) fn choose(need: &ScatterNeed<'_>, fidelity: Fidelity, share: f64) -> Chosen {
    let ScatterNeed {
        bounds,
        water,
        channel,
        layering,
    } = *need;
    if fidelity == Fidelity::Reference && water.scatter != Scatter::None {
        return (Variant::Reference, None);
    }
    if layering.is_some() || matches!(water.scatter, Scatter::Jaffe { tail: Some(_), .. }) {
        return layered::choose(need, fidelity, share);
    }
    let Some(light) = SpreadLight::measure(bounds, water, channel) else {
        return (Variant::Skip, None);
    };
    let (least, most) = light.span;
    let one_pixel = bounds.widest_px <= widest_px(1, 1);
    if most == 0.0 || one_pixel {
        // The kernel is a delta, or the frame is a single pixel that keeps all light.
        let step = if light.gathers {
            Variant::Skip
        } else {
            Variant::Pointwise
        };
        return (step, None);
    }
    let few = |terms: usize| {
        let distinct = bounds
            .distinct_m
            .as_ref()
            .filter(|distinct| distinct.len() <= terms)?;
        let scale = |&meters: &f32| light.spread.gamma(channel, f64::from(meters), bounds.widest_px);
        Some(Variant::Interpolated(Nodes::exact(distinct.iter().map(scale))))
    };
    match fidelity {
        Fidelity::Terms(terms) => {
            let nodes = || Variant::Interpolated(Nodes::chebyshev(least, most, terms));
            (few(terms).unwrap_or_else(nodes), None)
        }
        _ => {
            let (step, bound) = within(&light, share);
            let terms = match &step {
                Variant::Interpolated(nodes) => nodes.terms(),
                _ => return (step, Some(bound)),
            };
            few(terms).map_or((step, Some(bound)), |exact| (exact, Some(0.0)))
        }
    }
}

/// The cheapest form with an error of at most `share`, and its bound.
fn within(light: &SpreadLight, share: f64) -> (Variant, f64) {
    let (least, most) = light.span;
    // Light that leaves its pixel.
    let leaving = 1.0 - kernel::center(most);
    let moved = leaving * light.brightest;
    if moved <= share && light.gathers {
        return (Variant::Skip, moved);
    }
    if moved <= share && most < 0.5 {
        return (Variant::Pointwise, moved);
    }
    // A single kernel for all leaves even light unchanged.
    let uneven = leaving * light.unevenness;
    if uneven <= share && is_point(least, most) && !light.gathers {
        return (Variant::Pointwise, uneven);
    }
    let wide = widened(least, most);
    let bound = Bound::new(samples(&light.bins, wide));
    if !light.gathers {
        let arriving = bound.arriving() * WORST_MARGIN;
        if arriving <= share {
            return (Variant::Skip, arriving);
        }
    }
    let (nodes, error) = fewest(&bound, wide, share, light.gathers);
    (Variant::Interpolated(nodes), error)
}

/// The spread or gathered light of one channel, and its ranges.
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
    gathers: bool,
}

impl SpreadLight {
    /// `None` without light to spread.
    fn measure(bounds: &SceneBounds, water: &Water, channel: usize) -> Option<Self> {
        match water.scatter {
            Scatter::None => None,
            Scatter::Simplified { spread } => {
                let gamma = |meters: f64| spread.gamma(channel, meters, bounds.widest_px);
                let (nearest, farthest) = bounds.range_m?;
                let (low, high) = crate::plan::levels::levels(bounds, water, channel);
                Some(Self {
                    brightest: high - low,
                    unevenness: high - low,
                    span: (gamma(nearest), gamma(farthest)),
                    bins: vec![((gamma(nearest), gamma(farthest)), high - low)],
                    spread,
                    gathers: true,
                })
            }
            Scatter::Jaffe {
                g, source, spread, ..
            } => {
                let gamma = |meters: f64| spread.gamma(channel, meters, bounds.widest_px);
                let (nearest, farthest) = bounds.lit_m[channel]?;
                let c = water.direct_attenuation[channel];
                let bins = bounds.bins.iter().filter_map(|bin| {
                    let radiance = f64::from(bin.brightest[channel]) * water.radiance_gain[channel];
                    let (near, far) = (bin.meters.0.max(nearest), bin.meters.1.min(farthest));
                    let arriving = if source == ScatterSource::Direct {
                        (-c * near).exp()
                    } else {
                        1.0
                    };
                    let light =
                        radiance * arriving * largest_share(g[channel].min(c), c, near, far.max(near));
                    (near <= far && light > 0.0).then_some(((gamma(near), gamma(far)), light))
                });
                let bins: Vec<_> = bins.collect();
                let brightest = bins.iter().map(|(_, light)| *light).reduce(f64::max)?;
                let one_range =
                    !bounds.holes && bounds.range_m.is_some_and(|(near, far)| is_point(near, far));
                let dark = f64::from(bounds.darkest[channel])
                    / f64::from(bounds.brightest[channel]).max(f64::MIN_POSITIVE);
                Some(Self {
                    brightest,
                    unevenness: if one_range {
                        brightest * (1.0 - dark)
                    } else {
                        brightest
                    },
                    span: (gamma(nearest), gamma(farthest)),
                    bins,
                    spread,
                    gathers: false,
                })
            }
        }
    }
}
