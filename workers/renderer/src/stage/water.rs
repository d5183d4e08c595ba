//! The water stage, or the picture as it is where there is no water or no range (Algorithm 1's else branch).

use imaging::{Plane, Rgb};
use optics::chain::{self, Layers};
use optics::forward_scatter::KernelCache;
use optics::plan::{Plan, SceneStats};
use optics::water::{RULES, Water};
use spec::{Frame, Haze};

use super::scene::Prepared;
use super::shares::Shares;
use super::turbidity::Patches;
use crate::error::RenderError;

/// What was chosen for a frame.
pub(crate) struct Chosen {
    /// The water with all its numbers; `None` where the stage is skipped.
    pub(crate) water: Option<Water>,
    /// The water that the stage runs with: of a scene that lamps have lit, its ambient light is applied already.
    around: Option<Water>,
    /// Patches of murkier water; none in even water.
    pub(crate) patches: Option<Patches>,
    /// What the errors of the stages may be.
    pub(crate) shares: Shares,
    /// What runs.
    pub(crate) plan: Plan,
}

impl Chosen {
    /// Metres of water before each pixel: its range, or its path through patches.
    pub(crate) fn path<'a>(&'a self, prepared: &'a Prepared) -> Option<&'a Plane<f32>> {
        let patches = self.patches.as_ref().map(|patches| &patches.path);
        patches.or(prepared.scene.range.as_ref())
    }
}

/// The water of a frame with all its numbers; `None` without optics or without range.
pub(crate) fn resolve(frame: &Frame, prepared: &Prepared) -> Result<Option<Water>, RenderError> {
    if frame.water.optics.is_none() || prepared.scene.range.is_none() {
        return Ok(None);
    }
    let water = if frame.has_lamps() {
        Water::resolve_lit(&frame.water, prepared.focal_px)
    } else {
        Water::resolve(&frame.water, prepared.focal_px)
    };
    Ok(Some(water.map_err(RenderError::Water)?))
}

/// Plans the frame for the light that its scene has.
pub(crate) fn choose(
    frame: &Frame,
    prepared: &Prepared,
    lit: Option<&Rgb<f32>>,
    (water, patches): (Option<Water>, Option<Patches>),
    lights: &[Haze],
) -> Chosen {
    let style_weight = frame.water.style.as_ref().map(|_| frame.alpha);
    let (Some(water), Some(range)) = (water, &prepared.scene.range) else {
        return Chosen {
            water: None,
            around: None,
            patches: None,
            shares: Shares::without_water(frame),
            plan: Plan::without_water(style_weight, lights),
        };
    };
    let around = match lit {
        Some(_) => water.with_light_applied(),
        None => water.clone(),
    };
    let path = patches.as_ref().map_or(range, |patches| &patches.path);
    let stats = SceneStats::measure(lit.unwrap_or(&prepared.scene.radiance), path, &around);
    let shares = Shares::of(frame, &stats, &around, lit);
    let plan = Plan::for_frame(&stats, &around, style_weight, lights, shares.fidelity(frame));
    Chosen {
        water: Some(water),
        around: Some(around),
        patches,
        shares,
        plan,
    }
}

/// A warning where the beam attenuation of a frame is a K_d.
pub(crate) fn diffuse_in_disguise(frame: &Frame) -> Option<String> {
    (RULES.warning)(frame.water.optics.as_ref()?)
}

/// Takes the scene under water.
pub(crate) fn run(
    prepared: &Prepared,
    radiance: &Rgb<f32>,
    chosen: &Chosen,
    kernels: &mut KernelCache,
) -> Result<Layers, RenderError> {
    match (&chosen.around, chosen.path(prepared)) {
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
    match (&chosen.water, chosen.path(prepared)) {
        (Some(water), Some(range)) => chain::transmittance(range, water),
        _ => {
            let (width, height) = prepared.scene.radiance.size();
            let ones = Plane::filled(width, height, 1.0f32);
            Rgb::new([ones.clone(), ones.clone(), ones]).expect("planes of one size")
        }
    }
}
