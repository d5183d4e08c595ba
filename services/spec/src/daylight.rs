//! Light from above: the veil by direction, and what daylight does to surfaces.

use serde::Deserialize;
use spec_derive::Described;

/// Light from above.
#[derive(Debug, Clone, Copy, Default, PartialEq, Deserialize, Described)]
#[serde(deny_unknown_fields, default)]
pub struct FromAbove {
    /// how the veil depends on the direction of sight; absent: `constant`
    pub veil: Option<VeilForm>,
    /// what is as bright as white; absent: as `ambient` has it, else `exposed`
    pub level: Option<DaylightLevel>,
    /// radiance of the horizon over the downwelling irradiance; absent: derived from a, b and b_b/b
    #[field(within(1e-5, 1.0))]
    pub horizon: Option<[f64; 3]>,
    /// slope of the logarithm of radiance with the cosine from the vertical; absent: derived
    #[field(within(0.0, 10.0))]
    pub p: Option<[f64; 3]>,
    /// its curvature; absent: derived
    #[field(within(-5.0, 5.0))]
    pub q: Option<[f64; 3]>,
}

/// How the veil depends on the direction of sight.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Described)]
#[serde(rename_all = "snake_case")]
pub enum VeilForm {
    /// The same in all directions.
    Constant,
    /// The veiling light stands at the horizon; above it is brighter, below darker.
    Field,
    /// The same, with the brightness at the horizon that daylight gives beside white surfaces.
    Physical,
}

/// What is as bright as white in daylight.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Described)]
#[serde(rename_all = "snake_case")]
pub enum DaylightLevel {
    /// A white horizontal patch at the camera's depth, in its brightest channel.
    Exposed,
    /// A white horizontal patch just below the surface of the sea.
    Absolute,
}
