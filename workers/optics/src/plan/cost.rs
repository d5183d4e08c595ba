//! What the stages of a frame are expected to cost: pixels times nanoseconds, as measured once on one core of an AMD EPYC with
//! AVX-512 at 768×492 (the figures of `docs/speed.md`, `docs/lamps.md`, `docs/suspended.md` and `docs/style-bench.md`). Another
//! processor differs by a factor; what a frame costs beside another does not change much.

use spec::Frame;

use super::{Form, Plan, ScatterStep, Shadows, StyleStep};
use crate::setting::Setting;
use crate::snow;

/// Nanoseconds a pixel.
const ATTENUATION_NS: f64 = 1.5;
/// The veil by direction of all channels.
const VEIL_NS: f64 = 10.0;
/// Daylight on surfaces under an even sky and with the sun, a ray to the sun from each pixel, each ray to the sky from where there
/// are any, and caustics with the tiles that they are looked up in.
const OVERCAST_NS: f64 = 7.0;
const SUNNY_NS: f64 = 9.0;
const SUN_RAY_NS: f64 = 30.0;
const AMBIENT_RAY_NS: f64 = 20.0;
const CAUSTICS_NS: f64 = 40.0;
/// A ray through a range image; of those to the sky there is one for each fifth pixel.
const SCREEN_RAY_NS: f64 = 1_000.0;
/// Each channel that is transformed, and each of its kernels.
const CHANNEL_NS: f64 = 7.8;
const KERNEL_NS: f64 = 1.87;
/// Each gate of a channel, with what is filled in behind it.
const GATE_NS: f64 = 10.0;
const PATH_NS: f64 = 5.3;
/// Normals and light of each lamp on surfaces, and its glow; the same in patches of turbidity on top.
const SURFACE_NS: f64 = 6.6;
const GLOW_NS: f64 = 12.6;
const PATCHES_NS: f64 = 6.0;
/// Each way to a lamp through a scene; ways of a pixel in the glow, and the most to a soft lamp; and what those to the
/// disc of light that is scattered more than once add to each, where it is followed.
const WAY_NS: f64 = 17.5;
const GLOW_WAYS: f64 = 10.0;
const SOFT_WAYS: usize = 3;
const DISC_WAYS: f64 = 0.6;
const DISC_GLOW_WAYS: f64 = 7.0;
/// Clouds of sediment without a lamp, and what each lamp costs in them: the rays through them, of which half are empty in the mean.
const SEDIMENT_NS: f64 = 150.0;
const LIT_SEDIMENT_NS: f64 = 5.0;
const SNOW_NS: f64 = 19.6;
const NETWORK_NS: f64 = 10.8;
/// What the range of each pixel adds to that: its fading, and the layers that look at it.
const RANGE_NS: f64 = 4.2;
const TABLE_NS: f64 = 4.2;
/// Each light.
const HAZE_NS: f64 = 5.0;
/// Nanoseconds of a particle in view.
const PARTICLE_NS: f64 = 700.0;
/// The f64 forms cost seconds, which depend on the ranges of a frame; they have no figure.
const UNKNOWN: f64 = f64::NAN;

/// How much of everything a frame has.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Amounts {
    pixels: f64,
    lamps: f64,
    particles: f64,
    lights: f64,
    is_patchy: bool,
    /// Whether light is followed that is scattered more than once.
    is_followed: bool,
}

impl Amounts {
    pub(super) fn of_pixels(pixels: usize) -> Self {
        Self {
            pixels: pixels as f64,
            lamps: 0.0,
            particles: 0.0,
            lights: 0.0,
            is_patchy: false,
            is_followed: false,
        }
    }

    pub(super) fn new(frame: &Frame, setting: &Setting) -> Self {
        let solid = snow::solid(&setting.eye.camera, setting.size);
        Self {
            lamps: setting
                .lighting
                .as_ref()
                .map_or(0.0, |lighting| lighting.lamps.len() as f64),
            particles: setting
                .snow
                .as_ref()
                .map_or(0.0, |law| snow::expected(law, solid)),
            lights: frame.haze().len() as f64,
            is_patchy: setting.patches.is_some(),
            is_followed: (setting.lighting.as_ref()).is_some_and(|lighting| lighting.absorption.is_some()),
            ..Self::of_pixels(setting.size.0 * setting.size.1)
        }
    }
}

impl Plan {
    /// Expected milliseconds of shadows.
    pub(super) fn shadows_cost_ms(&self, stage: &str, shadows: Shadows) -> f64 {
        let (direct, of_discs) = if stage == "glow_shadows" {
            (GLOW_WAYS, DISC_GLOW_WAYS)
        } else {
            (shadows.places.min(SOFT_WAYS) as f64, DISC_WAYS)
        };
        let ways = if self.amounts.is_followed {
            direct + of_discs
        } else {
            direct
        };
        let ns = shadows.lamps as f64 * ways * WAY_NS * self.amounts.pixels;
        (ns / 1e4).round() / 100.0
    }

    /// Expected milliseconds of a veil by direction; none in f64.
    pub(super) fn veil_cost_ms(&self) -> Option<f64> {
        match self.veil.as_ref().map_or(Form::Skip, |veil| veil.form) {
            Form::Skip => Some(0.0),
            Form::Fast => Some((VEIL_NS * self.amounts.pixels / 1e4).round() / 100.0),
            Form::Reference => None,
        }
    }

    /// Expected milliseconds of clouds of sediment; none in f64.
    pub(super) fn sediment_cost_ms(&self) -> Option<f64> {
        let Amounts { pixels, lamps, .. } = self.amounts;
        match self.sediment.as_ref().map_or(Form::Skip, |clouds| clouds.form) {
            Form::Skip => Some(0.0),
            Form::Fast => Some(((SEDIMENT_NS + LIT_SEDIMENT_NS * lamps) * pixels / 1e4).round() / 100.0),
            Form::Reference => None,
        }
    }

    /// Expected milliseconds of one of the stages of light from above on surfaces; none in f64.
    pub(super) fn above_cost_ms(&self, stage: &str) -> Option<f64> {
        let above = self.above.as_ref()?;
        let ns = match (stage, above.form_of(stage)?) {
            (_, Form::Reference) => return None,
            (_, Form::Skip) => 0.0,
            ("surfaces", _) if above.sun_shines => SUNNY_NS,
            ("surfaces", _) => OVERCAST_NS,
            ("sun_shadow", _) if above.by_screen => SCREEN_RAY_NS,
            ("sun_shadow", _) => SUN_RAY_NS,
            ("ambient_access", _) if above.by_screen => SCREEN_RAY_NS / 5.0 * above.rays as f64,
            ("ambient_access", _) => AMBIENT_RAY_NS * above.rays as f64,
            (_, _) => CAUSTICS_NS,
        };
        Some((ns * self.amounts.pixels / 1e4).round() / 100.0)
    }

    /// Expected milliseconds of each stage before the enhancement, in the order of the lines; none of a stage in f64.
    pub(super) fn cost(&self) -> [Option<f64>; 11] {
        let Amounts {
            pixels,
            lamps,
            particles,
            lights,
            is_patchy,
            is_followed: _,
        } = self.amounts;
        let patches = if is_patchy { PATCHES_NS } else { 0.0 };
        let of = |form: Form, ns: f64| match form {
            Form::Skip => 0.0,
            Form::Fast => ns * pixels,
            Form::Reference => UNKNOWN,
        };
        let layering = self.gates.as_ref().and_then(|gates| gates.form.layering());
        let layers = layering.map_or(1.0, |layering| layering.count() as f64);
        let gates = GATE_NS * pixels * (layers - 1.0);
        let [red, green, blue] = self.scatter.each_ref().map(|stage| match &stage.form {
            ScatterStep::Skip | ScatterStep::Pointwise => 0.0,
            step @ (ScatterStep::Interpolated(_) | ScatterStep::Layered(_)) => {
                let terms = step.terms().unwrap_or_default() as f64;
                (CHANNEL_NS * layers + KERNEL_NS * terms) * pixels + gates
            }
            ScatterStep::Reference => UNKNOWN,
        });
        let ns = [
            0.0,
            of(self.turbidity.form, PATH_NS),
            of(self.lamps.form, lamps * (SURFACE_NS + patches)),
            of(self.attenuation.form, ATTENUATION_NS),
            red,
            green,
            blue,
            of(self.glow.form, lamps * (GLOW_NS + patches)),
            of(self.snow.form, SNOW_NS + PARTICLE_NS * particles / pixels),
            match self.style.form {
                StyleStep::Skip => 0.0,
                StyleStep::Network => NETWORK_NS * pixels,
                StyleStep::RangeNetwork => (NETWORK_NS + RANGE_NS) * pixels,
                StyleStep::Table => TABLE_NS * pixels,
            },
            of(self.haze.form, HAZE_NS * lights),
        ];
        // Two digits are more than the model is worth.
        ns.map(|ns| (!ns.is_nan()).then(|| (ns / 1e4).round() / 100.0))
    }
}
