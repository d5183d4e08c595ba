//! The water stage; without water or range the picture is unchanged (Algorithm 1's else branch).

use imaging::{Plane, Rgb};
use optics::chain::{self, Layers};
use optics::forward_scatter::KernelCache;
use optics::plan::{Stage, StageId, assess_water, water_gain};

use crate::assessment::Assessment;
use crate::context::FrameContext;
use crate::error::RenderError;

/// Attenuation, veil, occlusion and forward scatter, within the remainder of the tolerance.
pub(crate) fn assess(assessment: &Assessment<'_>, others: &[Stage]) -> Vec<Stage> {
    let Assessment { context, bounds, .. } = assessment;
    match &context.setting.around {
        Some(water) => {
            let share = assessment.budget.water(others.iter(), water_gain(bounds, water));
            assess_water(bounds, water, context.frame.fidelity, share)
        }
        None => {
            let scatter = (0..3).map(StageId::ForwardScatter);
            let stages = std::iter::once(StageId::Attenuation).chain(scatter);
            stages.map(Stage::skipped).collect()
        }
    }
}

/// Applies the water to the lit scene.
pub(crate) fn run(
    context: &FrameContext<'_>,
    radiance: &Rgb<f32>,
    kernels: &mut KernelCache,
) -> Result<Layers, RenderError> {
    match (&context.setting.around, context.path()) {
        (Some(water), Some(path)) => Ok(chain::water(radiance, path, water, &context.plan, kernels)?),
        _ => Ok(in_air(radiance)),
    }
}

/// Without water all light is direct.
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
pub(crate) fn transmittance(context: &FrameContext<'_>) -> Rgb<f32> {
    match (&context.setting.water, context.path()) {
        (Some(water), Some(path)) => chain::transmittance(path, water),
        _ => {
            let (width, height) = context.setting.size;
            let ones = || Plane::filled(width, height, 1.0f32);
            Rgb::new([ones(), ones(), ones()]).expect("planes of one size")
        }
    }
}
