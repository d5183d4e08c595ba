//! How bright and how dark a frame may be in the water, and what that allows.

use spec::Fidelity;

use super::{Given, SceneStats};
use crate::water::Water;

/// Rounding of f32 in attenuation and transforms, for light up to 1: the largest of some ten thousand frames is half of it.
const ROUNDING: f64 = 2e-6;
/// Scattered light may pile up: what goes into the water with an error comes out with up to twice as much.
pub(super) const PILED_UP: f64 = 2.0;

/// The largest error in linear light that is asked for.
pub(super) fn tolerance(stats: &SceneStats, water: &Water, fidelity: Fidelity) -> Option<f64> {
    match fidelity {
        Fidelity::Tolerance(tolerance) => Some(tolerance),
        Fidelity::DISPLAY => Some(display_tolerance(stats, water)),
        Fidelity::Terms(_) | Fidelity::REFERENCE => None,
        // The frame has its tolerance by now; one without a sensor has none.
        Fidelity::NOISE => None,
    }
}

/// What f32 may lose of the light of a channel.
pub(super) fn rounding(stats: &SceneStats, water: &Water, channel: usize) -> f64 {
    let radiance = f64::from(stats.brightest[channel]) * water.radiance_gain[channel];
    ROUNDING * radiance.max(water.brightest_veil(channel, stats.holes))
}

/// No light that snow may cover is brighter: that of the scene as it may pile up, the veil, and the glow.
pub(super) fn brightest_behind(given: &Given<'_>) -> f64 {
    let around = given.setting.around.as_ref();
    let gain = around.map_or([1.0; 3], Water::radiance_gain);
    let veil = around.map_or([0.0; 3], |water| {
        [0, 1, 2].map(|i| water.brightest_veil(i, given.stats.holes))
    });
    let behind = [0, 1, 2].map(|i| PILED_UP * f64::from(given.stats.brightest[i]) * gain[i] + veil[i]);
    behind.into_iter().fold(0.0, f64::max) + given.lamps.glow_peak
}

/// The error in linear light that changes no 8-bit code by more than one: `(1/255) / (0.4396 L^{−0.5833})` where no light is
/// below L > 0.0031, else what the steep foot of the curve allows (12.92).
#[must_use]
pub fn display_tolerance(stats: &SceneStats, water: &Water) -> f64 {
    const FOOT: f64 = 0.003_130_8;
    let darkest = (0..3)
        .map(|channel| levels(stats, water, channel).0)
        .fold(f64::INFINITY, f64::min);
    if darkest <= FOOT {
        return 1.0 / 255.0 / 12.92;
    }
    // The slope falls with the light; it is taken where the error may have led.
    let darkest = (darkest - 1.0 / 255.0 / 12.92).max(FOOT).min(1.0);
    1.0 / 255.0 / (0.4396 * darkest.powf(-0.5833))
}

/// What one channel of a scene goes through.
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
    fn of_scene(stats: &SceneStats, water: &Water, channel: usize) -> Self {
        let gain = water.radiance_gain[channel];
        Self {
            dark: f64::from(stats.darkest[channel]) * gain,
            bright: f64::from(stats.brightest[channel]) * gain,
            direct: water.direct_attenuation[channel],
            back: water.backscatter_attenuation[channel],
            veil: water.brightest_veil(channel, stats.holes),
            is_varied: water.varied_veil(channel).is_some(),
        }
    }
}

/// Limits of the attenuated image in one channel: `I − B∞ = (J − B∞) T` where one coefficient serves both parts.
pub(super) fn levels(stats: &SceneStats, water: &Water, channel: usize) -> (f64, f64) {
    let Channel {
        dark,
        bright,
        direct,
        back,
        veil,
        is_varied,
    } = Channel::of_scene(stats, water, channel);
    let (nearest, farthest) = stats.range_m.unwrap_or((0.0, f64::INFINITY));
    if direct == back && direct > 0.0 && !is_varied {
        // The veil is between the two where a hole shows it alone.
        let arriving = |contrast: f64, towards: bool| {
            let farther = if stats.holes { f64::INFINITY } else { farthest };
            contrast * (-direct * if towards { nearest } else { farther }).exp()
        };
        let (low, high) = (dark - veil, bright - veil);
        return (veil + arriving(low, low < 0.0), veil + arriving(high, high > 0.0));
    }
    // A hole shows the scene itself where the water attenuates nothing, and the veil where it does.
    let darkest = dark * (-direct * farthest).exp();
    (if stats.holes { 0.0 } else { darkest }, bright.max(0.0) + veil)
}

/// What is lost if the water's attenuation is left out; none where that cannot be bounded.
pub(super) fn attenuation_effect(stats: &SceneStats, water: &Water, channel: usize) -> f64 {
    let Some((_, farthest)) = stats.range_m.filter(|_| !stats.holes) else {
        return f64::INFINITY;
    };
    let Channel {
        dark,
        bright,
        direct,
        back,
        veil,
        is_varied,
    } = Channel::of_scene(stats, water, channel);
    if is_varied {
        // Light from below decays by c + K at most.
        return bright * -(-direct * farthest).exp_m1() + veil * -(-2.0 * back * farthest).exp_m1();
    }
    if direct == back {
        let contrast = (bright - veil).abs().max((dark - veil).abs());
        return contrast * -(-direct * farthest).exp_m1();
    }
    bright * -(-direct * farthest).exp_m1() + veil * -(-back * farthest).exp_m1()
}
