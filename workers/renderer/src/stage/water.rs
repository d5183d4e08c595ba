//! The water stage, or the picture as it is where there is no water or no range (Algorithm 1's else branch).

use imaging::{Plane, Rgb};
use optics::HazeLight;
use optics::chain::{self, Layers};
use optics::forward_scatter::KernelCache;
use optics::plan::{Fidelity, Plan, SceneStats};
use optics::water::Water;
use spec::Frame;

use super::scene::Prepared;
use crate::error::RenderError;

/// What was chosen for a frame.
pub(crate) struct Chosen {
    /// The water with all its numbers; `None` where the stage is skipped.
    pub(crate) water: Option<Water>,
    /// What runs.
    pub(crate) plan: Plan,
}

/// Completes the water and plans the frame.
pub(crate) fn choose(
    frame: &Frame,
    prepared: &Prepared,
    lights: &[HazeLight],
) -> Result<Chosen, RenderError> {
    let style_weight = frame.water.style.as_ref().map(|_| frame.alpha);
    let water = match spec::water_request(frame) {
        None => None,
        Some(request) => Some(Water::resolve(&request, prepared.focal_px).map_err(RenderError::Water)?),
    };
    let (Some(water), Some(range)) = (water, &prepared.scene.range) else {
        return Ok(Chosen {
            water: None,
            plan: Plan::without_water(style_weight, lights),
        });
    };
    let stats = SceneStats::measure(&prepared.scene.radiance, range, &water);
    let plan = Plan::for_frame(&stats, &water, style_weight, lights, fidelity(frame));
    Ok(Chosen {
        water: Some(water),
        plan,
    })
}

fn fidelity(frame: &Frame) -> Fidelity {
    match frame.fidelity {
        spec::Fidelity::Tolerance(tolerance) => Fidelity::Tolerance(tolerance),
        spec::Fidelity::Display => Fidelity::Display,
        spec::Fidelity::Terms(terms) => Fidelity::Terms(terms),
        spec::Fidelity::Reference => Fidelity::Reference,
    }
}

/// Takes the scene under water.
pub(crate) fn run(
    prepared: &Prepared,
    chosen: &Chosen,
    kernels: &mut KernelCache,
) -> Result<Layers, RenderError> {
    let radiance = &prepared.scene.radiance;
    match (&chosen.water, &prepared.scene.range) {
        (Some(water), Some(range)) => Ok(chain::water(radiance, range, water, &chosen.plan, kernels)?),
        _ => Ok(in_air(radiance)),
    }
}

/// Without water all light arrives on its own ray.
fn in_air(radiance: &Rgb<f32>) -> Layers {
    let nothing = radiance.map(|_| 0.0);
    Layers {
        direct: radiance.clone(),
        forward_scatter: nothing.clone(),
        backscatter: nothing,
        scattered: radiance.clone(),
        holes: 0,
    }
}

/// Transmittance of every pixel; 1 without water.
pub(crate) fn transmittance(prepared: &Prepared, chosen: &Chosen) -> Rgb<f32> {
    match (&chosen.water, &prepared.scene.range) {
        (Some(water), Some(range)) => chain::transmittance(range, water),
        _ => {
            let (width, height) = prepared.scene.radiance.size();
            let ones = Plane::filled(width, height, 1.0f32);
            Rgb::new([ones.clone(), ones.clone(), ones]).expect("planes of one size")
        }
    }
}
