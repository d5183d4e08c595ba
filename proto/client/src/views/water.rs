//! Optical waters.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// An optical water. Arrays are R, G, B; absent coefficients are unknown, not zero.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, ToSchema)]
#[schema(as = Water)]
pub struct WaterView {
    /// The full name; the part before `/` names the default source's preset.
    #[schema(example = "jerlov-3C/williamson2022")]
    pub name: String,
    /// Whether it was given through the API, and when. Null: it comes with the service.
    #[schema(format = DateTime)]
    pub created_at: Option<String>,
    /// Jerlov's type, if it is one.
    #[schema(example = "3C")]
    pub jerlov_type: Option<String>,
    /// Where the numbers come from.
    pub source: String,
    /// Under what licence they are published, or `unknown`.
    pub licence: String,
    /// What the user should know.
    pub caveats: Vec<String>,
    /// Wavelengths that stand for R, G and B, nm.
    pub wavelength_nm: Option<[Option<f64>; 3]>,
    /// a, 1/m.
    pub absorption_per_m: Option<[Option<f64>; 3]>,
    /// b, 1/m.
    pub scattering_per_m: Option<[Option<f64>; 3]>,
    /// c = a + b, 1/m.
    pub beam_attenuation_per_m: Option<[Option<f64>; 3]>,
    /// K_d, 1/m.
    pub diffuse_attenuation_per_m: Option<[Option<f64>; 3]>,
    /// Backscatter radiance at infinite range, linear; a derived one is that of a camera 5 m below the surface.
    pub veiling_light: Option<[f64; 3]>,
    /// b_b/b, for the glow of lamps. A water does not determine it: give your own in the job.
    pub backscatter_fraction: Option<f64>,
    /// G of the forward scatter, 1/m.
    pub g_per_m: Option<[Option<f64>; 3]>,
    /// Width of the forward-scatter kernel at range 0, radians.
    pub spread_offset_rad: Option<f64>,
    /// Growth of that width with range, radians per meter.
    pub spread_rad_per_m: Option<[Option<f64>; 3]>,
    /// The fields above that are derived and not the source's own.
    pub derived: Vec<String>,
    /// What is odd about the numbers.
    pub warnings: Vec<String>,
    /// What the self-tests find: known misprints of the source.
    pub defects: Vec<String>,
    /// Why jobs cannot use it; null: they can.
    pub unrenderable: Option<String>,
}
