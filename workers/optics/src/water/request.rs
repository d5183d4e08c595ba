//! A request for a water, as far as it goes: what is absent is unknown.

use crate::range::HoleRule;

/// What is asked for. Coefficients in 1/m, arrays R, G, B; absent means unknown, never zero.
#[derive(Debug, Clone, PartialEq)]
pub struct WaterRequest {
    /// Preset whose numbers stand in for what is not given.
    pub preset: Option<String>,
    /// c = a + b.
    pub beam_attenuation: Option<[f64; 3]>,
    /// a.
    pub absorption: Option<[f64; 3]>,
    /// b.
    pub scattering: Option<[f64; 3]>,
    /// Backscatter attenuation of the revised model (Akkaynak & Treibitz 2018); absent: as the direct one.
    pub backscatter_attenuation: Option<[f64; 3]>,
    /// K_d, decay of daylight with depth.
    pub diffuse_attenuation: Option<[f64; 3]>,
    /// Veiling light, linear.
    pub veiling_light: Option<[f64; 3]>,
    /// Brightness of a derived veiling light.
    pub veil_gain: Option<f64>,
    /// Depth of the camera below the surface, m.
    pub depth_m: Option<f64>,
    /// What daylight's decay does to the scene.
    pub ambient: Ambient,
    /// What a pixel without range means.
    pub holes: HoleRule,
    /// Multiplies every per-metre quantity along the ray: c, a, b, backscatter attenuation, G and the spread per metre. K_d
    /// acts along the depth and stays as it is.
    pub range_scale: f64,
    /// b_b/b, the share of the scattered light that goes backwards; absent: that of average sea particles.
    pub backscatter_fraction: Option<f64>,
    /// Whether lamps light the water, which takes scattering.
    pub lamps: bool,
    /// Forward scatter; absent: `jaffe` where absorption and scattering are known, else none.
    pub scatter: Option<ScatterRequest>,
}

impl Default for WaterRequest {
    fn default() -> Self {
        Self {
            preset: None,
            beam_attenuation: None,
            absorption: None,
            scattering: None,
            backscatter_attenuation: None,
            diffuse_attenuation: None,
            veiling_light: None,
            veil_gain: None,
            depth_m: None,
            ambient: Ambient::None,
            holes: HoleRule::Background,
            range_scale: 1.0,
            backscatter_fraction: None,
            lamps: false,
            scatter: None,
        }
    }
}

/// What daylight's decay with depth does to the scene.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum Ambient {
    /// The scene is as it would be seen in air.
    #[default]
    None,
    /// Radiance and a given veiling light are multiplied by exp(−K_d h).
    Absolute,
    /// Radiance is multiplied by exp(−K_d h) over its largest channel, as a camera that exposes for the depth shows it.
    Exposed,
}

/// Which form of forward scatter.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ScatterModel {
    /// Jaffe–McGlamery, scatter.
    Jaffe,
    /// Eq. 8-9, gather.
    Simplified,
    /// None.
    None,
}

/// What light the Jaffe form spreads.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum ScatterSource {
    /// U = J w, so that no more than e^{−GZ} of the light arrives.
    #[default]
    Radiance,
    /// U = J T w, Eq. 3 to the letter.
    Direct,
}

/// A request for forward scatter.
#[derive(Debug, Clone, PartialEq)]
pub struct ScatterRequest {
    /// Which form.
    pub model: ScatterModel,
    /// G, 1/m; absent: a + 0.05 b.
    pub g: Option<[f64; 3]>,
    /// k, pixels per metre; absent: 0.009 b f.
    pub spread_px_per_m: Option<[f64; 3]>,
    /// γ₀, pixels; absent: 0 with a given spread, 0.009 f with a derived one.
    pub spread_offset_px: Option<[f64; 3]>,
    /// What light is spread.
    pub source: ScatterSource,
}
