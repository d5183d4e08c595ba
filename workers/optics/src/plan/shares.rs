//! How the stages of a frame share its tolerance, so that their errors together stay within it.

use spec::{Fidelity, Frame};

use super::levels::{self, PILED_UP};
use super::{Above, Given, SceneStats, sediment};
use crate::setting::Setting;
use crate::turbidity::path_rounding;
use crate::water::Water;

/// The tolerance of a frame that gives none.
const TOLERANCE: f64 = 3e-4;
/// What changes no code of the 8-bit picture by more than one, however dark it is.
const DARK: f64 = 1.0 / 255.0 / 12.92;
/// Share of the tolerance that the glow of lamps may use up: more nodes cost little beside more kernels.
const GLOW: f64 = 0.25;
/// Share of clouds of sediment, taken only where it leaves them out.
const SEDIMENT: f64 = 0.125;
/// Share of the snow: wider discs cost next to nothing.
const SNOW: f64 = 0.125;
/// What f32 may lose where particles lie over one another, for light up to 1: half of it was seen, with thousands on one pixel.
const SNOW_ROUNDING: f64 = 4e-6;
/// What is left for the water where rounding alone uses up its share.
const LEAST: f64 = 0.125;

/// The error in linear light that each stage may have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Shares {
    /// What the frame asks for.
    pub(super) tolerance: Option<f64>,
    /// Marine snow.
    pub(super) snow: f64,
    /// Rounding of the snow.
    pub(super) snow_rounding: f64,
    /// Rounding of paths through patchy water, as it arrives in the picture.
    pub(super) path: f64,
    /// Rounding of surfaces that lamps light, as it arrives in the picture.
    pub(super) surfaces: f64,
    /// Light from above on surfaces, as it arrives in the picture.
    pub(super) above: f64,
    /// Attenuation and forward scatter; none where the frame does not ask for a tolerance.
    water: Option<f64>,
}

impl Shares {
    pub(super) fn new(given: &Given<'_>) -> Self {
        let Given {
            frame,
            setting,
            stats,
            lamps,
            ..
        } = *given;
        let around = setting.around.as_ref();
        let tolerance = tolerance(frame, stats, around);
        let snow = if frame.water.snow.is_some() { SNOW } else { 0.0 };
        let path = around.map_or(0.0, |water| PILED_UP * path(stats, water, setting));
        let surfaces = PILED_UP * lamps.surface_rounding;
        let above = given.above.map_or(0.0, Above::bound);
        let snow_rounding = if frame.water.snow.is_some() {
            SNOW_ROUNDING * levels::brightest_behind(given).max(given.snow_peak)
        } else {
            0.0
        };
        let light = lamps.glow_left + lamps.glow_rounding + lamps.shadows_left + surfaces + above;
        let clouds = sediment::drift(given).and_then(|stage| stage.bound);
        let others = light + path + snow_rounding + clouds.unwrap_or(0.0);
        let left = |whole: f64| ((1.0 - snow) * whole - others).max(LEAST * whole);
        Self {
            tolerance,
            snow: snow * tolerance.unwrap_or(TOLERANCE),
            snow_rounding,
            path,
            surfaces,
            above,
            water: tolerance.map(left),
        }
    }

    /// What the plan of the water is made for.
    pub(super) fn fidelity(&self, frame: &Frame) -> Fidelity {
        self.water.map_or(frame.fidelity, Fidelity::Tolerance)
    }
}

/// The error in linear light that the quadrature of the glow of lamps may leave in this frame.
#[must_use]
pub fn glow_share(frame: &Frame) -> f64 {
    GLOW * before_water(frame)
}

/// What clouds of sediment may change at most where they are left out of this frame.
pub(super) fn sediment_share(frame: &Frame) -> f64 {
    SEDIMENT * before_water(frame)
}

/// The error in linear light that a frame asks for, as far as stages need to know it that are decided on before the water is.
#[must_use]
pub fn before_water(frame: &Frame) -> f64 {
    match frame.fidelity {
        Fidelity::Tolerance(tolerance) => tolerance,
        Fidelity::DISPLAY => DARK,
        _ => TOLERANCE,
    }
}

/// The error in linear light that a frame asks for.
fn tolerance(frame: &Frame, stats: &SceneStats, around: Option<&Water>) -> Option<f64> {
    // Snow may be darker than anything in the water, and a glow takes darkness where the slope of the curve is another.
    let is_covered = frame.has_lamps() || frame.water.snow.is_some();
    match around {
        Some(_) if is_covered && frame.fidelity == Fidelity::DISPLAY => Some(DARK),
        Some(water) => levels::tolerance(stats, water, frame.fidelity),
        None => match frame.fidelity {
            Fidelity::Tolerance(tolerance) => Some(tolerance),
            _ => None,
        },
    }
}

/// Rounding of paths: light errs by at most 1/e of their share.
fn path(stats: &SceneStats, water: &Water, setting: &Setting) -> f64 {
    let (Some(patches), Some((_, farthest))) = (&setting.patches, stats.range_m) else {
        return 0.0;
    };
    let gain = water.radiance_gain();
    let brightest = [0, 1, 2].map(|i| f64::from(stats.brightest[i]) * gain[i]);
    let brightest = brightest.into_iter().fold(0.0, f64::max);
    let veil = [0, 1, 2].map(|i| water.brightest_veil(i, stats.holes));
    let veil = veil.into_iter().fold(0.0, f64::max);
    path_rounding(farthest, patches.scale_m()) * brightest.max(veil) / std::f64::consts::E
}
