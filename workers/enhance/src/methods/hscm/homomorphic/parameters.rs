//! Parameters of the filter for one picture.

use spec::Hscm;

/// The filter for a picture of one width.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Filter {
    /// Gain of high frequencies, `r_high`.
    pub gain_high: f64,
    /// Gain of low frequencies, `r_low`.
    pub gain_low: f64,
    /// Added to the luma before the logarithm.
    pub eps: f64,
    /// Cutoff in bins, above 0.
    pub delta: f64,
}

impl Filter {
    /// The filter for a picture of this width: `delta` is `max(width / cutoff, 1)` unless given.
    #[must_use]
    pub fn new(parameters: &Hscm, width: usize) -> Self {
        let Hscm {
            gain_high,
            gain_low,
            eps,
            cutoff,
            delta,
            ..
        } = *parameters;
        Self {
            gain_high,
            gain_low,
            eps,
            delta: delta.unwrap_or((width as f64 / cutoff).max(1.0)),
        }
    }

    /// How far a change of the blurred logarithm moves the result: the distance of the gains.
    pub(super) fn drop(&self) -> f64 {
        self.gain_high - self.gain_low
    }

    /// Half of the range of the logarithm times the distance of the gains: the most that stripes of black and white can
    /// move the result.
    pub(super) fn swing(&self) -> f64 {
        0.5 * ((1.0 + self.eps) / self.eps).ln() * self.drop()
    }
}
