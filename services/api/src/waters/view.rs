//! A water as shown by the service and the command line.

use client::{UnixMs, WaterView};
use optics::preset::{Channels, Preset};
use optics::water::properties;

/// The view of a water, with its derived properties; `created_at` is set for those added through the API.
#[must_use]
pub fn water_view(preset: &Preset, created_at: Option<UnixMs>) -> WaterView {
    let all = properties(preset);
    let some = |values: Channels| values.iter().any(Option::is_some).then_some(values);
    WaterView {
        name: preset.name.clone(),
        created_at: created_at.map(|time| time.to_string()),
        jerlov_type: preset.jerlov_type.clone(),
        source: preset.source.clone(),
        licence: preset.licence.clone(),
        caveats: preset.caveats.clone(),
        wavelength_nm: some(preset.wavelength_nm),
        absorption_per_m: some(preset.absorption),
        scattering_per_m: some(preset.scattering),
        beam_attenuation_per_m: some(preset.beam_attenuation),
        diffuse_attenuation_per_m: some(preset.diffuse_attenuation),
        veiling_light: all.veiling_light,
        backscatter_fraction: all.backscatter_fraction,
        g_per_m: some(all.g),
        spread_offset_rad: all.spread_offset_rad,
        spread_rad_per_m: some(all.spread_rad_per_m),
        derived: all.derived.into_iter().map(str::to_owned).collect(),
        warnings: preset.warnings.clone(),
        defects: preset.defects.clone(),
        unrenderable: preset.unrenderable(),
    }
}
