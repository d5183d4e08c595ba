//! Parameters of the methods.

use serde::Deserialize;
use spec_derive::Described;

/// Parameters of HSCM: homomorphic filter, spatial median, CLAHE and color merge.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Described)]
pub struct Hscm {
    /// gain of high frequencies
    #[field(above(0.0, 20.0), default = 2.5)]
    pub gain_high: f64,
    /// gain of low frequencies
    #[field(above(0.0, 20.0), at_most("gain_high"), default = 0.5)]
    pub gain_low: f64,
    /// cutoff frequency: the width of the picture over it, at least 1, is `delta`
    #[field(above(0.0, 4096.0), excludes("delta"), default = 32)]
    pub cutoff: f64,
    /// cutoff frequency in bins of the transform, instead of `cutoff`
    #[field(above(0.0, 16384.0), unit = "bins")]
    pub delta: Option<f64>,
    /// added to the luma, 0 to 1, before the logarithm
    #[field(within(1e-6, 1.0), default = 0.01)]
    pub eps: f64,
    /// side of the median's window; 1 turns it off
    #[field(within(1, 31), odd, default = 5, unit = "px")]
    pub median_px: usize,
    /// contrast limit of CLAHE in mean bins; 0 turns the limit off
    #[field(within(0.0, 256.0), default = 2)]
    pub clip: f64,
    /// tiles of CLAHE across and down
    #[field(within(1, 256), default = [8, 8])]
    pub tiles: [usize; 2],
    /// whether the chroma of the picture is kept
    #[field(default = "color")]
    pub color: ResultColor,
}

/// Colors of a result.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, Described)]
#[serde(rename_all = "snake_case")]
pub enum ResultColor {
    /// The new luma with the chroma of the picture.
    #[default]
    Color,
    /// The new luma alone.
    Gray,
}

/// Parameters of CLAHE of the luma.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Described)]
pub struct Clahe {
    /// contrast limit of CLAHE in mean bins; 0 turns the limit off
    #[field(within(0.0, 256.0), default = 2)]
    pub clip: f64,
    /// tiles of CLAHE across and down
    #[field(within(1, 256), default = [8, 8])]
    pub tiles: [usize; 2],
}

/// Gray world has no parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Described)]
pub struct GrayWorld {}

/// Parameters of the dark channel priors.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Described)]
pub struct DarkChannel {
    /// side of the window of the dark channel
    #[field(within(1, 101), odd, default = 15, unit = "px")]
    pub window_px: usize,
    /// share of the haze to remove
    #[field(within(0.0, 1.0), default = 0.95)]
    pub omega: f64,
    /// least transmittance
    #[field(within(0.01, 1.0), default = 0.1)]
    pub transmittance_min: f64,
    /// radius of the guided filter
    #[field(within(1, 200), default = 50, unit = "px")]
    pub guide_radius_px: usize,
    /// regularization of the guided filter, for colors in 0 to 1
    #[field(within(1e-6, 1.0), default = 0.001)]
    pub guide_eps: f64,
}

/// Parameters of the restorations that the guided filter refines.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Described)]
pub struct Guided {
    /// radius of the guided filter
    #[field(within(1, 200), default = 50, unit = "px")]
    pub guide_radius_px: usize,
    /// regularization of the guided filter, for colors in 0 to 1
    #[field(within(1e-6, 1.0), default = 0.001)]
    pub guide_eps: f64,
}

/// Parameters of IBLA.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Described)]
pub struct Ibla {
    /// refinement of blurriness and transmittance; `auto` is `matting` unless a tolerance allows `guided`
    #[field(default = "auto")]
    pub refine: IblaRefinement,
    /// radius of the guided filter
    #[field(within(1, 200), default = 50, unit = "px")]
    pub guide_radius_px: usize,
    /// regularization of the guided filter, for colors in 0 to 1
    #[field(within(1e-6, 1.0), default = 0.001)]
    pub guide_eps: f64,
}

/// Refinement of IBLA.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize, Described)]
#[serde(rename_all = "snake_case")]
pub enum IblaRefinement {
    /// The planner's choice.
    #[default]
    Auto,
    /// By the matting Laplacian, as published.
    Matting,
    /// By the guided filter, which is faster.
    Guided,
}

/// Parameters of RD.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Described)]
pub struct Rayleigh {
    /// scale of the Rayleigh distribution, for values in 0 to 1
    #[field(within(0.1, 2.0), default = 0.4)]
    pub rayleigh_scale: f64,
}

/// RGHS has no parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Described)]
pub struct Stretching {}

/// Parameters of the fusion.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Described)]
pub struct Fusion {
    /// gain of the compensation of red by green
    #[field(within(0.0, 5.0), default = 1)]
    pub red_gain: f64,
    /// gain of the compensation of blue by green; 1 suits green water
    #[field(within(0.0, 5.0), default = 0)]
    pub blue_gain: f64,
    /// exponent of the first input, for values in 0 to 1; above 1 darkens
    #[field(within(0.2, 5.0), default = 1.2)]
    pub gamma: f64,
    /// most levels of the pyramids
    #[field(within(1, 16), default = 5)]
    pub levels: usize,
}

/// Parameters of MLLE.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize, Described)]
pub struct Mlle {
    /// exponent of the attenuation map, for values in 0 to 1
    #[field(within(0.1, 5.0), default = 1.2)]
    pub attenuation_gamma: f64,
    /// side of the windows of contrast
    #[field(within(3, 255), odd, default = 25, unit = "px")]
    pub window_px: usize,
    /// largest gain of contrast
    #[field(within(1.0, 10.0), default = 2)]
    pub contrast_max: f64,
    /// regularization of the guided filter, for lightness in 0 to 1
    #[field(within(1e-8, 1.0), default = 0.0001)]
    pub guide_eps: f64,
}

/// Parameters of a network of the user.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize, Described)]
pub struct EnhancerNetwork {
    /// enhancer network, by its name or by the SHA-256 of its file
    #[field(names = Enhancer)]
    pub model: String,
}
