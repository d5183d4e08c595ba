//! A water as shown by the service and the command line.

use catalogue::UnixMs;
use optics::preset::{Channels, Preset};
use optics::water::properties;
use serde::Serialize;
use utoipa::ToSchema;

/// An optical water. Arrays are R, G, B; absent coefficients are unknown, not zero.
#[derive(Debug, Serialize, ToSchema)]
#[schema(as = Water)]
pub struct WaterView {
    /// The full name; the part before `/` selects the default source's preset.
    #[schema(example = "jerlov-3C/williamson2022")]
    pub(super) name: String,
    /// Time at which it was added through the API; null: a shipped water.
    #[schema(format = DateTime)]
    created_at: Option<String>,
    /// Jerlov's type, if it is one.
    #[schema(example = "3C")]
    jerlov_type: Option<String>,
    /// Source of the numbers.
    source: String,
    /// License of the numbers, or `unknown`.
    licence: String,
    /// Caveats for users.
    caveats: Vec<String>,
    /// Wavelengths of R, G and B, nm.
    wavelength_nm: Option<[Option<f64>; 3]>,
    /// Absorption a, 1/m.
    absorption_per_m: Option<[Option<f64>; 3]>,
    /// Scattering b, 1/m.
    scattering_per_m: Option<[Option<f64>; 3]>,
    /// Beam attenuation c = a + b, 1/m.
    beam_attenuation_per_m: Option<[Option<f64>; 3]>,
    /// Diffuse attenuation K_d, 1/m.
    diffuse_attenuation_per_m: Option<[Option<f64>; 3]>,
    /// Backscatter radiance at infinite range, linear; a derived one is for a camera 5 m below the surface.
    veiling_light: Option<[f64; 3]>,
    /// b_b/b, for the airlight of lamps. Waters do not determine it: set it in the job.
    backscatter_fraction: Option<f64>,
    /// G of the forward scatter, 1/m.
    g_per_m: Option<[Option<f64>; 3]>,
    /// Width of the forward-scatter kernel at range 0, radians.
    spread_offset_rad: Option<f64>,
    /// Growth of that width with range, radians per meter.
    spread_rad_per_m: Option<[Option<f64>; 3]>,
    /// The derived fields among those above.
    derived: Vec<&'static str>,
    /// Anomalies of the numbers.
    warnings: Vec<String>,
    /// Findings of the self-tests: known misprints of the source.
    defects: Vec<String>,
    /// Why jobs cannot use it; null: they can.
    unrenderable: Option<String>,
}

impl WaterView {
    /// A water with all derived values.
    #[must_use]
    pub fn new(preset: &Preset, created_at: Option<UnixMs>) -> Self {
        let all = properties(preset);
        Self {
            name: preset.name.clone(),
            created_at: created_at.map(|time| time.to_string()),
            jerlov_type: preset.jerlov_type.clone(),
            source: preset.source.clone(),
            licence: preset.licence.clone(),
            caveats: preset.caveats.clone(),
            wavelength_nm: known(preset.wavelength_nm),
            absorption_per_m: known(preset.absorption),
            scattering_per_m: known(preset.scattering),
            beam_attenuation_per_m: known(preset.beam_attenuation),
            diffuse_attenuation_per_m: known(preset.diffuse_attenuation),
            veiling_light: all.veiling_light,
            backscatter_fraction: all.backscatter_fraction,
            g_per_m: known(all.g),
            spread_offset_rad: all.spread_offset_rad,
            spread_rad_per_m: known(all.spread_rad_per_m),
            derived: all.derived,
            warnings: preset.warnings.clone(),
            defects: preset.defects.clone(),
            unrenderable: preset.unrenderable(),
        }
    }
}

/// `None` if all channels are unknown.
fn known(values: Channels) -> Option<Channels> {
    values.iter().any(Option::is_some).then_some(values)
}
