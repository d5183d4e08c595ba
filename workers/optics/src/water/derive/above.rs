//! What light from above needs of a water, and how it follows from the rest.

use spec::{HoleRule, PhaseFunction};

use super::super::{Spread, two_kernels};
use super::{Checks, G_SHARE_OF_SCATTERING, Request, WaterError, each};
use crate::daylight::{
    Blur, Daylight, DaylightModel, Field, Gaze, MOST_DECAY, Shape, SunLight, SurfaceLight, VeilModel,
    decay_from,
};
use crate::lamp::AVERAGE_BACKSCATTER_FRACTION;
use crate::medium::Ambient;

/// What is known of the water.
pub(super) struct Known {
    pub(super) absorption: Option<[f64; 3]>,
    pub(super) scattering: Option<[f64; 3]>,
    pub(super) attenuation: Option<[f64; 3]>,
    pub(super) diffuse_attenuation: Option<[f64; 3]>,
    pub(super) backscatter_fraction: Option<f64>,
    /// Whether what is missing here is missing, and not of a preset that does not exist.
    pub(super) is_complete: bool,
    pub(super) focal_px: f64,
}

/// Whether light from above says how bright the veil is.
pub(super) fn sets_veil(request: &Request<'_>) -> bool {
    request
        .medium
        .daylight
        .is_some_and(|above| above.veil == VeilModel::Physical)
}

/// Whether anything depends on the direction that light comes from.
fn varies(above: &DaylightModel) -> bool {
    above.veil != VeilModel::Constant || above.surfaces == SurfaceLight::Normal
}

/// The sun, where it shines on anything.
fn sun(above: &DaylightModel) -> Option<SunLight> {
    (above.sun_share > 0.0).then(|| SunLight::new(above.sun_share, &above.sun))
}

impl Checks {
    /// K from a and b, where light from above asks for it and it is not known.
    pub(super) fn estimated_decay(
        &mut self,
        request: &Request<'_>,
        known: Option<([f64; 3], [f64; 3])>,
    ) -> Option<[f64; 3]> {
        request.medium.daylight?;
        let (a, b) = known?;
        self.derived.push("diffuse_attenuation_per_m");
        Some(each(|i| decay_from(a[i], b[i])))
    }

    /// Light from above, where it is asked for and everything that it takes is there.
    pub(super) fn daylight(&mut self, request: &Request<'_>, known: &Known) -> Option<Daylight> {
        let above = request.medium.daylight.as_ref()?;
        self.contradictions_above(request, above);
        if request.medium.depth_m.is_none() {
            self.missing("depth_m", "light from above decays with it");
        }
        if known.diffuse_attenuation.is_none() && known.is_complete {
            let reason = "light from above decays by it; give it, or both absorption_per_m and scattering_per_m \
                          to estimate it from";
            self.missing("diffuse_attenuation_per_m", reason);
        }
        if above.caustics.is_some() && known.scattering.is_none() && known.is_complete {
            self.missing("scattering_per_m", "caustics are blurred by it");
        }
        let shapes = self.shapes(above, known);
        let (depth_m, decay) = request.medium.depth_m.zip(known.diffuse_attenuation)?;
        let (shapes, c) = shapes.zip(known.attenuation)?;
        let scale = request.medium.range_scale;
        let decay = each(|i| decay[i].min(MOST_DECAY * c[i]));
        let fields = [0, 1, 2].map(|i| Field {
            shape: shapes[i],
            decay: decay[i] * scale,
            window: window(known, decay, i) * scale,
            scattering: known.scattering.map_or(0.0, |b| b[i]) * scale,
        });
        Some(Daylight {
            veil: above.veil,
            surfaces: above.surfaces,
            sun: sun(above),
            rays: above.ambient_rays,
            caustics: above.caustics.map(|waves| (waves, blur(known, c))),
            draws_caustics: above.caustics.is_some(),
            occludes_veil: above.occludes_veil,
            has_shafts: above.shafts,
            scale,
            fields,
            depth: depth_m / scale,
            level: level(decay.map(|k| (-k * depth_m).exp())),
            gaze: Gaze::unknown(known.focal_px),
        })
    }

    fn contradictions_above(&mut self, request: &Request<'_>, above: &DaylightModel) {
        let is_physical = above.veil == VeilModel::Physical;
        let contradictions = [
            (
                is_physical && request.medium.optics.veiling_light.is_some(),
                "veiling_light",
                "is given, but daylight sets the veil",
            ),
            (
                is_physical && request.medium.optics.veil_gain.is_some(),
                "veil_gain",
                "is given, but daylight sets the veil",
            ),
            (
                above.veil != VeilModel::Constant && request.medium.holes != HoleRule::Background,
                "holes",
                "is not `background`: a veil that depends on the direction shows open water where there is no range",
            ),
            (
                above.surfaces != SurfaceLight::None && request.medium.ambient != Ambient::None,
                "ambient",
                "is not `none`, but daylight lights the surfaces",
            ),
            (
                above.caustics.is_some_and(|waves| !waves.cells.is_power_of_two()),
                "cells",
                "of `caustics` is no power of two: 32, 64, 128, 256 or 512",
            ),
        ];
        let wrong = contradictions.into_iter().filter(|(is_wrong, ..)| *is_wrong);
        self.errors
            .extend(wrong.map(|(_, field, reason)| WaterError::Contradiction { field, reason }));
    }

    /// The shape of the radiance field of each channel. It need not be known where nothing depends on the direction.
    fn shapes(&mut self, above: &DaylightModel, known: &Known) -> Option<[Shape; 3]> {
        let fraction = known.backscatter_fraction.unwrap_or(AVERAGE_BACKSCATTER_FRACTION);
        let Some((a, b)) = known.absorption.zip(known.scattering) else {
            if varies(above) && known.is_complete {
                let reason = "the directions of daylight follow from it and scattering_per_m; give both, or set `daylight` to \
                              \"none\"";
                self.missing("absorption_per_m", reason);
            }
            // Any will do where none is looked at.
            return (!varies(above)).then(|| [Shape::of_water(1.0, 0.0); 3]);
        };
        if varies(above) {
            self.derived.extend(["horizon", "p", "q"]);
        }
        Some([0, 1, 2].map(|i| Shape::of_water(a[i], b[i] * fraction)))
    }
}

/// The light at the camera, where daylight lights surfaces by their depth.
pub(super) fn gain(request: &Request<'_>, daylight: Option<&Daylight>) -> Option<[f64; 3]> {
    let above = request.medium.daylight.as_ref()?;
    let lights = above.surfaces != SurfaceLight::None;
    daylight.filter(|_| lights).map(Daylight::level)
}

/// How the water blurs caustics, by the two kernels of forward scatter in the channel with the median c.
fn blur(known: &Known, attenuation: [f64; 3]) -> Blur {
    let mut channels = [0, 1, 2];
    channels.sort_by(|&i, &j| attenuation[i].total_cmp(&attenuation[j]));
    let median = channels[1];
    let c = attenuation[median];
    let b = known.scattering.map_or(0.0, |b| b[median]);
    let a = known.absorption.map_or(c - b, |a| a[median]);
    let (narrow, tail) = two_kernels::kernels(PhaseFunction::Ff, [b; 3], 1.0);
    let angle = |spread: &Spread| [spread.offset_px[0], spread.per_m[0]];
    Blur {
        attenuation: c,
        spread_attenuation: (a + G_SHARE_OF_SCATTERING * b).min(c),
        angles: [angle(&narrow), angle(&tail.spread)],
        wide: [tail.share, tail.share_per_m[0]],
    }
}

/// a + 0.1 b, or about that where only K is known: K is some sixth more.
fn window(known: &Known, decay: [f64; 3], channel: usize) -> f64 {
    match known.absorption.zip(known.scattering) {
        Some((a, b)) => a[channel] + 0.1 * b[channel],
        None => 0.83 * decay[channel],
    }
}

/// The irradiance at the camera over that which is white: the brightest channel's.
fn level(irradiance: [f64; 3]) -> [f64; 3] {
    let brightest = irradiance.into_iter().fold(f64::MIN_POSITIVE, f64::max);
    irradiance.map(|e| e / brightest)
}
