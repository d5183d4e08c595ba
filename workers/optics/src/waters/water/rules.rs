//! The rules of waters for checks of a description.

use spec::{Fault, Optics, WaterConditions, WaterRules};

use super::WaterError;
use super::derive::{self, Request};
use super::model::Water;
use crate::medium::{Medium, Surroundings};
use crate::preset::diffuse_in_disguise;
use crate::snow;

/// Consistency rules for the water of a description.
pub const RULES: WaterRules = WaterRules { faults, warning };

/// The checks do not depend on the camera.
const ANY_FOCAL_PX: f64 = 500.0;

fn faults(water: &spec::Water, conditions: WaterConditions) -> Vec<Fault> {
    let mut faults = Vec::new();
    let surroundings = Surroundings {
        daylight: conditions.daylight,
        has_lamps: conditions.lamps,
        is_reflectance: true,
        frames_per_s: None,
    };
    let medium = Medium::choose(water, &surroundings);
    if let Some(medium) = &medium {
        faults.extend(Water::validate(medium, conditions.lamps).iter().map(fault));
        if conditions.traced && faults.is_empty() {
            faults.extend(untraceable(medium));
        }
    }
    if let Some(snow) = &water.snow {
        let mut errors = snow::validate(snow);
        if let (true, Some(solid)) = (errors.is_empty(), conditions.solid) {
            errors.extend(snow::check_count(snow, solid).err());
        }
        faults.extend(errors.iter().map(|error| Fault {
            path: vec!["snow", error.field],
            message: error.to_string(),
            missing: false,
        }));
    }
    faults
}

/// Requirements of the truth for an otherwise valid water.
fn untraceable(medium: &Medium) -> Option<Fault> {
    let request = Request { medium, lamps: false };
    let inputs = derive::check(&request, ANY_FOCAL_PX).ok()?;
    inputs.scattering.is_none().then(|| Fault {
        path: vec!["optics"],
        message: "the artifacts `truth` and `truth_report` need `absorption_per_m` and `scattering_per_m` in `water.optics`: \
                  without them there is nothing to trace"
            .to_owned(),
        missing: true,
    })
}

/// The error with the path of its field below `water`.
fn fault(error: &WaterError) -> Fault {
    let path = match error.field() {
        field @ ("range_scale" | "depth_m" | "holes") => vec![field],
        field @ ("model" | "g_per_m" | "spread_px_per_m" | "spread_offset_px" | "source") => {
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
}

/// Warning for a beam attenuation that is a K_d, which attenuates daylight and not a camera ray: it equals the given K_d, or that
/// of a known water.
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
