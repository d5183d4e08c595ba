//! How the stages of a frame share its tolerance, so that their errors together stay within it.

use super::levels::{DEFAULT_TOLERANCE, ROUNDING};
use super::{ErrorBound, Gain, Stage, StageId};

/// Share of airlight, for quadrature and rounding: more nodes cost little compared with more kernels.
const AIRLIGHT: f64 = 0.25;
/// Part of the relative tolerance for airlight; the rest is for rounding.
const AIRLIGHT_RELATIVE: f64 = 0.9;
/// Share of rounding of the light of lamps on surfaces. Pixels that would lose more are computed in f64.
const LAMP_ROUNDING: f64 = 0.125;
/// Share of clouds of sediment, used only if they are omitted.
const SEDIMENT: f64 = 0.125;
/// Share of the snow: wider discs are almost free.
const SNOW: f64 = 0.04;
/// Share of light without shadow rays.
const UNSHADOWED: f64 = 1.0 / 16.0;
/// Minimum share of the tolerance reserved for the light before the camera and for the water.
const LEAST: f64 = 0.125;

/// The error that the stages before the camera may make, from the tolerance of the exposed light backwards through the gains
/// of the camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Budget {
    /// The tolerated error of the exposed light; `None` without a tolerance.
    pub tolerance: Option<ErrorBound>,
    /// From the light before the camera to the exposed light.
    gain: Gain,
    /// The largest absolute error of the light before the camera.
    whole: f64,
    /// The relative error that the exposed light may have besides that of the camera.
    relative: f64,
    /// Factor of the shares of stages before the water.
    part: f64,
}

impl Budget {
    /// The budget before these stages of the camera.
    #[must_use]
    pub fn new(tolerance: Option<ErrorBound>, camera: &[Stage]) -> Self {
        let exposed = || camera.iter().filter(|stage| stage.id.is_promised());
        let gain = compose_gain(exposed());
        let own = compose(exposed())
            .into_iter()
            .fold(ErrorBound::EXACT, ErrorBound::greater);
        let asked = tolerance.unwrap_or(ErrorBound::absolute(DEFAULT_TOLERANCE));
        // Relative errors beyond the relative tolerance count as in white.
        let uncovered = own.absolute + (own.relative - asked.relative).max(0.0);
        Self {
            tolerance,
            gain,
            whole: (asked.absolute - uncovered).max(LEAST * asked.absolute) / gain.absolute,
            relative: (asked.relative - own.relative).max(0.0),
            part: 1.0,
        }
    }

    /// The same with half the shares of the stages before the water, which gets the remainder.
    #[must_use]
    pub fn halved(self) -> Self {
        Self {
            part: 0.5 * self.part,
            ..self
        }
    }

    /// The largest absolute error of the light before the camera, from a default tolerance if the frame has none.
    #[must_use]
    pub fn whole(&self) -> f64 {
        self.whole
    }

    /// The part of airlight, for its quadrature and its rounding.
    #[must_use]
    pub fn airlight(&self) -> f64 {
        AIRLIGHT * self.part * self.whole
    }

    /// The relative error that airlight may have in addition.
    #[must_use]
    pub fn airlight_relative(&self) -> f64 {
        AIRLIGHT_RELATIVE * self.relative / self.gain.relative
    }

    /// The part of rounding of the light of lamps on surfaces.
    #[must_use]
    pub fn lamp_rounding(&self) -> f64 {
        LAMP_ROUNDING * self.part * self.whole
    }

    /// Largest effect of clouds of sediment that may be left out.
    #[must_use]
    pub fn sediment(&self) -> f64 {
        SEDIMENT * self.part * self.whole
    }

    /// The part of the snow.
    #[must_use]
    pub fn snow(&self) -> f64 {
        SNOW * self.part * self.whole
    }

    /// Light of lamps up to this has no shadow.
    #[must_use]
    pub fn unshadowed(&self) -> f64 {
        UNSHADOWED * self.part * self.whole
    }

    /// The share of attenuation, veil and scatter next to these stages, in water with this gain; `None` without a tolerance.
    #[must_use]
    pub fn water<'a>(&self, others: impl Iterator<Item = &'a Stage>, gain: Gain) -> Option<f64> {
        self.tolerance?;
        let mut used = ErrorBound::relative(ROUNDING);
        for stage in others.filter(|stage| stage.id.is_promised()) {
            let enters_water = stage.id < StageId::Attenuation;
            let own = if enters_water { gain } else { Gain::ONE };
            used = used.plus(stage.bound.unwrap_or_default().behind(own));
        }
        let uncovered = (used.relative * self.gain.relative - self.relative).max(0.0) / self.gain.absolute;
        Some((self.whole - used.absolute - uncovered).max(LEAST * self.whole))
    }
}

/// Walks stages in their order: `error = error * gain + bound` in each channel.
#[must_use]
pub fn compose<'a>(stages: impl Iterator<Item = &'a Stage>) -> [ErrorBound; 3] {
    let mut errors = [ErrorBound::EXACT; 3];
    for stage in stages {
        for (channel, error) in errors.iter_mut().enumerate() {
            if stage.id.channel().is_none_or(|own| own == channel) {
                *error = error.behind(stage.gain).plus(stage.bound.unwrap_or_default());
            }
        }
    }
    errors
}

/// The gain of stages, one after the other.
#[must_use]
pub fn compose_gain<'a>(stages: impl Iterator<Item = &'a Stage>) -> Gain {
    stages.fold(Gain::ONE, |gain, stage| gain.then(stage.gain))
}

#[cfg(test)]
mod tests {
    use super::super::Variant;
    use super::*;

    #[test]
    fn a_bright_exposure_leaves_less_for_the_light_before_it() {
        let exposure = Stage {
            gain: Gain::factor(20.0),
            ..Stage::new(StageId::Exposure, Variant::Fast("fixed"))
        };
        let tolerance = Some(ErrorBound::absolute(3e-4));
        let bright = Budget::new(tolerance, std::slice::from_ref(&exposure));
        assert!((bright.whole() - 1.5e-5).abs() < 1e-12);
        let plain = Budget::new(tolerance, &[]);
        assert_eq!(plain.whole(), 3e-4);
        assert_eq!(plain.airlight_relative(), 0.0);
        let left = plain.water(std::iter::empty(), Gain::ONE).unwrap();
        assert!((left - (3e-4 - ROUNDING)).abs() < 1e-15);
    }

    #[test]
    fn stages_after_the_exposure_use_up_nothing() {
        let style = Stage {
            bound: Some(ErrorBound::absolute(1.0)),
            ..Stage::new(StageId::Style, Variant::Fast("table"))
        };
        let tolerance = Some(ErrorBound::absolute(3e-4));
        assert_eq!(Budget::new(tolerance, &[style]).whole(), 3e-4);
    }

    #[test]
    fn a_tolerated_share_of_the_light_pays_for_airlight_and_rounding() {
        let tolerance = ErrorBound {
            absolute: 3e-4,
            relative: 4e-3,
        };
        let metered = Stage {
            gain: Gain {
                absolute: 20.0,
                relative: 2.0,
            },
            bound: Some(ErrorBound::relative(1e-6)),
            ..Stage::new(StageId::Exposure, Variant::Fast("auto"))
        };
        let budget = Budget::new(Some(tolerance), std::slice::from_ref(&metered));
        assert_eq!(budget.whole(), 3e-4 / 20.0);
        let glow = Stage {
            bound: Some(ErrorBound {
                absolute: budget.airlight(),
                relative: budget.airlight_relative(),
            }),
            ..Stage::new(StageId::Glow, Variant::Fast("quadrature"))
        };
        let left = budget.water([&glow].into_iter(), Gain::ONE).unwrap();
        assert!((left - (1.0 - AIRLIGHT) * budget.whole()).abs() < 1e-15, "{left}");
        let water = Stage {
            bound: Some(ErrorBound::absolute(left)),
            ..Stage::new(StageId::ForwardScatter(1), Variant::Fast("chebyshev"))
        };
        let sum = compose([&water, &glow, &metered].into_iter())[1];
        assert!(sum.is_within(tolerance), "{sum:?}");
    }
}
