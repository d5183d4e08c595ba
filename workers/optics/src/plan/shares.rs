//! How the stages of a frame share its tolerance, so that their errors together stay within it.

use super::levels::{DEFAULT_TOLERANCE, ROUNDING};
use super::{ErrorBound, Gain, Stage, StageId};

/// Share of airlight, for quadrature and rounding: more nodes cost little compared with more kernels.
const AIRLIGHT: f64 = 0.25;
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
    pub tolerance: Option<f64>,
    /// From the light before the camera to the exposed light.
    gain: Gain,
    /// The largest absolute error of the light before the camera.
    whole: f64,
    /// Factor of the shares of stages before the water.
    part: f64,
}

impl Budget {
    /// The budget before these stages of the camera.
    #[must_use]
    pub fn new(tolerance: Option<f64>, camera: &[Stage]) -> Self {
        let exposed = || camera.iter().filter(|stage| stage.id.is_promised());
        let gain = compose_gain(exposed());
        let own = compose(exposed()).map(ErrorBound::up_to_white);
        let own = own.into_iter().fold(0.0, f64::max);
        let asked = tolerance.unwrap_or(DEFAULT_TOLERANCE);
        Self {
            tolerance,
            gain,
            whole: (asked - own).max(LEAST * asked) / gain.absolute,
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
        let relative = used.relative * self.gain.relative / self.gain.absolute;
        Some((self.whole - used.absolute - relative).max(LEAST * self.whole))
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
        let bright = Budget::new(Some(3e-4), std::slice::from_ref(&exposure));
        assert!((bright.whole() - 1.5e-5).abs() < 1e-12);
        let plain = Budget::new(Some(3e-4), &[]);
        assert_eq!(plain.whole(), 3e-4);
        let left = plain.water(std::iter::empty(), Gain::ONE).unwrap();
        assert!((left - (3e-4 - ROUNDING)).abs() < 1e-15);
    }

    #[test]
    fn stages_after_the_exposure_use_up_nothing() {
        let style = Stage {
            bound: Some(ErrorBound::absolute(1.0)),
            ..Stage::new(StageId::Style, Variant::Fast("table"))
        };
        assert_eq!(Budget::new(Some(3e-4), &[style]).whole(), 3e-4);
    }
}
