//! From a frame to what the optics ask for.

use optics::water::{ScatterModel, ScatterRequest, WaterRequest};

use crate::frame::{Ambient, ForwardScatter, ForwardScatterModel, Frame, HoleRule, ScatterSource, Water};

/// The water of a frame as the optics ask for it; `None` without optics: no attenuation and no scatter.
#[must_use]
pub fn water_request(frame: &Frame) -> Option<WaterRequest> {
    request(&frame.water, !frame.lamps.is_empty())
}

pub(crate) fn request(water: &Water, lamps: bool) -> Option<WaterRequest> {
    let optics = water.optics.as_ref()?;
    Some(WaterRequest {
        preset: optics.preset.clone(),
        beam_attenuation: optics.beam_attenuation_per_m,
        absorption: optics.absorption_per_m,
        scattering: optics.scattering_per_m,
        backscatter_attenuation: optics.backscatter_attenuation_per_m,
        diffuse_attenuation: optics.diffuse_attenuation_per_m,
        veiling_light: optics.veiling_light,
        veil_gain: optics.veil_gain,
        depth_m: water.depth_m,
        ambient: match water.ambient {
            Ambient::None => optics::water::Ambient::None,
            Ambient::Absolute => optics::water::Ambient::Absolute,
            Ambient::Exposed => optics::water::Ambient::Exposed,
        },
        holes: match water.holes {
            HoleRule::Background => optics::range::HoleRule::Background,
            HoleRule::RangeM(range_m) => optics::range::HoleRule::Range(range_m),
            HoleRule::Reject => optics::range::HoleRule::Reject,
        },
        range_scale: water.range_scale,
        backscatter_fraction: optics.backscatter_fraction,
        lamps,
        scatter: optics.forward_scatter.as_ref().map(scatter),
    })
}

fn scatter(scatter: &ForwardScatter) -> ScatterRequest {
    ScatterRequest {
        model: match scatter.model {
            ForwardScatterModel::Jaffe => ScatterModel::Jaffe,
            ForwardScatterModel::Simplified => ScatterModel::Simplified,
            ForwardScatterModel::None => ScatterModel::None,
        },
        g: scatter.g_per_m,
        spread_px_per_m: scatter.spread_px_per_m,
        spread_offset_px: scatter.spread_offset_px,
        source: match scatter.source {
            ScatterSource::Radiance => optics::water::ScatterSource::Radiance,
            ScatterSource::Direct => optics::water::ScatterSource::Direct,
        },
    }
}
