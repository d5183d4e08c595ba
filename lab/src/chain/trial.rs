//! A frame in water, rendered by the fast chain and by the reference.

use imaging::random::Stream;
use imaging::{Plane, Rgb};
use optics::chain::{self, Layers};
use optics::forward_scatter::KernelCache;
use optics::medium::Medium;
use optics::plan::{Plan, SceneBounds};
use optics::water::Water;
use spec::{Fidelity, ForwardScatter, HoleRule, Optics, ScatterModel};

/// The default tolerance of a job.
pub(super) const TOLERANCE: f64 = 3e-4;
/// The fidelity of a job without settings.
pub(super) const DEFAULT: Fidelity = Fidelity::Tolerance(TOLERANCE);
/// Enough kernels to leave only the rounding of f32.
pub(super) const PLENTY: Fidelity = Fidelity::Terms(24);
/// Rounding of f32 in the chain for light up to 1, as assumed by the plan.
pub(super) const ROUNDING: f64 = 2e-6;
/// Forward scatter g of the coastal water, 1/m.
const G: [f64; 3] = [0.13, 0.042, 0.0315];

/// Light, range and water.
#[derive(Clone)]
pub(super) struct Trial {
    pub(super) radiance: Rgb<f32>,
    pub(super) range: Plane<f32>,
    pub(super) water: Water,
}

/// A coastal water with a spread of `spread` pixels per meter.
pub(super) fn coastal(model: ScatterModel, spread: f64) -> Water {
    coastal_with(G, model, spread, HoleRule::Background)
}

/// The same with other forward scatter and another rule for holes.
pub(super) fn coastal_with(g: [f64; 3], model: ScatterModel, spread: f64, holes: HoleRule) -> Water {
    let scatter = ForwardScatter {
        spread_px_per_m: Some([spread; 3]),
        g_per_m: Some(g),
        ..model.into()
    };
    let optics = Optics {
        beam_attenuation_per_m: Some([0.37, 0.12, 0.09]),
        veiling_light: Some([0.03, 0.12, 0.18]),
        forward_scatter: Some(scatter),
        ..Optics::default()
    };
    let request = Medium {
        holes,
        ..Medium::from(optics)
    };
    Water::resolve(&request, 500.0).expect("a consistent water")
}

/// Coastal water with other forward scatter or another rule for holes and a spread of one pixel per meter.
pub(super) fn coastal_at(g: Option<[f64; 3]>, holes: HoleRule) -> Water {
    coastal_with(g.unwrap_or(G), ScatterModel::Jaffe, 1.0, holes)
}

/// Noise from 0 to 1.
pub(super) fn noise((width, height): (usize, usize)) -> Rgb<f32> {
    let stream = Stream::stage(11, "chain stability");
    Rgb::from_fn(width, height, |x, y| {
        [0, 1, 2].map(|channel| stream.unit((y * width + x) as u64, channel) as f32)
    })
}

/// Range from top to bottom in a geometric progression.
pub(super) fn slope((width, height): (usize, usize), nearest: f32, farthest: f32) -> Plane<f32> {
    Plane::from_fn(width, height, |_, y| {
        nearest * (farthest / nearest).powf(y as f32 / (height.max(2) - 1) as f32)
    })
}

impl Trial {
    /// Noise on a slope.
    pub(super) fn on_slope(size: (usize, usize), range_m: [f32; 2], water: Water) -> Self {
        Self {
            radiance: noise(size),
            range: slope(size, range_m[0], range_m[1]),
            water,
        }
    }

    pub(super) fn plan(&self, fidelity: Fidelity) -> Plan {
        let stats = SceneBounds::measure(&self.radiance, &self.range, &self.water);
        Plan::for_water(&stats, &self.water, fidelity)
    }

    pub(super) fn render(&self, fidelity: Fidelity) -> Layers {
        self.render_with(fidelity, &mut KernelCache::new())
    }

    pub(super) fn render_with(&self, fidelity: Fidelity, cache: &mut KernelCache) -> Layers {
        let plan = self.plan(fidelity);
        chain::water(&self.radiance, &self.range, &self.water, &plan, cache).expect("a good frame")
    }

    /// The largest error of the image; infinite for a NaN.
    pub(super) fn error(&self, fidelity: Fidelity) -> f64 {
        let fast = self.render(fidelity).scattered;
        let (radiance, range) = (self.radiance.map(|&j| j.into()), self.range.map(|&z| z.into()));
        let exact = chain::water_reference(&radiance, &range, &self.water).expect("a small frame");
        let planes = fast.planes().iter().zip(exact.scattered.planes());
        let samples = planes.flat_map(|(fast, exact)| fast.data().iter().zip(exact.data()));
        let errors = samples.map(|(&f, e)| (f64::from(f) - e).abs());
        errors
            .map(|e| if e.is_nan() { f64::INFINITY } else { e })
            .fold(0.0, f64::max)
    }
}
