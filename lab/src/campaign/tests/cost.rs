//! Cost of the plan of water alone, compared with the cheapest plan within the tolerance.

use optics::chain;
use optics::forward_scatter::KernelCache;
use optics::medium::{Medium, Surroundings};
use optics::plan::{Plan, SceneBounds, StageId, Variant};
use optics::water::Water;
use spec::{Fidelity, Frame};

use super::super::case::Picture;

/// Cost of the plan over that of the cheapest sufficient one for each channel, in transforms: one for each kernel, the inverse, and
/// about half of one for the rest. `None` if the frame cannot be rendered.
pub(super) fn measure_excess(frame: &Frame, picture: &Picture) -> Option<[f64; 3]> {
    let Fidelity::Tolerance(tolerance) = frame.fidelity else {
        return None;
    };
    let medium = Medium::choose(&frame.water, &Surroundings::of_frame(frame))?;
    let water = Water::resolve(&medium, frame.camera.focal_px(picture.range.width())).ok()?;
    let light = picture.radiance.map(|&j| f64::from(j));
    let exact = chain::water_reference(&light, &picture.range.map(|&z| f64::from(z)), &water).ok()?;
    let mut trial = Trial {
        bounds: SceneBounds::measure(&picture.radiance, &picture.range, &water),
        picture,
        water,
        tolerance,
        exact: exact.scattered,
        cache: KernelCache::new(),
    };
    let planned = trial.plan(Fidelity::Tolerance(tolerance));
    let [planned, cheapest] = [kernels(&planned), kernels(&trial.find_cheapest(&planned))];
    Some([0, 1, 2].map(|channel| transforms(planned[channel]) / transforms(cheapest[channel])))
}

/// A picture in water, and its reference.
struct Trial<'a> {
    picture: &'a Picture,
    water: Water,
    bounds: SceneBounds,
    tolerance: f64,
    exact: imaging::Rgb<f64>,
    cache: KernelCache,
}

impl Trial<'_> {
    fn plan(&self, fidelity: Fidelity) -> Plan {
        Plan::for_water(&self.bounds, &self.water, fidelity)
    }

    fn render(&mut self, plan: &Plan) -> Option<chain::Layers> {
        let Picture { radiance, range } = self.picture;
        chain::water(radiance, range, &self.water, plan, &mut self.cache).ok()
    }

    /// Whether the error of each channel is within the tolerance.
    fn find_sufficient(&mut self, plan: &Plan) -> [bool; 3] {
        let Some(layers) = self.render(plan) else {
            return [false; 3];
        };
        [0, 1, 2].map(|channel| {
            let exact = self.exact.planes()[channel].data().iter();
            let mut pairs = layers.scattered.planes()[channel].data().iter().zip(exact);
            pairs.all(|(&fast, exact)| (f64::from(fast) - exact).abs() <= self.tolerance)
        })
    }

    /// The plan with the fewest kernels in each channel whose errors are within the tolerance.
    fn find_cheapest(&mut self, plan: &Plan) -> Plan {
        let most = kernels(plan).into_iter().max().unwrap_or(0);
        let mut variants: Vec<[Variant; 3]> = Vec::new();
        if most > 0 {
            variants.extend([Variant::Skip, Variant::Pointwise].map(|one| [one.clone(), one.clone(), one]));
        }
        for terms in 1..most {
            let plan = self.plan(Fidelity::Terms(terms));
            variants.push(SCATTER.map(|id| plan.variant(id).clone()));
        }
        let mut cheapest = plan.clone();
        let mut found = [false; 3];
        for variants in variants {
            let mut cheaper = plan
                .clone()
                .with_variant(StageId::Attenuation, Variant::Fast("f32"));
            for (id, variant) in SCATTER.into_iter().zip(variants) {
                cheaper = cheaper.with_variant(id, variant);
            }
            let sufficient = self.find_sufficient(&cheaper);
            for channel in (0..3).filter(|&channel| sufficient[channel]) {
                let saves = kernels(&cheaper)[channel] < kernels(plan)[channel];
                if saves && !std::mem::replace(&mut found[channel], true) {
                    let id = SCATTER[channel];
                    cheapest = cheapest.with_variant(id, cheaper.variant(id).clone());
                }
            }
        }
        cheapest
    }
}

/// Forward scatter of each channel.
const SCATTER: [StageId; 3] = [
    StageId::ForwardScatter(0),
    StageId::ForwardScatter(1),
    StageId::ForwardScatter(2),
];

/// Cost in transforms of a channel with this many kernels.
fn transforms(kernels: usize) -> f64 {
    if kernels == 0 { 0.5 } else { kernels as f64 + 1.5 }
}

/// Kernels of each channel.
fn kernels(plan: &Plan) -> [usize; 3] {
    SCATTER.map(|id| plan.variant(id).kernels().unwrap_or(0))
}
