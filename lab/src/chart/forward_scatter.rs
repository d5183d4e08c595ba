//! Methods of spreading the scattered light of a frame, each pixel by the kernel of its range.

use imaging::{Plane, Rgb};
use optics::attenuation::scattered_share;
use optics::chain;
use optics::forward_scatter::{KernelCache, Nodes, scatter, scatter_reference, widest_px};
use optics::medium::Medium;
use optics::plan::{Plan, SceneBounds, StageId, Variant};
use optics::range::is_hole;
use optics::water::{Scatter, Water};
use spec::{Fidelity, ForwardScatter, Optics, ScatterModel};

use super::difference::difference;
use super::spatial::{truncated, windows};
use super::stopwatch::time;
use super::weighted::{Copy, gaussians, hard_layers, linear_layers, spread};
use super::{ChartScene, Point};

const STAGE: &str = "forward_scatter";
/// Coastal water with strong forward scatter.
pub(super) const WATER: &str = "jerlov-1C";
/// The default tolerance of a job.
pub(super) const DEFAULT_TOLERANCE: f64 = 3e-4;
/// Half of a Gaussian's light is within 1.177 σ, half of the kernel's within √3 γ.
const SAME_HALF: f32 = 1.471;

/// A coastal water seen by a camera of 80° across.
pub(super) fn coastal(width: usize, model: ScatterModel) -> Option<Water> {
    let scatter = ForwardScatter::from(model);
    let request = Medium::from(Optics {
        preset: Some(WATER.to_owned()),
        forward_scatter: Some(scatter),
        ..Optics::default()
    });
    let focal_px = width as f64 / (2.0 * 40f64.to_radians().tan());
    Water::resolve(&request, focal_px).ok()
}

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
        let meters = |z: f32| if is_hole(z) { 1.0 } else { z };
        let light = |channel: usize| {
            let share = |z: f32| scattered_share(g[channel] as f32, (c[channel] - g[channel]) as f32, z);
            Plane::from_fn(width, height, |x, y| {
                let z = scene.range.pixel(x, y);
                let lit = f32::from(u8::from(!is_hole(z)));
                lit * scene.radiance.pixel(x, y)[channel] * share(meters(z))
            })
        };
        let widest = widest_px(width, height);
        let gamma = |channel| {
            scene
                .range
                .map(|&z| spread.gamma(channel, f64::from(meters(z)), widest) as f32)
        };
        let plan = Plan::default().with_variant(StageId::Attenuation, Variant::Fast("f32"));
        let layers = chain::water(
            &scene.radiance,
            &scene.range,
            &water,
            &plan,
            &mut KernelCache::new(),
        )
        .ok()?;
        let stats = SceneBounds::measure(&scene.radiance, &scene.range, &water);
        let planned = Plan::for_water(&stats, &water, Fidelity::Tolerance(DEFAULT_TOLERANCE));
        Some(Self {
            light: [0, 1, 2].map(light),
            gamma: [0, 1, 2].map(gamma),
            rest: layers.scattered,
            steps: [0, 1, 2].map(|channel| planned.variant(StageId::ForwardScatter(channel)).clone()),
        })
    }

    /// The image plus the light spread by a variant.
    fn image(&self, mut spread: impl FnMut(usize, &Plane<f32>, &Plane<f32>) -> Plane<f32>) -> Rgb<f32> {
        let channel = |c: usize| {
            let forward = spread(c, &self.light[c], &self.gamma[c]);
            let sums = forward.data().iter().zip(self.rest.planes()[c].data());
            let (width, height) = forward.size();
            Plane::new(width, height, sums.map(|(f, r)| f + r).collect()).expect("the size of the light")
        };
        Rgb::new([0, 1, 2].map(channel)).expect("planes of one frame")
    }

    fn span(&self, channel: usize) -> (f64, f64) {
        let lit = self.light[channel].data().iter().zip(self.gamma[channel].data());
        lit.filter(|(u, _)| **u > 0.0)
            .fold((f64::INFINITY, 0.0), |(low, high), (_, &gamma)| {
                (low.min(f64::from(gamma)), high.max(f64::from(gamma)))
            })
    }
}

/// Spreads the light of a channel by its kernel scales.
type Spread<'a> = dyn FnMut(usize, &Plane<f32>, &Plane<f32>) -> Plane<f32> + 'a;

/// Measures every variant on one scene; `runs` repeats each.
#[must_use]
pub fn forward_scatter(scene: &ChartScene, runs: usize) -> Vec<Point> {
    let Some(input) = Input::new(scene) else {
        return Vec::new();
    };
    let exact = std::thread::scope(|scope| {
        let channels = [0, 1, 2].map(|c| {
            let double = |plane: &Plane<f32>| plane.map(|&v| f64::from(v));
            let (light, gamma) = (double(&input.light[c]), double(&input.gamma[c]));
            scope.spawn(move || scatter_reference(&light, &gamma).map(|&v| v as f32))
        });
        channels.map(|thread| thread.join().expect("the reference does not fail"))
    });
    let reference = input.image(|c, _, _| exact[c].clone());
    let size = scene.range.size();
    let mut points = Vec::new();
    let mut add = |variant: &str, terms: Option<usize>, work: &mut Spread<'_>| {
        let (times, image) = time(runs, || input.image(&mut *work));
        points.push(Point::new(
            STAGE,
            (variant, terms),
            &scene.name,
            size,
            times,
            Some(difference(&image, &reference)),
        ));
    };
    let mut cache = KernelCache::new();
    for terms in 2..=16 {
        add("chebyshev", Some(terms), &mut |c, light, gamma| {
            let (least, most) = input.span(c);
            scatter(light, gamma, &Nodes::chebyshev(least, most, terms), &mut cache)
        });
    }
    let most_terms = input.steps.iter().filter_map(Variant::kernels);
    add(
        "planned",
        most_terms.max(),
        &mut |c, light, gamma| match &input.steps[c] {
            Variant::Interpolated(nodes) => scatter(light, gamma, nodes, &mut cache),
            Variant::Pointwise => light.clone(),
            _ => light.map(|_| 0.0),
        },
    );
    type Make = fn(f64, f64, usize, (usize, usize)) -> Vec<Copy<'static>>;
    let families: [(&str, Make, &[usize]); 3] = [
        ("hard layers", hard_layers, &[4, 8, 16, 32]),
        ("linear layers", linear_layers, &[4, 8, 16, 32]),
        ("sum of gaussians", gaussians, &[4, 6, 8, 12, 16]),
    ];
    for (name, make, counts) in families {
        for &terms in counts {
            let copies = [0, 1, 2].map(|c| {
                let (least, most) = input.span(c);
                make(least, most, terms, size)
            });
            add(name, Some(terms), &mut |c, light, gamma| {
                spread(light, gamma, &copies[c])
            });
        }
    }
    for radius in [4, 8, 16, 32] {
        add("truncated kernel", Some(radius), &mut |_, light, gamma| {
            truncated(light, gamma, radius)
        });
    }
    for window in [9, 17, 33] {
        add("window gaussian", Some(window), &mut |_, light, gamma| {
            windows(light, gamma, window, SAME_HALF)
        });
    }
    points
        .iter_mut()
        .for_each(|point| point.default = point.variant == "planned");
    points
}
