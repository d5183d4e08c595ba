//! `GET /v1/waters`.

use axum::Json;
use optics::preset::{Preset, presets};
use serde::Serialize;
use utoipa::ToSchema;

use crate::paging::Page;

/// An optical water preset. Arrays are R, G, B; absent coefficients are unknown, not zero.
#[derive(Debug, Serialize, ToSchema)]
pub(crate) struct Water {
    /// The full name; the part before `/` names the default source's preset.
    #[schema(example = "jerlov-3C/williamson2022")]
    name: &'static str,
    /// Where the numbers come from.
    source: &'static str,
    /// Under what licence they are published.
    licence: &'static str,
    /// What the user should know.
    caveats: &'static [&'static str],
    /// Wavelengths that stand for R, G and B, nm.
    wavelength_nm: Option<[f64; 3]>,
    /// a, 1/m.
    absorption_per_m: Option<[f64; 3]>,
    /// b, 1/m.
    scattering_per_m: Option<[f64; 3]>,
    /// c = a + b, 1/m.
    beam_attenuation_per_m: Option<[f64; 3]>,
    /// K_d, 1/m.
    diffuse_attenuation_per_m: Option<[f64; 3]>,
    /// Backscatter radiance at infinite range, linear.
    veiling_light: Option<[f64; 3]>,
    /// Why jobs cannot use it; null: they can.
    unrenderable: Option<String>,
}

impl From<&Preset> for Water {
    fn from(preset: &Preset) -> Self {
        Self {
            name: preset.name,
            source: preset.source,
            licence: preset.licence,
            caveats: preset.caveats,
            wavelength_nm: preset.wavelength_nm,
            absorption_per_m: preset.absorption,
            scattering_per_m: preset.scattering,
            beam_attenuation_per_m: preset.beam_attenuation,
            diffuse_attenuation_per_m: preset.diffuse_attenuation,
            veiling_light: preset.veiling_light,
            unrenderable: preset.unrenderable().map(|why| why.to_string()),
        }
    }
}

/// List the optical water presets, all on one page.
#[utoipa::path(get, path = "/v1/waters", tag = "waters",
    responses((status = 200, description = "All presets.", body = Page<Water>)))]
pub(crate) async fn list() -> Json<Page<Water>> {
    Json(Page {
        items: presets().iter().map(Water::from).collect(),
        next_cursor: None,
    })
}
