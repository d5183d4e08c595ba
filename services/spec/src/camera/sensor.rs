//! From light to codes: exposure, sensor, white balance, tone and compression.

use serde::{Deserialize, Serialize};
use spec_derive::Described;

/// How bright the picture is taken.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, Described)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Exposure {
    /// factor of the light
    #[field(above(0.0, 1e4))]
    Fixed(f64),
    /// metered in each frame
    Auto(Metering),
}

/// Metering: the factor that brings a percentile of the luminance to a target, within 1/64..=64.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, Described)]
#[serde(deny_unknown_fields)]
pub struct Metering {
    /// what the percentile is brought to, white = 1
    #[field(above(0.0, 4.0), default = 0.5)]
    pub target: f64,
    /// share of pixels that are darker
    #[field(within(0.0, 1.0), default = 0.95)]
    pub percentile: f64,
    /// frames in which the factor follows; 0: at once
    #[field(within(0.0, 1000.0), default = 0)]
    pub lag_frames: f64,
}

impl Default for Metering {
    fn default() -> Self {
        Self {
            target: 0.5,
            percentile: 0.95,
            lag_frames: 0.0,
        }
    }
}

/// A sensor after the linear model of EMVA 1288; absent fields come from its preset.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, Described)]
#[serde(deny_unknown_fields, default)]
#[described(short = "preset")]
pub struct Sensor {
    /// the sensor whose fields the others replace; absent: `machine-vision-1/1.8`
    #[field(names = Sensor)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub preset: Option<String>,
    /// electrons that a pixel holds
    #[field(within(100.0, 1e7), unit = "e-")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub full_well_e: Option<f64>,
    /// share of the full well that white fills
    #[field(above(0.0, 1.0))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub white_at: Option<f64>,
    /// multiplies `white_at`: how little light the scene is taken in
    #[field(above(0.0, 1.0))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub light_level: Option<f64>,
    /// spread of the sensitivity of pixels
    #[field(within(0.0, 0.5))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub prnu: Option<f64>,
    /// spread of the dark current of pixels
    #[field(within(0.0, 10.0))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dcnu: Option<f64>,
    /// spread of the offset of pixels
    #[field(within(0.0, 1000.0), unit = "e-")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dsnu_e: Option<f64>,
    /// dark current
    #[field(within(0.0, 1e6), unit = "e-/s")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dark_e_per_s: Option<f64>,
    /// share of pixels with a thousand times the dark current
    #[field(within(0.0, 0.1))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hot_share: Option<f64>,
    /// how long dark current gathers
    #[field(within(1e-6, 100.0), unit = "s")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub exposure_s: Option<f64>,
    /// noise of reading a pixel
    #[field(within(0.0, 1000.0), unit = "e-")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub read_noise_e: Option<f64>,
    /// noise that a row shares
    #[field(within(0.0, 1000.0), unit = "e-")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub row_noise_e: Option<f64>,
    /// whether light arrives in whole electrons
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shot: Option<bool>,
    /// bits of the converter
    #[field(within(8, 16))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bits: Option<u8>,
    /// code of no light
    #[field(within(0, 4096))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub black_dn: Option<u16>,
    /// analog gain; the sensor saturates at the full well over it
    #[field(within(1.0, 1000.0))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gain: Option<f64>,
    /// colors of pixels, or three sensors
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cfa: Option<Cfa>,
}

/// Color filters of the pixels (0,0), (1,0), (0,1), (1,1).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, Described)]
#[serde(rename_all = "snake_case")]
pub enum Cfa {
    /// Red first.
    Rggb,
    /// Blue first.
    Bggr,
    /// Green, then red.
    Grbg,
    /// Green, then blue.
    Gbrg,
    /// No filters: a sensor for each channel.
    None,
}

/// What makes white white.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, Described)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum WhiteBalance {
    /// Nothing.
    Off,
    /// Factors that make the means of the channels equal.
    GrayWorld,
    /// factors of R, G, B
    #[field(within(0.01, 100.0))]
    Fixed([f64; 3]),
}

/// The curve from light to codes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, Described)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Tone {
    /// The sRGB curve.
    Srgb,
    /// Codes proportional to light.
    Linear,
    /// codes of light to the power of 1 over this
    #[field(within(0.2, 5.0))]
    Gamma(f64),
}

/// What compression leaves of the picture: it is encoded and decoded again.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, Described)]
#[serde(deny_unknown_fields)]
pub struct Jpeg {
    /// JPEG quality
    #[field(within(1, 100), default = 90)]
    pub quality: u8,
    /// resolution of the color
    #[field(default = "full")]
    pub chroma: Chroma,
    /// whether metrics and enhancements take the picture after it
    #[field(default = true)]
    pub measured: bool,
}

/// Resolution of the color in a JPEG file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, Described)]
#[serde(rename_all = "snake_case")]
pub enum Chroma {
    /// Every pixel, 4:4:4.
    Full,
    /// Two by two pixels share theirs, 4:2:0.
    Half,
}
