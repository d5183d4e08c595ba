//! What is wrong with a request for a water.

/// One contradiction or gap. [`WaterError::field`] names the field as the job description does.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum WaterError {
    /// A number lies outside its limits.
    #[error("{field} is {value} in channel {channel} but must lie in {least}..={most}")]
    OutOfRange {
        /// The field.
        field: &'static str,
        /// `R`, `G`, `B`, or `-` for a single number.
        channel: char,
        /// What was given.
        value: f64,
        /// Least value.
        least: f64,
        /// Largest value.
        most: f64,
    },
    /// G exceeds the beam attenuation.
    #[error("g_per_m is {value} in channel {channel} but at most the beam attenuation, {limit}")]
    MoreScatterThanAttenuation {
        /// `R`, `G` or `B`.
        channel: char,
        /// G, 1/m.
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
    /// A number that is needed is neither given nor derivable.
    #[error("{field} is missing: {reason}")]
    Missing {
        /// The field.
        field: &'static str,
        /// Why it is needed, and what would do.
        reason: &'static str,
    },
}

impl WaterError {
    /// The field of the job description that has to change.
    #[must_use]
    pub fn field(&self) -> &'static str {
        match self {
            Self::OutOfRange { field, .. } | Self::Missing { field, .. } => field,
            Self::MoreScatterThanAttenuation { .. } => "g_per_m",
            Self::Inconsistent { .. } => "beam_attenuation_per_m",
            Self::UnknownPreset { .. } => "preset",
        }
    }
}
