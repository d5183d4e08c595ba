//! Lamps in a plan.

use super::shares::glow_share;
use super::{Form, Given, Stage};

/// The light of lamps, which is computed before the plan, as far as the plan depends on it. All 0 without lamps.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct LampLight {
    /// What f32 may have lost of the light on surfaces.
    pub surface_rounding: f64,
    /// What of the light on surfaces may be there that things would have cut off.
    pub shadows_left: f64,
    /// What the quadrature may have left of the glow.
    pub glow_left: f64,
    /// What f32 may have lost of the glow.
    pub glow_rounding: f64,
    /// The largest glow of a pixel.
    pub glow_peak: f64,
}

/// The glow of the water before the lamps; none where the water scatters nothing.
pub(super) fn glow(given: &Given<'_>) -> Stage {
    let lighting = given.setting.lighting.as_ref();
    let glows = lighting.is_some_and(|lighting| lighting.scattering != [0.0; 3]);
    let form = Form::asked_by(given.frame.fidelity).when(glows);
    Stage {
        form,
        share: glows.then_some(glow_share(given.frame)),
        bound: (form == Form::Fast).then_some(given.lamps.glow_left + given.lamps.glow_rounding),
    }
}
