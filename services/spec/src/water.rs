//! The water of a frame: optics, what varies with the place, and the style. Presets and what follows from these numbers
//! are the business of `optics`.

use serde::{Deserialize, Serialize};
use spec_derive::Described;

use crate::daylight::FromAbove;
use crate::suspended::{Sediment, Snow, Turbidity};
use crate::truth::Phase;

/// The water and its style.
#[derive(Debug, Clone, PartialEq, Deserialize, Described)]
pub struct Water {
    /// a preset or coefficients; absent: no water
    pub optics: Option<Optics>,
    /// multiplies every per-meter quantity
    #[field(above(0.0, 1000.0), default = 1)]
    pub range_scale: f64,
    /// depth of the camera below the surface
    #[field(within(0.0, 12_000.0), unit = "m")]
    pub depth_m: Option<f64>,
    /// what daylight's decay with depth does to the scene
    #[field(default = "none")]
    pub ambient: Ambient,
    /// what a pixel without a valid range means
    #[field(default = "background")]
    pub holes: HoleRule,
    /// style model
    #[field(names = Style)]
    pub style: Option<String>,
    /// marine snow; absent: none
    pub snow: Option<Snow>,
    /// patches of murkier water that multiply every coefficient; absent: even water
    pub turbidity: Option<Turbidity>,
    /// clouds of stirred sediment near the bottom and behind thrusters; absent: none
    pub sediment: Option<Sediment>,
    /// network, color table, or what the tolerance allows; absent: `net`
    pub style_tier: Option<StyleTier>,
    /// what becomes of light of lamps that is scattered more than once; absent: `quasi_single`
    pub multiple: Option<Multiple>,
    /// phase function of the glow of lamps; absent: `hg`
    pub glow_phase: Option<PhaseFunction>,
    /// how the water scatters in the artifact `truth`, and nowhere else; absent: `ff`
    pub phase: Option<Phase>,
    /// light from above by direction and depth; absent: as `ambient` and the veiling light have it
    pub from_above: Option<FromAbove>,
}

impl Default for Water {
    fn default() -> Self {
        Self {
            optics: None,
            range_scale: 1.0,
            depth_m: None,
            ambient: Ambient::default(),
            holes: HoleRule::default(),
            style: None,
            snow: None,
            turbidity: None,
            sediment: None,
            style_tier: None,
            multiple: None,
            glow_phase: None,
            phase: None,
            from_above: None,
        }
    }
}

impl From<Optics> for Water {
    /// A water of these optics, all else as in a description that says nothing of it.
    fn from(optics: Optics) -> Self {
        Self {
            optics: Some(optics),
            ..Self::default()
        }
    }
}

/// A preset, coefficients, or a preset with fields replaced; absent is unknown. Arrays are R, G, B, coefficients in 1/m.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, Described)]
#[serde(deny_unknown_fields, default)]
#[described(short = "preset")]
pub struct Optics {
    /// the preset whose fields the others replace
    #[field(names = Preset)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub preset: Option<String>,
    /// what these coefficients are called; a water of the user's own brings its name
    #[field(fixed, names = WaterName)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// c = a + b
    #[field(within(0.0, 1000.0), unit = "1/m")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub beam_attenuation_per_m: Option<[f64; 3]>,
    /// a
    #[field(within(0.0, 1000.0), unit = "1/m")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub absorption_per_m: Option<[f64; 3]>,
    /// b
    #[field(within(0.0, 1000.0), unit = "1/m")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scattering_per_m: Option<[f64; 3]>,
    /// of the revised model; absent: as c
    #[field(within(0.0, 1000.0), unit = "1/m")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub backscatter_attenuation_per_m: Option<[f64; 3]>,
    /// K_d, the decay of daylight with depth
    #[field(within(0.0, 1000.0), unit = "1/m")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub diffuse_attenuation_per_m: Option<[f64; 3]>,
    /// backscatter radiance at infinite range, linear
    #[field(within(0.0, 1000.0))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub veiling_light: Option<[f64; 3]>,
    /// brightness of a derived veiling light
    #[field(within(0.0, 1000.0))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub veil_gain: Option<f64>,
    /// b_b/b, for the glow of lamps; absent: 0.0183
    #[field(within(0.002, 0.5))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub backscatter_fraction: Option<f64>,
    /// absent: `jaffe` if a and b are known, else none
    #[serde(skip_serializing_if = "Option::is_none")]
    pub forward_scatter: Option<ForwardScatter>,
}

/// Forward scatter of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, Described)]
#[serde(deny_unknown_fields)]
pub struct ForwardScatter {
    /// the form
    #[field(default = "jaffe")]
    pub model: ScatterModel,
    /// G, at most c; absent: derived
    #[field(within(0.0, 1000.0), unit = "1/m")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub g_per_m: Option<[f64; 3]>,
    /// growth of the kernel with range; absent: derived
    #[field(within(0.0, 100_000.0), unit = "px/m")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spread_px_per_m: Option<[f64; 3]>,
    /// kernel at range 0; absent: 0, or derived with the growth
    #[field(within(0.0, 100_000.0), unit = "px")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spread_offset_px: Option<[f64; 3]>,
    /// the light `jaffe` spreads
    #[field(default = "radiance")]
    pub source: ScatterSource,
    /// kernels of each path in `jaffe`: `two` follow from `law` and b; absent: `one`
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spread: Option<ScatterSpread>,
    /// phase function that two kernels are fitted to; absent: `ff`
    #[serde(skip_serializing_if = "Option::is_none")]
    pub law: Option<PhaseFunction>,
    /// whether near objects stop the spread light of what is behind them; absent: `none`
    #[serde(skip_serializing_if = "Option::is_none")]
    pub occlusion: Option<Occlusion>,
    /// most layers of a `gated` frame; absent: 3
    #[field(within(1, 4))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub layers: Option<usize>,
}

impl From<ScatterModel> for ForwardScatter {
    /// This form with all its numbers derived.
    fn from(model: ScatterModel) -> Self {
        Self {
            model,
            g_per_m: None,
            spread_px_per_m: None,
            spread_offset_px: None,
            source: ScatterSource::default(),
            spread: None,
            law: None,
            occlusion: None,
            layers: None,
        }
    }
}

/// The two published forms of forward scatter, or none.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, Described)]
#[serde(rename_all = "snake_case")]
pub enum ScatterModel {
    /// Jaffe–McGlamery: each point of the scene spreads with its own range (Eq. 3-6 as meant).
    Jaffe,
    /// Each image point gathers with its own range (Eq. 8-9).
    Simplified,
    /// No forward scatter.
    None,
}

/// What light the `jaffe` form spreads.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, Described)]
#[serde(rename_all = "snake_case")]
pub enum ScatterSource {
    /// U = J w, so that no more than e^{−GZ} of the light arrives.
    #[default]
    Radiance,
    /// U = J T w, Eq. 3 to the letter.
    Direct,
}

/// How many kernels spread the light of one path.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, Described)]
#[serde(rename_all = "snake_case")]
pub enum ScatterSpread {
    /// One Cauchy kernel.
    One,
    /// A narrow and a wide one, whose tail is that of Monte Carlo.
    Two,
}

/// A phase function.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, Described)]
#[serde(rename_all = "snake_case")]
pub enum PhaseFunction {
    /// Fournier–Forand: two kernels are fitted to it with b_b/b = 0.018; the glow rises toward the back as it does.
    #[default]
    Ff,
    /// Henyey–Greenstein: two kernels are fitted to it with g = 0.924.
    Hg,
}

/// Whether spread light knows what is in front.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, Described)]
#[serde(rename_all = "snake_case")]
pub enum Occlusion {
    /// Light from behind passes through near objects.
    None,
    /// Near objects stop it where they stand.
    Gated,
}

/// What daylight's decay with depth does to the scene.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, Described)]
#[serde(rename_all = "snake_case")]
pub enum Ambient {
    /// The picture is what the camera would see in air, already lit.
    #[default]
    None,
    /// Radiance and a given veiling light are multiplied by exp(−K_d h).
    Absolute,
    /// Radiance is multiplied by exp(−K_d h) over its largest channel, as a camera that exposes for the depth shows it.
    Exposed,
}

/// What becomes of light of lamps that is scattered more than once.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, Described)]
#[serde(rename_all = "snake_case")]
pub enum Multiple {
    /// It is lost.
    None,
    /// It is joined to the light that was scattered once or not at all, by the formulas of quasi-single scattering.
    QuasiSingle,
}

/// What a pixel without a valid range means.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, Described)]
#[serde(rename_all = "snake_case")]
pub enum HoleRule {
    /// The ray meets only water: nothing of the scene arrives where the water attenuates at all.
    #[default]
    Background,
    /// The frame is refused.
    Reject,
    /// range that takes the place of a hole's
    #[field(within(0.001, 100_000.0), unit = "m")]
    RangeM(f64),
}

/// What of a style model is run.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Described)]
#[serde(rename_all = "snake_case")]
pub enum StyleTier {
    /// The network.
    Net,
    /// Its color table.
    Lut,
    /// The table where its measured distance from the network is within the tolerance, else the network.
    Auto,
}
