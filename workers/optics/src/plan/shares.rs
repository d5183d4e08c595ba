//! How the stages of a frame share its tolerance, so that their errors together stay within it.

use spec::{Fidelity, Frame};

use super::levels::{self, PILED_UP};
use super::{Given, SceneStats};
use crate::lamp;
use crate::setting::Setting;
use crate::turbidity::path_rounding;
use crate::water::Water;

/// The tolerance of a frame that gives none.
const TOLERANCE: f64 = 3e-4;
/// What changes no code of the 8-bit picture by more than one, however dark it is.
const DARK: f64 = 1.0 / 255.0 / 12.92;
/// Share of the tolerance that the glow of lamps may use up: more nodes cost little beside more kernels.
const GLOW: f64 = 0.25;
/// Share of the snow: wider discs cost next to nothing.
const SNOW: f64 = 0.125;
/// What is left for the water where rounding alone uses up its share.
const LEAST: f64 = 0.125;

/// The error in linear light that each stage may have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Shares {
    /// What the frame asks for.
    pub(super) tolerance: Option<f64>,
    /// Glow of the water before the lamps: what nodes may leave, what the most of them leave beyond it, and what f32 may lose.
    pub(super) glow_nodes: f64,
    pub(super) glow_left: f64,
    pub(super) glow_rounding: f64,
    /// Marine snow.
    pub(super) snow: f64,
    /// Rounding of paths through patchy water, as it arrives in the picture.
    pub(super) path: f64,
    /// Rounding of surfaces that lamps light, as it arrives in the picture.
    pub(super) surfaces: f64,
    /// Attenuation and forward scatter; none where the frame does not ask for a tolerance.
    water: Option<f64>,
}

impl Shares {
    pub(super) fn new(given: &Given<'_>) -> Self {
        let Given {
            frame,
            setting,
            stats,
            ..
        } = *given;
        let around = setting.around.as_ref();
        let tolerance = tolerance(frame, stats, around);
        let whole = tolerance.unwrap_or(TOLERANCE);
        let glow = if setting.lighting.is_some() { GLOW } else { 0.0 };
        let snow = if frame.water.snow.is_some() { SNOW } else { 0.0 };
        let lighting = setting.lighting.as_ref();
        let glow_rounding = lighting.map_or(0.0, |lighting| lamp::glow_rounding(lighting, setting.size));
        // More nodes make up for no rounding: half of the share is always theirs.
        let glow_nodes = (glow * whole - glow_rounding).max(0.5 * glow * whole);
        let shares = Self {
            tolerance,
            glow_nodes,
            glow_left: lighting.map_or(0.0, |lighting| {
                lamp::glow_left(lighting, setting.size, glow_nodes)
            }),
            glow_rounding,
            snow: snow * whole,
            path: around.map_or(0.0, |water| PILED_UP * path(stats, water, setting)),
            surfaces: PILED_UP * stats.lamp_rounding,
            water: None,
        };
        let rounding = shares.path + shares.surfaces;
        let left = |whole: f64| ((1.0 - glow - snow) * whole - rounding).max(LEAST * whole);
        Self {
            water: tolerance.map(left),
            ..shares
        }
    }

    /// What the plan of the water is made for.
    pub(super) fn fidelity(&self, frame: &Frame) -> Fidelity {
        self.water.map_or(frame.fidelity, Fidelity::Tolerance)
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
    let veil = water.veiling_light().into_iter().fold(0.0, f64::max);
    path_rounding(farthest, patches.scale_m()) * brightest.max(veil) / std::f64::consts::E
}
