//! Errors in the description of a water.

use spec::Beyond;

/// One contradiction or gap. [`WaterError::field`] names the field as the job description does.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum WaterError {
    /// A number is outside its limits.
    #[error(transparent)]
    Beyond(#[from] Beyond),
    /// Absorption, scattering or G alone exceeds the beam attenuation.
    #[error("{field} is {value} in channel {channel} but at most the beam attenuation, {limit}")]
    MoreThanAttenuation {
        /// The field.
        field: &'static str,
        /// `R`, `G` or `B`.
        channel: char,
        /// a, b or G, 1/m.
        value: f64,
        /// c, 1/m.
        limit: f64,
    },
    /// Beam attenuation is not the sum of absorption and scattering.
    #[error(
        "beam_attenuation_per_m is {value} in channel {channel} but absorption and scattering sum to {sum}"
    )]
    Inconsistent {
        /// `R`, `G` or `B`.
        channel: char,
        /// c, 1/m.
        value: f64,
        /// a + b, 1/m.
        sum: f64,
    },
    /// No preset of this name.
    #[error("preset `{name}` does not exist")]
    UnknownPreset {
        /// The name.
        name: String,
    },
    /// Two fields that exclude each other.
    #[error("{field} {reason}")]
    Contradiction {
        /// The field.
        field: &'static str,
        /// The contradiction.
        reason: &'static str,
    },
    /// A required number is neither given nor derivable.
    #[error("{field} is missing: {reason}")]
    Missing {
        /// The field.
        field: &'static str,
        /// Why it is needed, and how to supply it.
        reason: &'static str,
    },
}

impl WaterError {
    /// The field of the job description that has to change.
    #[must_use]
    pub fn field(&self) -> &'static str {
        match self {
            Self::Beyond(Beyond { field, .. })
            | Self::MoreThanAttenuation { field, .. }
            | Self::Contradiction { field, .. }
            | Self::Missing { field, .. } => field,
            Self::Inconsistent { .. } => "beam_attenuation_per_m",
            Self::UnknownPreset { .. } => "preset",
        }
    }
}
