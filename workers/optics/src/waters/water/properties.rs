//! A preset with all derived values, and their names.

use super::model::{Scatter, Water};
use crate::lamp::AVERAGE_BACKSCATTER_FRACTION;
use crate::preset::{Channels, Preset};

/// Values of a frame with a preset, unless the camera or the job overrides them.
#[derive(Debug, Clone, PartialEq)]
pub struct Properties {
    /// Veiling light, linear; derived for a depth of 5 m if the source has none.
    pub veiling_light: Option<[f64; 3]>,
    /// b_b/b, for the airlight of lamps; that of average sea particles if the source has none. A job may override it.
    pub backscatter_fraction: Option<f64>,
    /// G of the forward scatter, 1/m.
    pub g: Channels,
    /// Width of the forward-scatter kernel at range 0, radians.
    pub spread_offset_rad: Option<f64>,
    /// Growth of that width with range, radians per meter.
    pub spread_rad_per_m: Channels,
    /// Derived fields, by the names of the job description.
    pub derived: Vec<&'static str>,
}

/// All values derived from a preset. If it cannot be rendered, only its stored numbers.
#[must_use]
pub fn properties(preset: &Preset) -> Properties {
    let own = Properties {
        veiling_light: preset.veiling_light,
        backscatter_fraction: preset.backscatter_fraction,
        g: [None; 3],
        spread_offset_rad: None,
        spread_rad_per_m: [None; 3],
        derived: preset.derived.clone(),
    };
    if preset.unrenderable().is_some() {
        return own;
    }
    // A focal length of one pixel: a radian is a pixel.
    let Ok(water) = Water::resolve(&preset.optics().into(), 1.0) else {
        return own;
    };
    let mut derived = own.derived;
    derived.extend(water.derived().iter().map(|field| match *field {
        "spread_px_per_m" => "spread_rad_per_m",
        "spread_offset_px" => "spread_offset_rad",
        other => other,
    }));
    if preset.backscatter_fraction.is_none() {
        derived.push("backscatter_fraction");
    }
    let (g, spread) = match *water.scatter() {
        Scatter::Jaffe { g, spread, .. } => (g.map(Some), Some(spread)),
        Scatter::Simplified { spread } => ([None; 3], Some(spread)),
        Scatter::None => ([None; 3], None),
    };
    Properties {
        veiling_light: Some(water.veiling_light()),
        backscatter_fraction: preset.backscatter_fraction.or(Some(AVERAGE_BACKSCATTER_FRACTION)),
        g,
        spread_offset_rad: spread.map(|spread| spread.offset_px[0]),
        spread_rad_per_m: spread.map_or([None; 3], |spread| spread.per_m.map(Some)),
        derived,
    }
}
