//! Fields and values of version 0.1, and their replacements.

/// A field or value removed since version 0.1.
#[derive(Debug, Clone, Copy)]
pub struct Removed {
    /// Path such as `lights[].shadow`.
    pub path: &'static str,
    /// The removed value; `None` if the whole field was removed.
    pub value: Option<&'static str>,
    /// Replacement.
    pub now: &'static str,
}

const DERIVED: &str = "remove it: it follows from `water.optics`, `water.depth_m` and `daylight`";
const PLANNED: &str = "remove it: the planner chooses by `fidelity`";
const SHADOWS: &str = "remove it: every lamp casts shadows, softer with a larger `radius_m`";

/// Declares removed fields (`PATH => REPLACEMENT`) and values (`PATH = VALUE => REPLACEMENT`).
macro_rules! removed {
    (@value) => { None };
    (@value $value:literal) => { Some($value) };
    ($($path:literal $(= $value:literal)? => $now:expr;)*) => {
        &[$(Removed { path: $path, value: removed!(@value $($value)?), now: $now }),*]
    };
}

/// All removed fields and values, in field order.
pub const REMOVED: &[Removed] = removed! {
    "scene.light" = "baked" => "`\"lighting\": \"in_air\"`";
    "scene.light" = "albedo" => "`\"lighting\": \"water\"`, the default of procedural scenes";
    "scene.light" => "`scene.lighting`: \"in_air\" or \"water\"";
    "camera.motion.samples" => "remove it: 8 images along the path are averaged";
    "camera.motion.exposure_s" => "`camera.exposure_s`";
    "camera.rolling" => "`camera.readout_s`";
    "camera.rolling.readout_s" => "`camera.readout_s`";
    "camera.rolling.bands" => "remove it: rows are taken in 16 bands";
    "camera.seed" => "remove it: pattern and noise of the sensor follow `seed`";
    "camera.port.n_w" => "remove it: the refractive index is that of sea water";
    "camera.sensor.exposure_s" => "`camera.exposure_s`";
    "camera.sensor.white_at" => "`camera.sensor.light_level`, relative to the exposure of the preset";
    "camera.sensor.shot" => "remove it: every sensor except the preset `ideal` counts electrons";
    "camera.vignette.v1" => "`camera.vignette.v` or `camera.vignette.v2`";
    "camera.vignette.v3" => "`camera.vignette.v` or `camera.vignette.v2`";
    "camera.jpeg.measured" => "remove it: metrics and enhancements use the compressed image";
    "water.ambient" => "describe the sky by `daylight`, or write `\"daylight\": \"none\"` by night";
    "water.from_above" => "describe the sky by `daylight`";
    "water.from_above.veil" => DERIVED;
    "water.from_above.level" => "remove it; `camera.exposure` sets the brightness";
    "water.from_above.horizon" => DERIVED;
    "water.from_above.p" => DERIVED;
    "water.from_above.q" => DERIVED;
    "water.from_above.surfaces" => "`scene.lighting`: \"water\" lights the surfaces, \"in_air\" leaves them unchanged";
    "water.from_above.sun_share" => "`daylight.cloud_cover` and `daylight.sun_elevation_deg`, which determine it";
    "water.from_above.sun" => "`daylight.sun_elevation_deg` and `daylight.sun_azimuth_deg`";
    "water.from_above.sun.elevation_deg" => "`daylight.sun_elevation_deg`";
    "water.from_above.sun.azimuth_deg" => "`daylight.sun_azimuth_deg`";
    "water.from_above.sun.shadow" => "remove it: the sun casts shadows unless `daylight.cloud_cover` is 1";
    "water.from_above.ambient_rays" => PLANNED;
    "water.from_above.caustics" => "`daylight.wind_m_per_s`, which determines the waves";
    "water.from_above.shafts" => "remove it: `daylight` and the waves determine the shafts";
    "water.multiple" => PLANNED;
    "water.glow_phase" => "`water.optics.phase`: \"ff\" or \"hg\"";
    "water.phase" => "`water.optics.phase`: \"ff\" or \"hg\", with `water.optics.backscatter_fraction`";
    "water.style_tier" => PLANNED;
    "water.optics.forward_scatter.spread" => "remove it: without `forward_scatter`, two kernels are derived from a and b";
    "water.optics.forward_scatter.law" => "`water.optics.phase`";
    "water.optics.forward_scatter.occlusion" => PLANNED;
    "water.optics.forward_scatter.layers" => PLANNED;
    "water.snow.radius_spread" => "`water.snow.spectrum`, the slope of the radii";
    "water.snow.discs" => "remove it: particles are blurred by `camera.defocus`";
    "water.snow.daylight" => DERIVED;
    "water.sediment.plume_m" => "remove it: plumes are 1.5 m long";
    "lights[].shadow" => SHADOWS;
    "lights[].samples" => SHADOWS;
    "lights[].glow_shadow" => SHADOWS;
    "rays" => "remove it: shadow rays use the solids of a procedural scene, else the range image";
    "artifacts" = "hscm_mask" => "\"enhanced.hscm.mask\", with {\"method\": \"hscm\", \"mask\": \"paper\"} in `enhance`";
    "enhance" = "grey_world" => "\"gray_world\"";
    "enhance" = "ibla_guided" => "{\"method\": \"ibla\", \"refine\": \"guided\"}";
    "enhance" = "ibla_hybrid" => "\"ibla\": the planner chooses the variant by `fidelity`";
    "png_text" => "remove it: PNG files always contain their kind, unit and meaning";
    "truth.block" => "remove it: errors count in blocks of 8 pixels";
    "truth.seed" => "remove it: the paths follow `seed`";
    "fidelity.variant" = "reference" => "`\"fidelity\": \"reference\"`";
    "fidelity.variant" = "display" => "`\"fidelity\": \"picture\"`, the default";
    "fidelity.variant" = "noise" => "`\"fidelity\": \"picture\"`, the default, which allows for the noise of a sensor";
    "fidelity.variant" => "`\"fidelity\": \"picture\"` or `\"fidelity\": \"reference\"`";
};

impl Removed {
    /// The replacement as an instruction.
    pub(crate) fn instruction(&self) -> String {
        match self.now.starts_with(['`', '"']) {
            true => format!("use {}", self.now),
            false => self.now.to_owned(),
        }
    }
}

/// The replacement of a removed field at this path; `written` decides if the path is ambiguous.
pub(crate) fn find_field(path: &str, written: Option<&str>) -> Option<&'static Removed> {
    let mut rows = REMOVED.iter().filter(|removed| removed.path == path);
    let matching_value = rows
        .clone()
        .find(|removed| removed.value.is_some() && removed.value == written);
    matching_value.or_else(|| rows.find(|removed| removed.value.is_none()))
}

/// The replacement of a removed value of an existing field.
pub(crate) fn find_value(path: &str, written: &str) -> Option<&'static Removed> {
    REMOVED
        .iter()
        .find(|removed: &&Removed| removed.path == path && removed.value == Some(written))
}

/// The table in Markdown.
#[must_use]
pub fn markdown() -> String {
    let mut text = "| up to 0.1 | from 0.2 |\n|---|---|\n".to_owned();
    for Removed { path, value, now } in REMOVED {
        let value = value.map(|value| format!(": \"{value}\"")).unwrap_or_default();
        text += &format!("| `{path}{value}` | {now} |\n");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::table;

    #[test]
    fn no_removed_field_is_accepted() {
        let accepted: Vec<_> = table::rows().into_iter().map(|row| row.path).collect();
        for removed in REMOVED.iter().filter(|removed| removed.value.is_none()) {
            assert!(
                !accepted.iter().any(|path| without_kinds(path) == removed.path),
                "{}",
                removed.path
            );
        }
    }

    fn without_kinds(path: &str) -> String {
        let parts = path
            .split('(')
            .map(|part| part.split_once(')').map_or(part, |(_, rest)| rest));
        parts.collect()
    }
}
