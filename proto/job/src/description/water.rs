//! The water of a frame: optics, spatial variation, and style. `optics` defines presets and derived numbers.

use serde::{Deserialize, Serialize};
use spec_derive::Described;

use crate::suspended::{Sediment, Snow, Turbidity};

/// The water and its style.
#[derive(Debug, Clone, PartialEq, Deserialize, Described)]
pub struct Water {
    /// preset or coefficients; no water by default
    pub optics: Option<Optics>,
    /// factor on every per-meter quantity
    #[field(above(0.0, 1000.0), default = 1, needs("optics"))]
    pub range_scale: f64,
    /// depth of the camera below the surface; 5 in daylight by default
    #[field(within(0.0, 12_000.0), unit = "m", needs("optics"))]
    pub depth_m: Option<f64>,
    /// treatment of pixels without a valid range
    #[field(default = "background", needs("optics"))]
    pub holes: HoleRule,
    /// style model
    #[field(names = Style)]
    pub style: Option<String>,
    /// marine snow; none by default
    pub snow: Option<Snow>,
    /// turbidity patches that multiply every coefficient; none by default
    #[field(needs("optics"))]
    pub turbidity: Option<Turbidity>,
    /// clouds of stirred sediment near the bottom and behind thrusters; none by default
    #[field(untraced = "clouds are not traced")]
    pub sediment: Option<Sediment>,
}

impl Default for Water {
    fn default() -> Self {
        Self {
            optics: None,
            range_scale: 1.0,
            depth_m: None,
            holes: HoleRule::default(),
            style: None,
            snow: None,
            turbidity: None,
            sediment: None,
        }
    }
}

impl From<Optics> for Water {
    /// A water with these optics and default values otherwise.
    fn from(optics: Optics) -> Self {
        Self {
            optics: Some(optics),
            ..Self::default()
        }
    }
}

/// A preset, coefficients, or a preset with overrides; an absent value is unknown. Arrays are R, G, B, coefficients
/// in 1/m.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, Described)]
#[serde(deny_unknown_fields, default)]
#[described(short = "preset")]
pub struct Optics {
    /// preset whose fields the others replace
    #[field(names = Preset)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub preset: Option<String>,
    /// name of these coefficients; set by a user-defined water
    #[field(fixed, names = WaterName)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// beam attenuation c = a + b
    #[field(within(0.0, 1000.0), unit = "1/m")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub beam_attenuation_per_m: Option<[f64; 3]>,
    /// absorption a
    #[field(within(0.0, 1000.0), unit = "1/m")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub absorption_per_m: Option<[f64; 3]>,
    /// scattering b
    #[field(within(0.0, 1000.0), unit = "1/m")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scattering_per_m: Option<[f64; 3]>,
    /// backscatter attenuation of the revised model; c by default
    #[field(within(0.0, 1000.0), unit = "1/m")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub backscatter_attenuation_per_m: Option<[f64; 3]>,
    /// diffuse attenuation K_d: decay of daylight with depth
    #[field(within(0.0, 1000.0), unit = "1/m")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub diffuse_attenuation_per_m: Option<[f64; 3]>,
    /// backscatter radiance at infinite range, linear
    #[field(within(0.0, 1000.0), excludes("daylight.sun_elevation_deg"))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub veiling_light: Option<[f64; 3]>,
    /// brightness factor of a derived veiling light
    #[field(within(0.0, 1000.0), excludes("daylight.sun_elevation_deg"))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub veil_gain: Option<f64>,
    /// b_b/b; 0.0183 if the preset has none
    #[field(within(0.002, 0.5))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub backscatter_fraction: Option<f64>,
    /// phase function of the water, used for the airlight of lamps, the forward scatter and the Monte Carlo truth
    #[field(default = "ff")]
    pub phase: PhaseFunction,
    /// published model of forward scatter; by default two kernels from a and b, or none if these are unknown
    #[serde(skip_serializing_if = "Option::is_none")]
    pub forward_scatter: Option<ForwardScatter>,
}

impl Optics {
    /// Whether the description sets the veiling light, which overrides the daylight's.
    #[must_use]
    pub fn sets_veil(&self) -> bool {
        self.veiling_light.is_some() || self.veil_gain.is_some()
    }
}

/// Forward scatter of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, Described)]
#[serde(deny_unknown_fields)]
pub struct ForwardScatter {
    /// variant of the model
    #[field(default = "jaffe")]
    pub model: ScatterModel,
    /// G, at most c; derived by default
    #[field(within(0.0, 1000.0), unit = "1/m")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub g_per_m: Option<[f64; 3]>,
    /// growth of the kernel with range; derived by default
    #[field(within(0.0, 100_000.0), unit = "px/m")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spread_px_per_m: Option<[f64; 3]>,
    /// kernel at range 0; 0 by default, or derived with the growth
    #[field(within(0.0, 100_000.0), unit = "px")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spread_offset_px: Option<[f64; 3]>,
    /// light that `jaffe` spreads
    #[field(default = "radiance")]
    pub source: ScatterSource,
}

impl From<ScatterModel> for ForwardScatter {
    /// A model with derived numbers.
    fn from(model: ScatterModel) -> Self {
        Self {
            model,
            g_per_m: None,
            spread_px_per_m: None,
            spread_offset_px: None,
            source: ScatterSource::default(),
        }
    }
}

/// The published variants of forward scatter, or none.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, Described)]
#[serde(rename_all = "snake_case")]
pub enum ScatterModel {
    /// Jaffe–McGlamery: each scene point spreads by its range (Eq. 3-6, corrected).
    Jaffe,
    /// Each image point gathers by its range (Eq. 8-9).
    Simplified,
    /// No forward scatter.
    None,
}

/// The light spread by `jaffe`.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, Described)]
#[serde(rename_all = "snake_case")]
pub enum ScatterSource {
    /// U = J w, so that at most e^{−GZ} of the light arrives.
    #[default]
    Radiance,
    /// U = J T w, Eq. 3 as printed.
    Direct,
}

/// A phase function.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, Described)]
#[serde(rename_all = "snake_case")]
pub enum PhaseFunction {
    /// Fournier–Forand with the water's backscatter fraction.
    #[default]
    Ff,
    /// Henyey–Greenstein with the mean cosine that yields the water's backscatter fraction.
    Hg,
}

/// Treatment of pixels without a valid range.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, Described)]
#[serde(rename_all = "snake_case")]
pub enum HoleRule {
    /// The ray sees only water, at infinite range.
    #[default]
    Background,
    /// The frame fails.
    Reject,
    /// range used for holes
    #[field(
        within(0.001, 100_000.0),
        unit = "m",
        untraced = "a hole is traced as open water"
    )]
    RangeM(f64),
}
