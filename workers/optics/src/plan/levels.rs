//! Brightness limits of a frame in the water, and the tolerance that follows.

use spec::{Fidelity, Frame};

use super::terms::{PILED_UP, largest_share};
use super::{ErrorBound, SceneBounds};
use crate::water::{Scatter, Water};

/// Relative rounding of f32 in attenuation and transforms: the largest of some ten thousand frames is half of it.
pub(super) const ROUNDING: f64 = 2e-6;
/// Rounding of a transform is noise over the whole frame, in proportion to the root mean square of its light; its largest sample is this
/// many times that.
const NOISE_PEAK: f64 = 5.0;
/// The tolerance of plans for a fixed number of kernels.
pub(super) const DEFAULT_TOLERANCE: f64 = 3e-4;
/// An error up to this changes 8-bit codes by at most one, even in black.
const DARK: f64 = 1.0 / 255.0 / 12.92;
/// Above this light the slope of the transfer curve falls.
const FOOT: f64 = 0.003_130_8;
/// The slope of the transfer curve falls with this power of the light; width of a code in white.
const SLOPE_POWER: f64 = -0.5833;
const WHITE_CODE: f64 = 1.0 / 255.0 / 0.4396;
/// Relative part of the tolerance: half of a code in white. In between a code is wider than a line.
const RELATIVE: f64 = 4e-3;

/// The tolerated error of the exposed light of a frame; `None` for a fixed number of kernels and for the reference. Errors up to
/// `hidden` are hidden by the noise of the sensor; 0 without one.
#[must_use]
pub fn frame_tolerance(
    frame: &Frame,
    bounds: &SceneBounds,
    around: Option<&Water>,
    hidden: f64,
) -> Option<ErrorBound> {
    match frame.fidelity {
        Fidelity::Tolerance(tolerance) => Some(ErrorBound::absolute(tolerance)),
        Fidelity::Terms(_) | Fidelity::Reference => None,
        Fidelity::Picture | Fidelity::BudgetMs(_) => {
            // Snow may be darker than anything in the water, airlight lifts darkness to another slope of the curve, and an exposure
            // may do either.
            let is_covered =
                frame.has_lamps() || frame.water.snow.is_some() || frame.camera.exposure.is_some();
            let code = match around {
                Some(water) if !is_covered => display_tolerance(bounds, water),
                _ => DARK,
            };
            let invisible = code.max(hidden);
            Some(if is_covered {
                lean(invisible)
            } else {
                ErrorBound::absolute(invisible)
            })
        }
    }
}

/// A tolerance that grows with the light, without exceeding one code or `invisible` anywhere: at some light a code is as wide as
/// `invisible`, and beyond it is wider than any line up to half of a code in white. The slope of the curve counts at the light less
/// the error.
fn lean(invisible: f64) -> ErrorBound {
    let wide = (invisible / WHITE_CODE).powf(1.0 / -SLOPE_POWER).max(FOOT);
    let wide = (wide + invisible).min(1.0);
    ErrorBound {
        absolute: invisible - RELATIVE * wide,
        relative: RELATIVE,
    }
}

/// The tolerance in linear light of a fidelity.
pub(super) fn tolerance(bounds: &SceneBounds, water: &Water, fidelity: Fidelity) -> Option<f64> {
    match fidelity {
        Fidelity::Tolerance(tolerance) => Some(tolerance),
        Fidelity::Picture | Fidelity::BudgetMs(_) => Some(display_tolerance(bounds, water)),
        Fidelity::Terms(_) | Fidelity::Reference => None,
    }
}

/// Rounding of f32 in the water: a share of all light, and the noise of transforms.
pub(super) fn rounding(bounds: &SceneBounds, water: &Water) -> ErrorBound {
    let noise = (0..3).map(|channel| {
        let peak = brightest_spread(bounds, water, channel);
        let brightest = f64::from(bounds.brightest[channel]).max(f64::MIN_POSITIVE);
        peak * (NOISE_PEAK * bounds.mean_square[channel].sqrt() / brightest).min(1.0)
    });
    ErrorBound {
        absolute: ROUNDING * noise.fold(0.0, f64::max),
        relative: ROUNDING,
    }
}

/// The brightest light of a channel that forward scatter transforms.
fn brightest_spread(bounds: &SceneBounds, water: &Water, channel: usize) -> f64 {
    match water.scatter {
        Scatter::None => 0.0,
        Scatter::Simplified { .. } => levels(bounds, water, channel).1.max(0.0),
        Scatter::Jaffe { g, .. } => {
            let c = water.direct_attenuation[channel];
            let spread = bounds.bins.iter().map(|bin| {
                let light = f64::from(bin.brightest[channel]) * water.radiance_gain[channel];
                light * largest_share(g[channel].min(c), c, bin.meters.0, bin.meters.1)
            });
            spread.fold(0.0, f64::max)
        }
    }
}

/// Upper bound of the light behind particles: direct light, focused spread light, the veil and the airlight.
#[must_use]
pub fn brightest_behind(bounds: &SceneBounds, around: Option<&Water>, airlight: f64) -> f64 {
    let Some(water) = around else {
        return f64::from(bounds.brightest.into_iter().fold(0.0, f32::max)) + airlight;
    };
    let behind = [0, 1, 2].map(|channel| {
        let spread = PILED_UP * brightest_spread(bounds, water, channel);
        brightest_direct(bounds, water, channel) + spread + water.brightest_veil(channel, bounds.holes)
    });
    behind.into_iter().fold(0.0, f64::max) + airlight
}

/// The brightest direct light of a channel behind the water.
fn brightest_direct(bounds: &SceneBounds, water: &Water, channel: usize) -> f64 {
    // A hole shows the scene only in water without attenuation.
    if bounds.holes && water.direct_attenuation[channel] == 0.0 {
        return f64::from(bounds.brightest[channel]) * water.radiance_gain[channel];
    }
    let direct = bounds.bins.iter().map(|bin| {
        let light = f64::from(bin.brightest[channel]) * water.radiance_gain[channel];
        light * (-water.direct_attenuation[channel] * bin.meters.0).exp()
    });
    direct.fold(0.0, f64::max)
}

/// The error in linear light that changes no 8-bit code by more than one: `(1/255) / (0.4396 L^{−0.5833})` if no light is below L >
/// 0.0031, else the limit from the steep foot of the curve (12.92).
#[must_use]
pub fn display_tolerance(bounds: &SceneBounds, water: &Water) -> f64 {
    let darkest = (0..3)
        .map(|channel| levels(bounds, water, channel).0)
        .fold(f64::INFINITY, f64::min);
    if darkest <= FOOT {
        return DARK;
    }
    // The slope falls with the light, so it is evaluated at the light less the error.
    let darkest = (darkest - DARK).max(FOOT).min(1.0);
    WHITE_CODE / darkest.powf(SLOPE_POWER)
}

/// Light and attenuation of one channel of a scene.
struct Channel {
    /// Light of the darkest pixel, as it enters the water.
    dark: f64,
    /// Light of the brightest pixel, as it enters the water.
    bright: f64,
    /// Attenuation of the scene, 1/m.
    direct: f64,
    /// Attenuation of the veil, 1/m.
    back: f64,
    veil: f64,
    /// Whether the veil is another in every direction, this one the brightest.
    is_varied: bool,
}

impl Channel {
    fn of_scene(bounds: &SceneBounds, water: &Water, channel: usize) -> Self {
        let gain = water.radiance_gain[channel];
        Self {
            dark: f64::from(bounds.darkest[channel]) * gain,
            bright: f64::from(bounds.brightest[channel]) * gain,
            direct: water.direct_attenuation[channel],
            back: water.backscatter_attenuation[channel],
            veil: water.brightest_veil(channel, bounds.holes),
            is_varied: water.varied_veil(channel).is_some(),
        }
    }
}

/// Limits of the attenuated image in one channel: `I − B∞ = (J − B∞) T` where one coefficient serves both parts.
pub(super) fn levels(bounds: &SceneBounds, water: &Water, channel: usize) -> (f64, f64) {
    let Channel {
        dark,
        bright,
        direct,
        back,
        veil,
        is_varied,
    } = Channel::of_scene(bounds, water, channel);
    let (nearest, farthest) = bounds.range_m.unwrap_or((0.0, f64::INFINITY));
    if direct == back && direct > 0.0 && !is_varied {
        // A hole that shows only the veil is between the two.
        let arriving = |contrast: f64, towards: bool| {
            let farther = if bounds.holes { f64::INFINITY } else { farthest };
            contrast * (-direct * if towards { nearest } else { farther }).exp()
        };
        let (low, high) = (dark - veil, bright - veil);
        return (veil + arriving(low, low < 0.0), veil + arriving(high, high > 0.0));
    }
    // A hole shows the scene in water without attenuation, otherwise the veil.
    let darkest = dark * (-direct * farthest).exp();
    (if bounds.holes { 0.0 } else { darkest }, bright.max(0.0) + veil)
}

/// Error of omitting the water's attenuation; infinite if it has no bound.
pub(super) fn attenuation_effect(bounds: &SceneBounds, water: &Water, channel: usize) -> f64 {
    let Some((_, farthest)) = bounds.range_m.filter(|_| !bounds.holes) else {
        return f64::INFINITY;
    };
    let Channel {
        dark,
        bright,
        direct,
        back,
        veil,
        is_varied,
    } = Channel::of_scene(bounds, water, channel);
    if is_varied {
        // The veil of daylight is a separate stage.
        return bright * -(-direct * farthest).exp_m1();
    }
    if direct == back {
        let contrast = (bright - veil).abs().max((dark - veil).abs());
        return contrast * -(-direct * farthest).exp_m1();
    }
    bright * -(-direct * farthest).exp_m1() + veil * -(-back * farthest).exp_m1()
}

#[cfg(test)]
mod tests {
    use imaging::transfer;

    use super::*;

    /// Light steps of the check.
    const STEPS: usize = 2000;

    #[test]
    fn a_tolerance_that_grows_with_light_is_never_visible() {
        for invisible in [DARK, 4.5e-4, 2e-3, 8e-3, 0.02] {
            let tolerance = lean(invisible);
            assert!(tolerance.absolute > 0.5 * invisible, "{tolerance:?}");
            for step in 0..=STEPS {
                let light = (step as f64 / STEPS as f64).powi(3);
                let error = tolerance.bound_sample(light);
                let code = |light: f64| 255.0 * transfer::encode(light.clamp(0.0, 1.0));
                let codes = code(light) - code(light - error);
                assert!(
                    codes <= 1.0 + 1e-9 || error <= invisible,
                    "{invisible} at {light}: {codes}"
                );
            }
        }
    }
}
