//! A frame in water, rendered by the fast chain and by the reference.

use imaging::random::Stream;
use imaging::{Plane, Rgb};
use optics::chain::{self, Layers};
use optics::forward_scatter::KernelCache;
use optics::medium::Medium;
use optics::plan::{Plan, SceneBounds};
use optics::water::Water;
use spec::{Fidelity, ForwardScatter, Optics, ScatterModel};

/// The default tolerance of a job.
pub(super) const TOLERANCE: f64 = 3e-4;
/// Enough kernels to leave only the rounding of f32.
pub(super) const PLENTY: Fidelity = Fidelity::Terms(24);
/// Rounding of f32 in the chain for light up to 1, as assumed by the plan.
pub(super) const ROUNDING: f64 = 2e-6;

/// Light, range and water.
pub(super) struct Trial {
    pub(super) radiance: Rgb<f32>,
    pub(super) range: Plane<f32>,
    pub(super) water: Water,
}

/// A coastal water with a spread of `spread` pixels per meter and fixed G and c.
pub(super) fn water(model: ScatterModel, spread: f64) -> Water {
    from([0.13, 0.042, 0.0315], model, [spread; 3])
}

/// The same with other G.
pub(super) fn from(g: [f64; 3], model: ScatterModel, spread: [f64; 3]) -> Water {
    let scatter = ForwardScatter {
        spread_px_per_m: Some(spread),
        g_per_m: Some(g),
        ..model.into()
    };
    let request = Medium::from(Optics {
        beam_attenuation_per_m: Some([0.37, 0.12, 0.09]),
        veiling_light: Some([0.03, 0.12, 0.18]),
        forward_scatter: Some(scatter),
        ..Optics::default()
    });
    Water::resolve(&request, 500.0).expect("a consistent water")
}

/// Noise of a given peak.
pub(super) fn noise((width, height): (usize, usize), peak: f32) -> Rgb<f32> {
    let stream = Stream::stage(11, "chain stability");
    Rgb::from_fn(width, height, |x, y| {
        [0, 1, 2].map(|channel| peak * stream.unit((y * width + x) as u64, channel) as f32)
    })
}

/// Range from top to bottom in a geometric progression.
pub(super) fn slope((width, height): (usize, usize), nearest: f32, farthest: f32) -> Plane<f32> {
    Plane::from_fn(width, height, |_, y| {
        nearest * (farthest / nearest).powf(y as f32 / (height.max(2) - 1) as f32)
    })
}

impl Trial {
    pub(super) fn plan(&self, fidelity: Fidelity) -> Plan {
        let stats = SceneBounds::measure(&self.radiance, &self.range, &self.water);
        Plan::for_water(&stats, &self.water, fidelity)
    }

    pub(super) fn fast(&self, fidelity: Fidelity) -> Layers {
        self.with(fidelity, &mut KernelCache::new())
    }

    pub(super) fn with(&self, fidelity: Fidelity, cache: &mut KernelCache) -> Layers {
        let plan = self.plan(fidelity);
        chain::water(&self.radiance, &self.range, &self.water, &plan, cache).expect("a good frame")
    }

    pub(super) fn exact(&self) -> Layers<f64> {
        let double = (self.radiance.map(|&j| j.into()), self.range.map(|&z| z.into()));
        chain::water_reference(&double.0, &double.1, &self.water).expect("a small frame")
    }

    /// The largest error of the image.
    pub(super) fn error(&self, fidelity: Fidelity) -> f64 {
        largest(&self.fast(fidelity).scattered, &self.exact().scattered)
    }
}

/// The largest difference of two pictures; NaN counts as infinite.
pub(super) fn largest(fast: &Rgb<f32>, exact: &Rgb<f64>) -> f64 {
    let planes = fast.planes().iter().zip(exact.planes());
    let samples = planes.flat_map(|(fast, exact)| fast.data().iter().zip(exact.data()));
    let errors = samples.map(|(&f, e)| (f64::from(f) - e).abs());
    errors
        .map(|e| if e.is_nan() { f64::INFINITY } else { e })
        .fold(0.0, f64::max)
}
