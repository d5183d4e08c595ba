//! How the stages of a frame share its tolerance, so that their errors together stay within it.

use imaging::Rgb;
use optics::lamp::SURFACE_ROUNDING;
use optics::plan::{SceneStats, display_tolerance};
use optics::turbidity::path_rounding;
use optics::water::Water;
use spec::{Fidelity, Frame};

/// The tolerance of a frame that gives none.
const TOLERANCE: f64 = 3e-4;
/// What changes no code of the 8-bit picture by more than one, however dark it is.
const DARK: f64 = 1.0 / 255.0 / 12.92;
/// Share of the tolerance that the glow of lamps may use up: more nodes cost little beside more kernels.
const LAMPS: f64 = 0.25;
/// Share of the snow: wider discs cost next to nothing.
const SNOW: f64 = 0.125;
/// What is left for the water where rounding alone uses up its share.
const LEAST: f64 = 0.125;
/// Scattered light may pile up: what goes into the water with an error comes out with up to twice as much.
const PILED_UP: f64 = 2.0;

/// The error in linear light that each stage may have.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Shares {
    /// Glow of the water before the lamps.
    pub(crate) lamps: f64,
    /// Marine snow.
    pub(crate) snow: f64,
    /// Rounding of what goes into the water: paths through patchy water, and surfaces that lamps light.
    pub(crate) rounding: f64,
    /// Attenuation and forward scatter; none where the frame does not ask for a tolerance.
    water: Option<f64>,
}

impl Shares {
    /// The shares of a frame without water.
    pub(crate) fn without_water(frame: &Frame) -> Self {
        let tolerance = match frame.fidelity {
            Fidelity::Tolerance(tolerance) => tolerance,
            _ => TOLERANCE,
        };
        Self {
            lamps: LAMPS * tolerance,
            snow: SNOW * tolerance,
            rounding: 0.0,
            water: None,
        }
    }

    /// The shares of a frame in this water, whose scene is lit as the picture and the statistics say.
    pub(crate) fn of(frame: &Frame, stats: &SceneStats, water: &Water, lit: Option<&Rgb<f32>>) -> Self {
        let later = frame.has_lamps() || frame.water.snow.is_some();
        let tolerance = match frame.fidelity {
            Fidelity::Tolerance(tolerance) => Some(tolerance),
            // Snow may be darker than anything in the water, and a glow takes darkness where the slope of the curve is another.
            Fidelity::DISPLAY if later => Some(DARK),
            Fidelity::DISPLAY => Some(display_tolerance(stats, water)),
            Fidelity::Terms(_) | Fidelity::REFERENCE => None,
        };
        let whole = tolerance.unwrap_or(TOLERANCE);
        let lamps = if frame.has_lamps() { LAMPS } else { 0.0 };
        let snow = if frame.water.snow.is_some() { SNOW } else { 0.0 };
        let gain = water.radiance_gain();
        let brightest = [0, 1, 2].map(|i| f64::from(stats.brightest[i]) * gain[i]);
        let brightest = brightest.into_iter().fold(0.0, f64::max);
        let veil = water.veiling_light().into_iter().fold(0.0, f64::max);
        let path = match (frame.water.turbidity, stats.range_m) {
            (Some(patches), Some((_, farthest))) if patches.contrast > 0.0 => {
                path_rounding(farthest, patches.scale_m) * brightest.max(veil) / std::f64::consts::E
            }
            _ => 0.0,
        };
        let surfaces = lit.map_or(0.0, |_| SURFACE_ROUNDING * brightest);
        let rounding = match frame.fidelity {
            Fidelity::REFERENCE => 0.0,
            _ => PILED_UP * (path + surfaces),
        };
        Self {
            lamps: lamps * whole,
            snow: snow * whole,
            rounding,
            water: tolerance.map(|whole| ((1.0 - lamps - snow) * whole - rounding).max(LEAST * whole)),
        }
    }

    /// What the plan of the water is made for.
    pub(crate) fn fidelity(&self, frame: &Frame) -> Fidelity {
        self.water.map_or(frame.fidelity, Fidelity::Tolerance)
    }
}
