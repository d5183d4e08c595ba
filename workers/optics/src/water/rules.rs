//! The rules of waters as a description's check asks for them.

use spec::{
    Ambient, Fault, ForwardScatter, Occlusion, Optics, ScatterModel, ScatterSpread, Sight, SnowDaylight,
    WaterRules,
};

use super::{Water, WaterError};
use crate::preset::{self, diffuse_in_disguise};
use crate::snow;

/// What must fit together within the water of a description.
pub const RULES: WaterRules = WaterRules {
    faults,
    warning,
    lit_warning,
};

/// No camera changes what is looked at here.
const ANY_FOCAL_PX: f64 = 500.0;

fn faults(water: &spec::Water, sight: Sight) -> Vec<Fault> {
    let mut faults = Vec::new();
    if water.optics.is_none() && water.from_above.is_some() {
        faults.push(Fault {
            path: vec!["from_above"],
            message: "`water.from_above` needs `water.optics`: it is the light of a water".to_owned(),
            missing: false,
        });
    }
    if water.optics.is_some() {
        faults.extend(Water::validate(water, sight.lamps).iter().map(fault));
    }
    if sight.traced && faults.is_empty() {
        faults.extend(untraceable(water));
    }
    if let Some(snow) = &water.snow {
        let mut errors = snow::validate(snow);
        if let (true, Some(solid)) = (errors.is_empty(), sight.solid) {
            errors.extend(snow::check_count(snow, solid).err());
        }
        faults.extend(errors.iter().map(|error| Fault {
            path: vec!["snow", error.field],
            message: error.to_string(),
            missing: false,
        }));
        if snow.daylight == Some(SnowDaylight::Depth) && !knows_diffuse(water) {
            faults.push(Fault {
                path: vec!["snow", "daylight"],
                message:
                    "`water.snow.daylight` is `depth`, which needs a water with `diffuse_attenuation_per_m`"
                        .to_owned(),
                missing: false,
            });
        }
    }
    faults
}

/// What the truth has to know of a water that is right by itself.
fn untraceable(water: &spec::Water) -> Option<Fault> {
    water.optics.as_ref()?;
    let resolved = Water::resolve(water, ANY_FOCAL_PX).ok()?;
    resolved.scattering().is_none().then(|| Fault {
        path: vec!["optics"],
        message: "the artifacts `truth` and `truth_report` need `absorption_per_m` and `scattering_per_m` in `water.optics`: \
                  without them there is nothing to trace"
            .to_owned(),
        missing: true,
    })
}

/// Whether the decay of daylight in a water is known.
fn knows_diffuse(water: &spec::Water) -> bool {
    let known = |water: Water| water.diffuse_attenuation().is_some();
    water.optics.is_some() && Water::resolve(water, ANY_FOCAL_PX).is_ok_and(known)
}

/// The error with the place of its field below `water`.
fn fault(error: &WaterError) -> Fault {
    let path = match error.field() {
        field @ ("range_scale" | "depth_m" | "ambient" | "holes" | "multiple") => vec![field],
        field @ ("veil" | "level" | "horizon" | "p" | "q" | "surfaces" | "sun_share" | "ambient_rays") => {
            vec!["from_above", field]
        }
        field @ ("elevation_deg" | "azimuth_deg") => vec!["from_above", "sun", field],
        field @ ("tile_m" | "cells" | "slope" | "wind_deg" | "fps") => vec!["from_above", "caustics", field],
        field @ ("model" | "g_per_m" | "spread_px_per_m" | "spread_offset_px" | "source" | "spread"
        | "occlusion" | "layers") => {
            vec!["optics", "forward_scatter", field]
        }
        field => vec!["optics", field],
    };
    Fault {
        path,
        message: error.to_string(),
        missing: matches!(error, WaterError::Missing { .. }),
    }
}

fn warning(optics: &Optics) -> Option<String> {
    let beam = optics.beam_attenuation_per_m;
    beam.and_then(|beam| diffuse_warning(beam, optics.diffuse_attenuation_per_m))
        .or_else(|| gate_warning(optics.forward_scatter.as_ref()?))
}

/// A veil that daylight colors lights the water where lamps are meant to be all the light.
fn lit_warning(water: &spec::Water) -> Option<String> {
    let optics = water.optics.as_ref()?;
    let preset = optics.preset.as_deref().and_then(preset::find);
    let is_given = optics
        .veiling_light
        .or(preset.and_then(|preset| preset.veiling_light))
        .is_some();
    let is_chosen = optics.veil_gain.is_some();
    let is_day = water.from_above.is_some() || water.ambient != Ambient::None;
    (!is_given && !is_chosen && !is_day).then(|| {
        "lamps light the scene, and the veil of the water is derived from daylight: by night give `veiling_light` [0, 0, 0] in \
         `water.optics`, by day `water.from_above`"
            .to_owned()
    })
}

/// One kernel has too little light in its tail; a gate that stops a part of it leaves too little.
fn gate_warning(scatter: &ForwardScatter) -> Option<String> {
    let is_gated = scatter.occlusion == Some(Occlusion::Gated) && scatter.model == ScatterModel::Jaffe;
    (is_gated && scatter.spread != Some(ScatterSpread::Two)).then(|| {
        "`water.optics.forward_scatter.occlusion` is `gated` with one kernel, which stops too much light: set `spread` to `two`"
            .to_owned()
    })
}

/// What to say of a beam attenuation that is a K_d, which attenuates daylight and no camera ray: the K_d beside it, or
/// that of a known water.
fn diffuse_warning(beam: [f64; 3], diffuse: Option<[f64; 3]>) -> Option<String> {
    let whose = if diffuse == Some(beam) {
        "the `diffuse_attenuation_per_m` beside it".to_owned()
    } else {
        format!("the K_d of {}", diffuse_in_disguise(beam)?)
    };
    Some(format!(
        "`water.optics.beam_attenuation_per_m` is {whose}: K_d is the decay of daylight with depth, and as beam attenuation \
         it makes the water too clear"
    ))
}
