//! What a frame needs for a tolerance: plain data, chosen before anything is computed.
//!
//! The tolerance is the largest error in linear light, and the stages share it: what one of them uses is taken from what
//! the next may. A stage is skipped only where its whole effect stays within its share; else the cheapest form is taken
//! whose error [`Bound`](crate::forward_scatter::Bound) says does. A style network has no known gain: with one the
//! promise holds up to its input.

mod bins;
mod scatter;
mod stats;

pub use stats::{RangeBin, SceneStats};

pub use spec::Fidelity;
use spec::Haze;

use crate::forward_scatter::Nodes;
use crate::water::Water;

/// Forward scatter of one channel.
#[derive(Debug, Clone, PartialEq)]
pub enum ScatterStep {
    /// Its effect stays below the tolerance.
    Skip,
    /// The kernel is narrower than a pixel: what is scattered arrives where it left.
    Pointwise,
    /// Interpolation between these kernels.
    Interpolated(Nodes),
    /// Every pixel's own kernel, in f64.
    Reference,
}

/// Attenuation of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AttenuationStep {
    /// There is no water.
    Skip,
    /// f32.
    Fast,
    /// f64.
    Reference,
}

/// The plan of a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Plan {
    /// Attenuation; in f64 all of the water stage is.
    pub attenuation: AttenuationStep,
    /// Forward scatter, for each channel.
    pub scatter: [ScatterStep; 3],
    /// Whether the style network runs.
    pub style: bool,
    /// Lights that are drawn.
    pub lights: usize,
    /// The error in linear light that attenuation, scatter and f32 together may make in each channel, where the plan was
    /// made for a tolerance.
    pub bounds: Option<[f64; 3]>,
}

/// Attenuation is left out where that loses no more than this part of the tolerance.
const SKIP_SHARE: f64 = 0.125;
/// What is left for the scatter where f32 alone uses up the tolerance.
const LEAST_SHARE: f64 = 0.125;
/// Rounding of f32 in attenuation and transforms, for light up to 1: the largest of some ten thousand frames is half of it.
const ROUNDING: f64 = 2e-6;

/// What f32 may lose of the light of a channel.
fn rounding(stats: &SceneStats, water: &Water, channel: usize) -> f64 {
    let radiance = f64::from(stats.brightest[channel]) * water.radiance_gain[channel];
    ROUNDING * radiance.max(water.veiling_light[channel])
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

/// One line of a plan for people and records.
#[derive(Debug, Clone, PartialEq)]
pub struct StageNote {
    /// The stage, with the channel where it differs between channels.
    pub stage: &'static str,
    /// What is done.
    pub variant: &'static str,
    /// Kernels, where there are some.
    pub terms: Option<usize>,
    /// Bound of the error in linear light, where one is known.
    pub bound: Option<f64>,
}

impl Plan {
    /// Chooses for a frame with range.
    #[must_use]
    pub fn for_frame(
        stats: &SceneStats,
        water: &Water,
        style_weight: Option<f64>,
        lights: &[Haze],
        fidelity: Fidelity,
    ) -> Self {
        let tolerance = match fidelity {
            Fidelity::Tolerance(tolerance) => Some(tolerance),
            Fidelity::DISPLAY => Some(display_tolerance(stats, water)),
            Fidelity::Terms(_) | Fidelity::REFERENCE => None,
        };
        let lost = [0, 1, 2].map(|channel| attenuation_effect(stats, water, channel));
        let clear =
            tolerance.is_some_and(|tolerance| lost.iter().all(|&lost| lost <= SKIP_SHARE * tolerance));
        let used = |channel: usize| rounding(stats, water, channel) + if clear { lost[channel] } else { 0.0 };
        let steps = [0, 1, 2].map(|channel| {
            let share = tolerance.map_or(0.0, |tolerance| {
                (tolerance - used(channel)).max(LEAST_SHARE * tolerance)
            });
            scatter::choose(stats, water, channel, fidelity, share)
        });
        let bound = |channel: usize| used(channel) + steps[channel].1.unwrap_or(0.0);
        Self {
            attenuation: match fidelity {
                Fidelity::REFERENCE => AttenuationStep::Reference,
                _ if clear => AttenuationStep::Skip,
                _ => AttenuationStep::Fast,
            },
            bounds: tolerance.map(|_| [0, 1, 2].map(bound)),
            scatter: steps.map(|(step, _)| step),
            ..Self::without_water(style_weight, lights)
        }
    }

    /// The plan of a frame without range or without optics: the water stage is skipped.
    #[must_use]
    pub fn without_water(style_weight: Option<f64>, lights: &[Haze]) -> Self {
        Self {
            attenuation: AttenuationStep::Skip,
            scatter: [const { ScatterStep::Skip }; 3],
            style: style_weight.is_some_and(|alpha| alpha > 0.0),
            lights: lights.iter().filter(|light| light.shines()).count(),
            bounds: None,
        }
    }

    /// The plan line by line.
    #[must_use]
    pub fn describe(&self) -> Vec<StageNote> {
        const STAGES: [&str; 3] = ["forward_scatter.r", "forward_scatter.g", "forward_scatter.b"];
        let scatter = self
            .scatter
            .iter()
            .zip(STAGES)
            .enumerate()
            .map(|(channel, (step, stage))| {
                let (variant, terms) = match step {
                    ScatterStep::Skip => ("skip", None),
                    ScatterStep::Pointwise => ("pointwise", None),
                    ScatterStep::Interpolated(nodes) => ("chebyshev", Some(nodes.terms())),
                    ScatterStep::Reference => ("reference", None),
                };
                StageNote {
                    stage,
                    variant,
                    terms,
                    bound: self.bounds.map(|bounds| bounds[channel]),
                }
            });
        let simple = |stage, variant| StageNote {
            stage,
            variant,
            terms: None,
            bound: None,
        };
        let attenuation = match self.attenuation {
            AttenuationStep::Skip => "skip",
            AttenuationStep::Fast => "f32",
            AttenuationStep::Reference => "reference",
        };
        let style = simple("style", if self.style { "network" } else { "skip" });
        let haze = simple("haze", if self.lights > 0 { "overlay" } else { "skip" });
        std::iter::once(simple("attenuation", attenuation))
            .chain(scatter)
            .chain([style, haze])
            .collect()
    }
}

/// Limits of the attenuated image in one channel: `I − B∞ = (J − B∞) T` where one coefficient serves both parts.
fn levels(stats: &SceneStats, water: &Water, channel: usize) -> (f64, f64) {
    let gain = water.radiance_gain[channel];
    let (dark, bright) = (
        f64::from(stats.darkest[channel]) * gain,
        f64::from(stats.brightest[channel]) * gain,
    );
    let (direct, back) = (
        water.direct_attenuation[channel],
        water.backscatter_attenuation[channel],
    );
    let veil = water.veiling_light[channel];
    let (nearest, farthest) = stats.range_m.unwrap_or((0.0, f64::INFINITY));
    if direct == back && direct > 0.0 {
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
fn attenuation_effect(stats: &SceneStats, water: &Water, channel: usize) -> f64 {
    let Some((_, farthest)) = stats.range_m.filter(|_| !stats.holes) else {
        return f64::INFINITY;
    };
    let gain = water.radiance_gain[channel];
    let (dark, bright) = (
        f64::from(stats.darkest[channel]) * gain,
        f64::from(stats.brightest[channel]) * gain,
    );
    let (direct, back) = (
        water.direct_attenuation[channel],
        water.backscatter_attenuation[channel],
    );
    let veil = water.veiling_light[channel];
    if direct == back {
        let contrast = (bright - veil).abs().max((dark - veil).abs());
        return contrast * -(-direct * farthest).exp_m1();
    }
    bright * -(-direct * farthest).exp_m1() + veil * -(-back * farthest).exp_m1()
}

#[cfg(test)]
mod tests;
