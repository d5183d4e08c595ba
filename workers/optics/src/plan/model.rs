//! Distance of the models from radiative transfer, and the water of its measurement. The bounds of a plan are the distance of its
//! numbers from the model; this is the distance of the model from the truth.

mod lamps;
mod parts;

use super::StageId;
use super::stage::ModelError;
use crate::water::Scatter;
pub use lamps::Conditions;
pub use parts::{LightError, PartErrors};

/// Largest b Z at which light next to and over edges was measured.
const EDGES_UP_TO: f64 = 4.0;
/// K z and b/a between which the radiance of the water was measured, with a little more on both sides.
const SKY_DEPTHS: std::ops::RangeInclusive<f64> = 0.3..=4.0;
const SKY_RATIOS: std::ops::RangeInclusive<f64> = 0.25..=6.0;

impl ModelError {
    fn found(ratio: [f64; 2], about: impl Into<String>) -> Self {
        Self::Measured {
            ratio,
            about: about.into(),
        }
    }

    /// The error of a stage under these conditions.
    #[must_use]
    pub fn measured(stage: StageId, conditions: &Conditions<'_>) -> Self {
        let found = match stage {
            StageId::Attenuation => unscattered(conditions),
            StageId::Veil => veil_by_direction(conditions),
            StageId::ForwardScatter(_) => two_kernels(conditions).or_else(|| one_kernel(conditions)),
            StageId::Lamps => lamps::surfaces(conditions).or_else(|| lamps::followed_surfaces(conditions)),
            StageId::Glow => lamps::glow(conditions).or_else(|| lamps::followed_glow(conditions)),
            StageId::SceneLight
            | StageId::Surfaces
            | StageId::SunShadow
            | StageId::AmbientAccess
            | StageId::Caustics
            | StageId::Turbidity
            | StageId::Sediment
            | StageId::Snow => None,
            _ => return Self::NoModel,
        };
        found.unwrap_or(Self::NotMeasured)
    }
}

impl std::fmt::Display for ModelError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::NoModel => f.write_str("none"),
            Self::Measured { about, .. } => f.write_str(about),
            Self::NotMeasured => f.write_str("not measured"),
        }
    }
}

/// Unscattered light falls as e^{−cZ} in the truth, too; the veil of daylight has no reference.
fn unscattered(conditions: &Conditions<'_>) -> Option<ModelError> {
    let is_constant = conditions.water.daylight().is_none();
    let veil = is_constant && conditions.water.veiling_light() != [0.0; 3];
    let veil = if veil { "; veil: not measured" } else { "" };
    conditions
        .patches
        .is_none()
        .then(|| ModelError::found([1.0; 2], format!("unscattered light: none{veil}")))
}

/// The veil of daylight was compared with Monte Carlo in 33 frames with open water, below a cloudy sky at a depth of 5 m.
fn veil_by_direction(conditions: &Conditions<'_>) -> Option<ModelError> {
    let daylight = conditions.water.daylight()?;
    let (a, b) = conditions.water.absorption.zip(conditions.water.scattering)?;
    let is_like = |i: usize| {
        let depth = daylight.fields()[i].decay * daylight.depth();
        SKY_DEPTHS.contains(&depth) && SKY_RATIOS.contains(&(b[i] / a[i]))
    };
    ((0..3).all(is_like) && conditions.patches.is_none()).then(|| {
        let about = "mean radiance of open water 0.93-1.12 of the truth, measured in six waters".to_owned();
        ModelError::found([0.93, 1.12], about)
    })
}

/// One kernel for each range: too narrow in its tail, and without occlusion.
fn one_kernel(conditions: &Conditions<'_>) -> Option<ModelError> {
    let Scatter::Jaffe {
        source: spec::ScatterSource::Radiance,
        tail: None,
        layers: None,
        ..
    } = conditions.water.scatter()
    else {
        return None;
    };
    edges_were_measured(conditions).then(|| {
        let about =
            "light beside an edge 0.27-1.5 of the truth, light over a nearer object 1.6-5.1 times the truth";
        ModelError::found([0.27, 5.1], about)
    })
}

/// Two kernels for each range, with or without occlusion.
fn two_kernels(conditions: &Conditions<'_>) -> Option<ModelError> {
    let Scatter::Jaffe {
        source: spec::ScatterSource::Radiance,
        tail: Some(_),
        layers,
        ..
    } = conditions.water.scatter()
    else {
        return None;
    };
    // The leak over near objects without gates was measured only with one kernel.
    let over = layers.map_or("", |_| ", light over a nearer object 0.92-1.27 of the truth");
    edges_were_measured(conditions).then(|| {
        let about = format!("light beside an edge 0.80-1.18 of the truth{over}");
        ModelError::found([0.80, 1.27], about)
    })
}

/// Whether the farthest surface is within the measured range of light at edges, in even water.
fn edges_were_measured(conditions: &Conditions<'_>) -> bool {
    let known = conditions.water.scattering().zip(conditions.bounds.range_m);
    known.is_some_and(|(b, (_, farthest))| {
        let thickest = b.into_iter().fold(0.0, f64::max) * farthest;
        thickest <= EDGES_UP_TO && conditions.patches.is_none()
    })
}
