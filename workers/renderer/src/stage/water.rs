//! The water stage; without water or range the picture stays as it is (Algorithm 1's else branch).

use imaging::{Plane, Rgb};
use optics::chain::{self, Layers};
use optics::forward_scatter::KernelCache;

use super::{Shot, above};
use crate::error::RenderError;

/// Applies the water to the lit scene.
pub(crate) fn run(shot: &Shot<'_>, kernels: &mut KernelCache) -> Result<Layers, RenderError> {
    let radiance = shot.lit.radiance();
    match (&shot.setting.around, shot.lit.path()) {
        (Some(water), Some(path)) => {
            let mut layers = chain::water(radiance, path, water, &shot.plan, kernels)?;
            above::shine_through(&shot.setting, path, shot.lit.pattern.as_ref(), &mut layers);
            Ok(layers)
        }
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
pub(crate) fn transmittance(shot: &Shot<'_>) -> Rgb<f32> {
    match (&shot.setting.water, shot.lit.path()) {
        (Some(water), Some(path)) => chain::transmittance(path, water),
        _ => {
            let (width, height) = shot.setting.size;
            let ones = || Plane::filled(width, height, 1.0f32);
            Rgb::new([ones(), ones(), ones()]).expect("planes of one size")
        }
    }
}
