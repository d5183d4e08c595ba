//! One stage of a plan.

use serde::Serialize;
use serde::ser::{SerializeMap, Serializer};

use super::{ErrorBound, Gain, Shadows};
use crate::forward_scatter::{Kernels, Nodes};
use crate::layering::Layering;

/// The stages in the order of light.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum StageId {
    /// Daylight at the depth of the scene, one factor for each channel.
    SceneLight,
    /// Irradiance of surfaces by daylight.
    Surfaces,
    /// Shadows of the sun.
    SunShadow,
    /// Ambient occlusion of daylight.
    AmbientAccess,
    /// The pattern of the waves on surfaces and in the water.
    Caustics,
    /// Shafts of sunlight in the water.
    Shafts,
    /// Light of lamps on surfaces.
    Lamps,
    /// Shadows of lamps on surfaces.
    LampShadows,
    /// Attenuation, and the rounding of all of the water.
    Attenuation,
    /// Paths through patches of turbidity, whose errors appear behind it.
    Turbidity,
    /// The veil by direction.
    Veil,
    /// Occlusion of the daylight that causes the veil.
    VeilOcclusion,
    /// Occlusion-aware forward scatter: gates that stop spread light.
    Occlusion,
    /// Forward scatter of a channel.
    ForwardScatter(u8),
    /// Airlight of lamps.
    Glow,
    /// Shadows of lamps in their airlight.
    GlowShadows,
    /// Clouds of sediment.
    Sediment,
    /// Marine snow.
    Snow,
    /// Several poses or moments in one exposure.
    Movement,
    /// Lens, port and supersampling.
    Geometry,
    /// Blur out of focus.
    Defocus,
    /// Fall-off towards the corners.
    Vignette,
    /// The factor of the exposure.
    Exposure,
    /// The style network.
    Style,
    /// Haze of artificial lights.
    Haze,
    /// Noise and codes of the sensor.
    Sensor,
    /// Color from the mosaic of the sensor.
    Demosaic,
    /// White balance.
    WhiteBalance,
    /// Compression.
    Jpeg,
    /// Enhancement methods.
    Enhance,
    /// The variant of the method `ibla`.
    Ibla,
    /// Monte Carlo reference.
    Truth,
}

impl StageId {
    /// The name in plans, records and the API.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::SceneLight => "scene_light",
            Self::Surfaces => "surfaces",
            Self::SunShadow => "sun_shadow",
            Self::AmbientAccess => "ambient_access",
            Self::Caustics => "caustics",
            Self::Shafts => "shafts",
            Self::Turbidity => "turbidity",
            Self::Lamps => "lamps",
            Self::LampShadows => "lamp_shadows",
            Self::Attenuation => "attenuation",
            Self::Veil => "veil",
            Self::VeilOcclusion => "veil_occlusion",
            Self::Occlusion => "occlusion",
            Self::ForwardScatter(channel) => {
                ["forward_scatter.r", "forward_scatter.g", "forward_scatter.b"][usize::from(channel % 3)]
            }
            Self::Glow => "glow",
            Self::GlowShadows => "glow_shadows",
            Self::Sediment => "sediment",
            Self::Snow => "snow",
            Self::Movement => "camera.movement",
            Self::Geometry => "camera.geometry",
            Self::Defocus => "camera.defocus",
            Self::Vignette => "camera.vignette",
            Self::Exposure => "camera.exposure",
            Self::Style => "style",
            Self::Haze => "haze",
            Self::Sensor => "camera.sensor",
            Self::Demosaic => "camera.demosaic",
            Self::WhiteBalance => "camera.white_balance",
            Self::Jpeg => "camera.jpeg",
            Self::Enhance => "enhance",
            Self::Ibla => "enhance.ibla",
            Self::Truth => "truth",
        }
    }

    /// Whether the promise of a plan includes its error: up to the exposed light.
    #[must_use]
    pub fn is_promised(self) -> bool {
        self <= Self::Exposure
    }

    /// The only channel that it changes; `None` for all three.
    #[must_use]
    pub fn channel(self) -> Option<usize> {
        match self {
            Self::ForwardScatter(channel) => Some(usize::from(channel)),
            _ => None,
        }
    }
}

/// The variant of a stage that runs.
#[derive(Debug, Clone, PartialEq)]
pub enum Variant {
    /// The stage is left out: its effect is 0 or within its share.
    Skip,
    /// The fast one of this name.
    Fast(&'static str),
    /// In f64.
    Reference,
    /// Light of lamps in f32, and in f64 on the tiles of the view that are true.
    Tiled(Vec<bool>),
    /// Forward scatter with a kernel narrower than a pixel.
    Pointwise,
    /// Forward scatter interpolated between these kernels.
    Interpolated(Nodes),
    /// Forward scatter with two kernels on each path or behind gates: the nodes of each layer, nearest first, of one layer without gates.
    Layered(Vec<Kernels>),
    /// Gates between these layers.
    Gated(Layering),
    /// Shadows of these lamps.
    Shadows(Box<Shadows>),
}

impl Variant {
    /// The name in plans, records and the API.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Skip => "skip",
            Self::Fast(name) => name,
            Self::Reference => "reference",
            Self::Tiled(_) => "f32_f64",
            Self::Pointwise => "pointwise",
            Self::Interpolated(_) | Self::Layered(_) => "chebyshev",
            Self::Gated(_) => "gated",
            Self::Shadows(shadows) => shadows.variant(),
        }
    }

    /// Whether the stage is left out.
    #[must_use]
    pub fn is_skipped(&self) -> bool {
        self.name() == "skip"
    }

    /// Kernels of forward scatter; `None` without a transform.
    #[must_use]
    pub fn kernels(&self) -> Option<usize> {
        match self {
            Self::Interpolated(nodes) => Some(nodes.terms()),
            Self::Layered(layers) => Some(layers.iter().map(Kernels::terms).sum()),
            _ => None,
        }
    }
}

/// A stage of a plan: the variant that runs, its error, its cost, and the distance of its model from the truth.
#[derive(Debug, Clone, PartialEq)]
pub struct Stage {
    /// Which stage.
    pub id: StageId,
    /// The variant that runs.
    pub variant: Variant,
    /// Kernels, lamps, rays or layers.
    pub terms: Option<usize>,
    /// Part of the tolerance assigned to it, at its output.
    pub share: Option<f64>,
    /// Part of the relative tolerance assigned to it, included in the relative bound.
    pub relative_share: f64,
    /// The largest error that it adds at its output; `None` without a bound.
    pub bound: Option<ErrorBound>,
    /// How an error at its input appears at its output.
    pub gain: Gain,
    /// Expected milliseconds; `None` in f64.
    pub cost_ms: Option<f64>,
    /// Distance of its model from radiative transfer.
    pub model_error: ModelError,
    /// Remark for readers of the plan.
    pub note: Option<String>,
}

impl Stage {
    /// A stage without error and cost that passes errors unchanged.
    #[must_use]
    pub fn new(id: StageId, variant: Variant) -> Self {
        let cost_ms = (variant != Variant::Reference).then_some(0.0);
        Self {
            id,
            variant,
            terms: None,
            share: None,
            relative_share: 0.0,
            bound: Some(ErrorBound::EXACT),
            gain: Gain::ONE,
            cost_ms,
            model_error: ModelError::NoModel,
            note: None,
        }
    }

    /// A stage that does not run.
    #[must_use]
    pub fn skipped(id: StageId) -> Self {
        Self::new(id, Variant::Skip)
    }

    /// The same stage at this cost per pixel; a reference or a skipped stage keeps its cost.
    #[must_use]
    pub fn costing(mut self, ns: f64, pixels: usize) -> Self {
        if self.variant != Variant::Reference && !self.variant.is_skipped() {
            // Two digits are more than the cost model is worth.
            self.cost_ms = Some((ns * pixels as f64 / 1e4).round() / 100.0);
        }
        self
    }

    /// Whether the error of the stage, or of its omission, is unbounded.
    #[must_use]
    pub fn is_unbounded(&self) -> bool {
        self.bound.is_none() && self.variant != Variant::Reference
    }
}

impl Serialize for Stage {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        map.serialize_entry("stage", self.id.name())?;
        map.serialize_entry("variant", self.variant.name())?;
        let mut entry = |name: &str, value: Option<f64>| match value {
            Some(value) => map.serialize_entry(name, &value),
            None => Ok(()),
        };
        entry("share", self.share)?;
        entry("bound", self.printed_bound())?;
        entry(
            "relative_share",
            Some(self.relative_share).filter(|share| *share > 0.0),
        )?;
        entry("gain", self.printed_gain())?;
        entry("cost_ms", self.cost_ms)?;
        if let Some(terms) = self.terms {
            map.serialize_entry("terms", &terms)?;
        }
        if let Some(error) = self.printed_model_error() {
            map.serialize_entry("model_error", &error)?;
        }
        if let Some(note) = &self.note {
            map.serialize_entry("note", note)?;
        }
        map.end()
    }
}

impl Stage {
    /// The printed bound, for light up to white, without the relative share; `None` of stages without one.
    fn printed_bound(&self) -> Option<f64> {
        self.bound
            .map(|bound| bound.up_to_white() - self.relative_share)
            .filter(|bound| *bound > 0.0)
    }

    fn printed_gain(&self) -> Option<f64> {
        (self.gain != Gain::ONE).then_some(self.gain.absolute)
    }

    /// The printed model error; `None` of skipped stages and of those without a truth.
    #[must_use]
    pub fn printed_model_error(&self) -> Option<String> {
        let is_known = self.model_error != ModelError::NoModel && !self.variant.is_skipped();
        is_known.then(|| self.model_error.to_string())
    }
}

/// Distance of the model of a stage from radiative transfer.
#[derive(Debug, Clone, Default, PartialEq)]
pub enum ModelError {
    /// The stage has no physical truth: style, haze, enhancement.
    #[default]
    NoModel,
    /// Measured against Monte Carlo: model over truth, least and greatest.
    Measured {
        /// Least and greatest ratio of model to truth.
        ratio: [f64; 2],
        /// The kind of light, and the conditions of the measurement.
        about: String,
    },
    /// Conditions like these were not measured.
    NotMeasured,
}
