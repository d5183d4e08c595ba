//! From light to codes: exposure, sensor, white balance, tone curve and compression.

use serde::{Deserialize, Serialize};
use spec_derive::Described;

/// Exposure of the image.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, Described)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Exposure {
    /// factor applied to the light
    #[field(above(0.0, 1e4))]
    Fixed(f64),
    /// metered in each frame
    Auto(Metering),
}

/// Metering: scales a percentile of the luminance to a target, by a factor within 1/64..=64.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, Described)]
#[serde(deny_unknown_fields)]
pub struct Metering {
    /// target of the percentile, white = 1
    #[field(above(0.0, 4.0), default = 0.5)]
    pub target: f64,
    /// share of darker pixels
    #[field(within(0.0, 1.0), default = 0.95)]
    pub percentile: f64,
    /// time constant of the metering in frames; 0 adapts immediately
    #[field(within(0.0, 1000.0), default = 0, needs("camera.path"))]
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

/// A sensor after the linear model of EMVA 1288. Absent fields come from its preset.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, Described)]
#[serde(deny_unknown_fields, default)]
#[described(short = "preset")]
pub struct Sensor {
    /// sensor preset whose fields the others replace; `machine-vision-1/1.8` by default
    #[field(names = Sensor)]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub preset: Option<String>,
    /// electrons a pixel can hold
    #[field(within(100.0, 1e7), unit = "e-")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub full_well_e: Option<f64>,
    /// scene light as a share of the full exposure; lower is noisier
    #[field(above(0.0, 1.0))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub light_level: Option<f64>,
    /// standard deviation of pixel sensitivity, as a share
    #[field(within(0.0, 0.5))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub prnu: Option<f64>,
    /// standard deviation of pixel dark current, as a share
    #[field(within(0.0, 10.0))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dcnu: Option<f64>,
    /// standard deviation of pixel offsets
    #[field(within(0.0, 1000.0), unit = "e-")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dsnu_e: Option<f64>,
    /// dark current
    #[field(within(0.0, 1e6), unit = "e-/s")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dark_e_per_s: Option<f64>,
    /// share of hot pixels, with a thousand times the dark current
    #[field(within(0.0, 0.1))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hot_share: Option<f64>,
    /// read noise of a pixel
    #[field(within(0.0, 1000.0), unit = "e-")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub read_noise_e: Option<f64>,
    /// noise common to a row
    #[field(within(0.0, 1000.0), unit = "e-")]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub row_noise_e: Option<f64>,
    /// bit depth of the converter
    #[field(within(8, 16))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bits: Option<u8>,
    /// black level
    #[field(within(0, 4096))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub black_dn: Option<u16>,
    /// analog gain; the sensor saturates at the full well divided by it
    #[field(within(1.0, 1000.0))]
    #[serde(skip_serializing_if = "Option::is_none")]
    pub gain: Option<f64>,
    /// color filter array; `none` is a sensor per channel
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
    /// No filters: one sensor per channel.
    None,
}

/// White balance.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, Described)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum WhiteBalance {
    /// No correction.
    Off,
    /// Factors that equalize the channel means.
    GrayWorld,
    /// factors of R, G, B
    #[field(within(0.01, 100.0))]
    Fixed([f64; 3]),
}

/// Tone curve from light to codes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, Described)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Tone {
    /// The sRGB curve.
    Srgb,
    /// Codes proportional to light.
    Linear,
    /// exponent of the curve: code = light^(1 / exponent)
    #[field(within(0.2, 5.0))]
    Gamma(f64),
}

/// JPEG compression of the image, encoded and decoded again before metrics and enhancements.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, Described)]
#[serde(deny_unknown_fields)]
pub struct Jpeg {
    /// JPEG quality
    #[field(within(1, 100), default = 90)]
    pub quality: u8,
    /// chroma subsampling
    #[field(default = "full")]
    pub chroma: Chroma,
}

/// Chroma subsampling of a JPEG file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, Described)]
#[serde(rename_all = "snake_case")]
pub enum Chroma {
    /// No subsampling, 4:4:4.
    Full,
    /// Two by two pixels share their chroma, 4:2:0.
    Half,
}
