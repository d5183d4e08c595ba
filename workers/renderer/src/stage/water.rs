//! The water stage, or the picture as it is where there is no water or no range (Algorithm 1's else branch), and the glow of the
//! water before lamps.

use imaging::{Plane, Rgb};
use optics::chain::{self, Layers};
use optics::forward_scatter::KernelCache;
use optics::lamp::{self, Lighting, REFERENCE_NODES};
use optics::plan::{Form, Plan};
use optics::setting::Setting;

use super::light::{Lit, any_light};
use super::scene::Prepared;
use crate::error::RenderError;
use crate::stopwatch::Stopwatch;

/// Takes the scene under water.
pub(crate) fn run(
    lit: &Lit<'_>,
    setting: &Setting,
    plan: &Plan,
    kernels: &mut KernelCache,
) -> Result<Layers, RenderError> {
    match (&setting.around, &lit.path) {
        (Some(water), Some(path)) => Ok(chain::water(&lit.radiance, path, water, plan, kernels)?),
        _ => Ok(in_air(&lit.radiance)),
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

/// Adds the glow of the water to the picture and to its backscatter; returns whether there is any.
pub(crate) fn glow(
    prepared: &Prepared,
    setting: &Setting,
    plan: &Plan,
    layers: &mut Layers,
    watch: &mut Stopwatch,
) -> bool {
    match (&setting.lighting, &prepared.scene.range) {
        (Some(lighting), Some(range)) if plan.glow.form != Form::Skip => {
            watch.time("lamps", || add_glow(range, lighting, plan, layers))
        }
        _ => false,
    }
}

fn add_glow(range: &Plane<f32>, lighting: &Lighting, plan: &Plan, layers: &mut Layers) -> bool {
    let glow = if plan.glow.form == Form::Reference {
        let range = range.map(|&z| f64::from(z));
        lamp::airlight_reference(&range, lighting, REFERENCE_NODES).map(|&v| v as f32)
    } else {
        lamp::airlight(range, lighting, plan.glow.share.unwrap_or_default())
    };
    for layer in [&mut layers.backscatter, &mut layers.scattered] {
        for (plane, glow) in layer.planes_mut().into_iter().zip(glow.planes()) {
            plane
                .iter_mut()
                .zip(glow.data())
                .for_each(|(sum, glow)| *sum += glow);
        }
    }
    any_light(&glow)
}

/// Transmittance of every pixel; 1 without water.
pub(crate) fn transmittance(lit: &Lit<'_>, setting: &Setting) -> Rgb<f32> {
    match (&setting.water, &lit.path) {
        (Some(water), Some(path)) => chain::transmittance(path, water),
        _ => {
            let (width, height) = setting.size;
            let ones = Plane::filled(width, height, 1.0f32);
            Rgb::new([ones.clone(), ones.clone(), ones]).expect("planes of one size")
        }
    }
}
