//! How far a computed sample may be from the exact one, and how stages pass that on.

/// `|computed - exact| <= absolute + relative * exact` for every sample of a layer of light.
///
/// A relative error passes unchanged through any stage that weighs light with non-negative weights, such as scatter, a lens
/// or a particle in front. Only absolute errors are amplified.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct ErrorBound {
    /// Linear light.
    pub absolute: f64,
    /// Share of the sample itself.
    pub relative: f64,
}

impl ErrorBound {
    /// No error.
    pub const EXACT: Self = Self {
        absolute: 0.0,
        relative: 0.0,
    };

    /// An error that does not depend on the sample.
    #[must_use]
    pub const fn absolute(absolute: f64) -> Self {
        Self {
            absolute,
            relative: 0.0,
        }
    }

    /// An error that is a share of the sample.
    #[must_use]
    pub const fn relative(relative: f64) -> Self {
        Self {
            absolute: 0.0,
            relative,
        }
    }

    /// The largest error of a sample whose exact value is this.
    #[must_use]
    pub fn bound_sample(self, exact: f64) -> f64 {
        self.absolute + self.relative * exact
    }

    /// The largest error of a sample up to white. Brighter light counts as white, since the picture is clipped there.
    #[must_use]
    pub fn up_to_white(self) -> f64 {
        self.bound_sample(1.0)
    }

    /// The sum of two errors.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        Self {
            absolute: self.absolute + other.absolute,
            relative: self.relative + other.relative,
        }
    }

    /// Whether no sample up to white exceeds a tolerance.
    #[must_use]
    pub fn is_within(self, tolerance: Self) -> bool {
        self.absolute <= tolerance.absolute && self.up_to_white() <= tolerance.up_to_white()
    }

    /// Both parts times a factor.
    #[must_use]
    pub fn scaled(self, factor: f64) -> Self {
        Self {
            absolute: self.absolute * factor,
            relative: self.relative * factor,
        }
    }

    /// The greater of each part.
    #[must_use]
    pub fn greater(self, other: Self) -> Self {
        Self {
            absolute: self.absolute.max(other.absolute),
            relative: self.relative.max(other.relative),
        }
    }

    /// The lesser of each part.
    #[must_use]
    pub fn lesser(self, other: Self) -> Self {
        Self {
            absolute: self.absolute.min(other.absolute),
            relative: self.relative.min(other.relative),
        }
    }

    /// The error behind a stage with this gain.
    #[must_use]
    pub fn behind(self, gain: Gain) -> Self {
        Self {
            absolute: self.absolute * gain.absolute,
            relative: self.relative * gain.relative,
        }
    }
}

/// How an error at the input of a stage appears at its output.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gain {
    /// Factor of absolute errors.
    pub absolute: f64,
    /// Factor of relative errors; 1 for every stage with fixed non-negative weights.
    pub relative: f64,
}

impl Gain {
    /// Errors pass as they are.
    pub const ONE: Self = Self::factor(1.0);

    /// A stage whose weights are fixed and add up to at most `factor`.
    #[must_use]
    pub const fn factor(factor: f64) -> Self {
        Self {
            absolute: factor,
            relative: 1.0,
        }
    }

    /// One stage after the other.
    #[must_use]
    pub fn then(self, next: Self) -> Self {
        Self {
            absolute: self.absolute * next.absolute,
            relative: self.relative * next.relative,
        }
    }
}
