//! The water stage: `I = D + F + B`, or `F` gathered from `D + B`.
//!
//! Jaffe–McGlamery as intended: light of the scene is split, e^{−cZ} arrives unscattered, e^{−GZ} − e^{−cZ} arrives spread, and the
//! veil of the water is added to both. (The paper's Eq. 3-4 convolve attenuated light with a kernel that attenuates again;
//! `scatter_source: direct` follows them to the letter.) The simplified form, Eq. 8-9, collects the attenuated image with a kernel
//! for each pixel. The plan decides on the stages; this module runs them.

mod check;
mod fast;
mod gated_reference;
mod layers;
mod reference;

use imaging::{Plane, Rgb};

use crate::attenuation::exp_negative;
use crate::forward_scatter::KernelCache;
use crate::plan::{BY_DIRECTION, Plan, StageId, Variant};
use crate::range::{bounds, filled, is_hole};
use crate::water::Water;

pub use check::{ChainError, check_radiance};
pub use layers::Layers;
use layers::layers;
pub use reference::water as water_reference;

/// Renders a scene under water as planned. `radiance` is linear, finite and not negative ([`check_radiance`]); `range` is in meters
/// along the ray.
///
/// # Errors
/// [`ChainError`]: sizes differ, the frame is empty, holes under the rule `reject`, a reference frame too large.
pub fn water(
    radiance: &Rgb<f32>,
    range: &Plane<f32>,
    water: &Water,
    plan: &Plan,
    cache: &mut KernelCache,
) -> Result<Layers, ChainError> {
    let attenuation = plan.variant(StageId::Attenuation);
    if *attenuation == Variant::Reference {
        let layers = water_reference(
            &radiance.map(|&j| f64::from(j)),
            &range.map(|&z| f64::from(z)),
            water,
        )?;
        let single = |layer: Rgb<f64>| layer.map(|&v| v as f32);
        return Ok(Layers {
            direct: single(layers.direct),
            forward_scatter: single(layers.forward_scatter),
            backscatter: single(layers.backscatter),
            scattered: single(layers.scattered),
            holes: layers.holes,
        });
    }
    check::sizes(radiance.size(), range.size())?;
    let holes = check::holes(range, water.holes)?;
    let range = &*filled(range, water.holes);
    let steps = [0, 1, 2].map(|channel| plan.variant(StageId::ForwardScatter(channel)));
    // Only kernels need it.
    let spreads = steps.iter().any(|step| step.kernels().is_some());
    let bounds = spreads.then(|| bounds(range.data(), range.data(), f32::MAX));
    let farthest = bounds.flatten().map(|(_, farthest)| farthest);
    let is_clear = attenuation.is_skipped();
    let frame = fast::Frame {
        range,
        farthest,
        water,
        clear: is_clear,
        veil: *plan.variant(StageId::Veil) == Variant::Fast(BY_DIRECTION),
        gates: match plan.variant(StageId::Occlusion) {
            Variant::Gated(layering) => Some(layering),
            _ => None,
        },
    };
    let bands = fast::bands(&frame, radiance, steps, cache);
    cache.trim();
    Ok(layers(bands, holes))
}

impl KernelCache {
    /// Keeps the planes of unused layers for reuse in the next frame. Saves some milliseconds a frame and changes no result.
    pub fn recycle(&mut self, layers: Layers) {
        for layer in [
            layers.direct,
            layers.forward_scatter,
            layers.backscatter,
            layers.scattered,
        ] {
            self.buffers.give(layer.into_planes().map(Plane::into_data));
        }
    }
}

/// Transmittance `exp(−c Z)` of every pixel; at a hole 0 where the water attenuates and 1 where it does not.
#[must_use]
pub fn transmittance(range: &Plane<f32>, water: &Water) -> Rgb<f32> {
    let range = filled(range, water.holes);
    let band = |channel: usize| {
        let c = water.direct_attenuation[channel] as f32;
        let at_hole = f32::from(u8::from(c == 0.0));
        range.map(|&z| if is_hole(z) { at_hole } else { exp_negative(c * z) })
    };
    Rgb::new([band(0), band(1), band(2)]).expect("bands of one frame")
}
