//! Methods of spreading the scattered light of a frame, each pixel by the kernel of its range.

use imaging::{Plane, Rgb};
use optics::attenuation::scattered_share;
use optics::chain;
use optics::forward_scatter::{KernelCache, Nodes, scatter, scatter_reference, widest_px};
use optics::plan::{Plan, SceneBounds, StageId, Variant};
use optics::range::is_hole;
use optics::water::Scatter;
use spec::{Fidelity, ScatterModel};

use super::bench::{Bench, DEFAULT_TOLERANCE, coastal};
use super::scenes::ChartScene;
use crate::measurement::Measurement;

/// Input of the stage: light to spread and kernel scale for each channel, and the image to add it to.
struct Input {
    light: [Plane<f32>; 3],
    gamma: [Plane<f32>; 3],
    rest: Rgb<f32>,
    steps: [Variant; 3],
}

impl Input {
    fn new(scene: &ChartScene) -> Option<Self> {
        let (width, height) = scene.range.size();
        let water = coastal(width, ScatterModel::Jaffe)?;
        let Scatter::Jaffe { g, spread, .. } = *water.scatter() else {
            return None;
        };
        let c = water.direct_attenuation();
        let meters = scene.range.map(|&z| if is_hole(z) { 1.0 } else { z });
        let light = [0, 1, 2].map(|channel| {
            let excess = (c[channel] - g[channel]) as f32;
            Plane::from_fn(width, height, |x, y| {
                let lit = f32::from(u8::from(!is_hole(scene.range.pixel(x, y))));
                let share = scattered_share(g[channel] as f32, excess, meters.pixel(x, y));
                lit * scene.radiance.pixel(x, y)[channel] * share
            })
        });
        let widest = widest_px(width, height);
        let gamma =
            [0, 1, 2].map(|channel| meters.map(|&z| spread.gamma(channel, f64::from(z), widest) as f32));
        let plan = Plan::default().with_variant(StageId::Attenuation, Variant::Fast("f32"));
        let cache = &mut KernelCache::new();
        let layers = chain::water(&scene.radiance, &scene.range, &water, &plan, cache).ok()?;
        let stats = SceneBounds::measure(&scene.radiance, &scene.range, &water);
        let planned = Plan::for_water(&stats, &water, Fidelity::Tolerance(DEFAULT_TOLERANCE));
        Some(Self {
            light,
            gamma,
            rest: layers.scattered,
            steps: [0, 1, 2].map(|channel| planned.variant(StageId::ForwardScatter(channel)).clone()),
        })
    }

    /// The image plus the light spread by a variant.
    fn image(&self, mut spread: impl FnMut(usize, &Plane<f32>, &Plane<f32>) -> Plane<f32>) -> Rgb<f32> {
        Rgb::new([0, 1, 2].map(|c| {
            let forward = spread(c, &self.light[c], &self.gamma[c]);
            let sums = forward.data().iter().zip(self.rest.planes()[c].data());
            let (width, height) = forward.size();
            Plane::new(width, height, sums.map(|(f, r)| f + r).collect()).expect("the size of the light")
        }))
        .expect("planes of one frame")
    }

    /// Smallest and largest kernel scale of lit pixels.
    fn span(&self, channel: usize) -> (f64, f64) {
        let lit = self.light[channel].data().iter().zip(self.gamma[channel].data());
        lit.filter(|(u, _)| **u > 0.0)
            .fold((f64::INFINITY, 0.0), |(low, high), (_, &gamma)| {
                (low.min(f64::from(gamma)), high.max(f64::from(gamma)))
            })
    }

    /// Each range transformed separately in f64.
    fn reference(&self) -> Rgb<f32> {
        let exact = std::thread::scope(|scope| {
            let channels = [0, 1, 2].map(|c| {
                let [light, gamma] =
                    [&self.light[c], &self.gamma[c]].map(|plane| plane.map(|&v| f64::from(v)));
                scope.spawn(move || scatter_reference(&light, &gamma).map(|&v| v as f32))
            });
            channels.map(|thread| thread.join().expect("the reference does not fail"))
        });
        self.image(|c, _, _| exact[c].clone())
    }
}

/// Measures every variant on one scene.
pub(super) fn measure(scene: &ChartScene, runs: usize) -> Vec<Measurement> {
    let Some(input) = Input::new(scene) else {
        return Vec::new();
    };
    let exact = input.reference();
    let mut bench = Bench::new("forward_scatter", scene, runs);
    let mut cache = KernelCache::new();
    let spans = [0, 1, 2].map(|c| input.span(c));
    for terms in 2..=16 {
        bench.measure("chebyshev", Some(terms), &exact, || {
            input.image(|c, light, gamma| {
                let nodes = Nodes::chebyshev(spans[c].0, spans[c].1, terms);
                scatter(light, gamma, &nodes, &mut cache)
            })
        });
    }
    let most_terms = input.steps.iter().filter_map(Variant::kernels).max();
    bench.measure("planned", most_terms, &exact, || {
        input.image(|c, light, gamma| match &input.steps[c] {
            Variant::Interpolated(nodes) => scatter(light, gamma, nodes, &mut cache),
            Variant::Pointwise => light.clone(),
            _ => light.map(|_| 0.0),
        })
    });
    bench.finish("planned")
}
