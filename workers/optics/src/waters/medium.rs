//! The water of a frame with every model chosen: between a description, which states physics, and [`crate::water::Water`], which is
//! all numbers.

use serde::Deserialize;
use spec::{Daylight, Frame, HoleRule, NamedDaylight, Optics, PhaseFunction, SceneLighting, Sky};

use crate::daylight::{Bottom, DaylightModel};
use crate::preset::{self, all_known};

/// Most layers of a frame in a described water. One gate serves 30 to 80 % of the edges in most frames of sites. A second one would add
/// 30 % to the time, and the same rounding again.
const MOST_LAYERS: usize = 2;
/// Depth of the camera by day if it is not given, m.
const DAY_DEPTH_M: f64 = 5.0;

/// Water with its models.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Medium {
    /// The described optics.
    pub optics: Optics,
    /// Multiplies every per-meter quantity.
    pub range_scale: f64,
    /// Depth of the camera below the surface, m.
    pub depth_m: Option<f64>,
    /// The rule for pixels without a valid range.
    pub holes: HoleRule,
    /// Effect of the decay of daylight with depth on the scene, unless a [`DaylightModel`] lights its surfaces.
    pub ambient: Ambient,
    /// Kernels of forward scatter by the Jaffe–McGlamery form.
    pub kernels: Kernels,
    /// Most layers of occlusion-aware forward scatter; `None`: without occlusion.
    pub layers: Option<usize>,
    /// The phase function of the airlight of lamps.
    pub airlight_phase: PhaseFunction,
    /// Daylight by direction and depth; `None`: `ambient` and the veiling light.
    pub daylight: Option<DaylightModel>,
    /// The bottom of the sea; `None`: too deep to matter.
    pub bottom: Option<Bottom>,
}

impl Default for Medium {
    fn default() -> Self {
        Self {
            optics: Optics::default(),
            range_scale: 1.0,
            depth_m: None,
            holes: HoleRule::default(),
            ambient: Ambient::None,
            kernels: Kernels::One,
            layers: None,
            airlight_phase: PhaseFunction::Hg,
            daylight: None,
            bottom: None,
        }
    }
}

impl From<Optics> for Medium {
    /// The published models in water of these optics.
    fn from(optics: Optics) -> Self {
        Self {
            optics,
            ..Self::default()
        }
    }
}

/// Kernels of one path through the water.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kernels {
    /// One Cauchy kernel, as published.
    One,
    /// A narrow and a wide one, fitted to Monte Carlo runs.
    Two,
}

/// Effect of the decay of daylight with depth on a scene that contains its illumination.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Ambient {
    /// No effect.
    None,
    /// Radiance and a given veiling light are multiplied by exp(−K_d h).
    Absolute,
    /// Radiance is multiplied by exp(−K_d h) over its largest channel, as by a camera that exposes for the depth.
    Exposed,
}

/// The conditions of a frame that its models depend on.
#[derive(Debug, Clone, Copy)]
pub struct Surroundings {
    /// The described daylight.
    pub daylight: Daylight,
    /// Whether point or spot lamps shine.
    pub has_lamps: bool,
    /// Whether the picture is reflectance.
    pub is_reflectance: bool,
    /// Frames per second of a moving camera; `None` of a still.
    pub frames_per_s: Option<f64>,
}

impl Surroundings {
    /// Those of a frame.
    #[must_use]
    pub fn of_frame(frame: &Frame) -> Self {
        Self {
            daylight: frame.daylight,
            has_lamps: frame.has_lamps(),
            is_reflectance: frame.scene.lighting() == SceneLighting::Water,
            frames_per_s: frame.camera.path.map(|_| frame.camera.frames_per_s),
        }
    }

    /// Whether daylight is absent: the description disables it, or lamps are on and neither daylight nor a depth is given.
    #[must_use]
    pub fn is_night(&self, depth_m: Option<f64>) -> bool {
        match self.daylight {
            Daylight::Sky(_) => false,
            Daylight::Named(NamedDaylight::None) => true,
            Daylight::Named(NamedDaylight::Auto) => self.has_lamps && depth_m.is_none(),
        }
    }
}

impl Medium {
    /// The water of a description with the models that its physics calls for; `None` without optics.
    #[must_use]
    pub fn choose(water: &spec::Water, surroundings: &Surroundings) -> Option<Self> {
        let mut optics = water.optics.clone()?;
        let known = Known::of_optics(&optics);
        let sky = known.sky(surroundings, water.depth_m);
        if sky.is_none() && !known.has_veil && surroundings.is_night(water.depth_m) {
            optics.veiling_light = Some([0.0; 3]);
        }
        let depth_m = water.depth_m.or(sky.map(|_| DAY_DEPTH_M));
        let is_reflectance = surroundings.is_reflectance;
        let is_measured = optics.forward_scatter.is_none() && known.coefficients.is_some();
        Some(Self {
            kernels: if is_measured { Kernels::Two } else { Kernels::One },
            layers: is_measured.then_some(MOST_LAYERS),
            airlight_phase: optics.phase,
            ambient: if sky.is_some() && !is_reflectance {
                Ambient::Exposed
            } else {
                Ambient::None
            },
            daylight: sky.map(|sky| DaylightModel::from_sky(&sky, is_reflectance, surroundings.frames_per_s)),
            optics,
            range_scale: water.range_scale,
            depth_m,
            holes: water.holes,
            bottom: None,
        })
    }
}

/// The numbers of optics and their preset.
struct Known {
    has_veil: bool,
    /// a and b, 1/m; `None` if either is unknown.
    coefficients: Option<[[f64; 3]; 2]>,
}

impl Known {
    fn of_optics(optics: &Optics) -> Self {
        let preset = optics.preset.as_deref().and_then(preset::find);
        let decomposition = preset.filter(|_| optics.beam_attenuation_per_m.is_none());
        let absorption = decomposition.and_then(|preset| all_known(preset.absorption));
        let scattering = decomposition.and_then(|preset| all_known(preset.scattering));
        let absorption = optics.absorption_per_m.or(absorption);
        Self {
            has_veil: optics.sets_veil() || preset.is_some_and(|preset| preset.veiling_light.is_some()),
            coefficients: absorption
                .zip(optics.scattering_per_m.or(scattering))
                .map(|(a, b)| [a, b]),
        }
    }

    /// The sky over the water. Default daylight needs a and b, for its veil, and no given veil.
    fn sky(&self, surroundings: &Surroundings, depth_m: Option<f64>) -> Option<Sky> {
        match surroundings.daylight {
            Daylight::Sky(sky) => Some(sky),
            Daylight::Named(_) if surroundings.is_night(depth_m) => None,
            Daylight::Named(_) => (self.coefficients.is_some() && !self.has_veil).then(Sky::default),
        }
    }
}
