//! Inputs of daylight, and their derivation.

use spec::{HoleRule, PhaseFunction};

use super::super::two_kernels;
use super::WaterError;
use super::checks::{Checks, G_SHARE_OF_SCATTERING, Request};
use crate::daylight::{
    Blur, Daylight, DaylightModel, Fields, Gaze, Place, SunLight, SurfaceLight, WideScattering,
};
use crate::lamp::AVERAGE_BACKSCATTER_FRACTION;
use crate::medium::Ambient;
use crate::water::model::Spread;

/// Known numbers of the water.
pub(super) struct Known {
    pub(super) absorption: Option<[f64; 3]>,
    pub(super) scattering: Option<[f64; 3]>,
    pub(super) backscatter_fraction: Option<f64>,
    /// Whether an absent number is really missing, not just part of an unknown preset.
    pub(super) is_complete: bool,
    pub(super) focal_px: f64,
}

/// The sun, where it shines on anything.
fn sun(above: &DaylightModel) -> Option<SunLight> {
    (above.sun_share > 0.0).then(|| SunLight::new(above.sun_share, &above.sun))
}

/// The inputs of daylight.
#[derive(Clone, Copy)]
pub(super) struct Inputs {
    model: DaylightModel,
    place: Place,
    wide: WideScattering,
    /// Given K_d, which replaces the derived one.
    diffuse_attenuation: Option<[f64; 3]>,
    focal_px: f64,
}

impl Inputs {
    /// Solves for the fields of light.
    pub(super) fn solve(self) -> Daylight {
        let Self { model, place, .. } = self;
        let mut fields = Fields::find(&place, self.wide);
        if let Some(given) = self.diffuse_attenuation {
            for (i, field) in fields.channels.iter_mut().enumerate() {
                field.decay = given[i] * place.scale;
                fields.irradiance[i] = (-given[i] * place.depth_m).exp();
            }
        }
        let waves = model.caustics;
        Daylight {
            surfaces: model.surfaces,
            sun: place.sun,
            rays: model.ambient_rays,
            caustics: waves.map(|waves| (waves, blur(place.absorption, place.scattering))),
            draws_caustics: waves.is_some(),
            occludes_veil: model.occludes_veil,
            has_shafts: model.shafts,
            scale: place.scale,
            fields: fields.channels,
            wide: fields.wide,
            depth: place.depth_m / place.scale,
            below: place
                .bottom
                .map_or(f64::INFINITY, |bottom| bottom.below_m / place.scale),
            level: level(fields.irradiance),
            gaze: Gaze::unknown(self.focal_px),
        }
    }
}

impl Checks {
    /// The inputs of daylight, if it is described and all of them are known.
    pub(super) fn daylight(&mut self, request: &Request<'_>, known: &Known) -> Option<Inputs> {
        let above = request.medium.daylight.as_ref()?;
        self.contradictions_above(request, above);
        if request.medium.depth_m.is_none() {
            self.missing("depth_m", "light from above decays with it");
        }
        let parts = known.absorption.zip(known.scattering);
        if parts.is_none() && known.is_complete {
            let reason = "the directions of daylight follow from it and scattering_per_m; give both, or set `daylight` to \
                          \"none\"";
            self.missing("absorption_per_m", reason);
        }
        let (depth_m, (absorption, scattering)) = request.medium.depth_m.zip(parts)?;
        self.derived.push("horizon");
        let optics = &request.medium.optics;
        if optics.diffuse_attenuation_per_m.is_none() {
            self.derived.push("diffuse_attenuation_per_m");
        }
        Some(Inputs {
            model: *above,
            place: Place {
                absorption,
                scattering,
                depth_m,
                sun: sun(above),
                scale: request.medium.range_scale,
                bottom: request.medium.bottom,
            },
            wide: WideScattering::new(
                request.medium.airlight_phase,
                known.backscatter_fraction.unwrap_or(AVERAGE_BACKSCATTER_FRACTION),
            ),
            diffuse_attenuation: optics.diffuse_attenuation_per_m,
            focal_px: known.focal_px,
        })
    }

    fn contradictions_above(&mut self, request: &Request<'_>, above: &DaylightModel) {
        let optics = &request.medium.optics;
        let sets_veil = "is given, but daylight sets the veil";
        let contradictions = [
            (optics.veiling_light.is_some(), "veiling_light", sets_veil),
            (optics.veil_gain.is_some(), "veil_gain", sets_veil),
            (
                optics.backscatter_attenuation_per_m.is_some(),
                "backscatter_attenuation_per_m",
                sets_veil,
            ),
            (
                request.medium.holes != HoleRule::Background,
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
}

/// The light at the camera, where daylight lights surfaces by their depth.
pub(super) fn gain(request: &Request<'_>, daylight: Option<&Daylight>) -> Option<[f64; 3]> {
    let above = request.medium.daylight.as_ref()?;
    let lights = above.surfaces != SurfaceLight::None;
    daylight.filter(|_| lights).map(Daylight::level)
}

/// How the water blurs caustics, by the two kernels of forward scatter in the channel with the median c.
fn blur(absorption: [f64; 3], scattering: [f64; 3]) -> Blur {
    let mut channels = [0, 1, 2].map(|i| [absorption[i], scattering[i]]);
    channels.sort_by(|[a, b], [other_a, other_b]| (a + b).total_cmp(&(other_a + other_b)));
    let [a, b] = channels[1];
    let (narrow, tail) = two_kernels::kernels(PhaseFunction::Ff, [b; 3], 1.0);
    let angle = |spread: &Spread| [spread.offset_px[0], spread.per_m[0]];
    Blur {
        attenuation: a + b,
        spread_attenuation: a + G_SHARE_OF_SCATTERING * b,
        angles: [angle(&narrow), angle(&tail.spread)],
        wide: [tail.share, tail.share_per_m[0]],
    }
}

/// The irradiance at the camera over that which is white: the brightest channel's.
fn level(irradiance: [f64; 3]) -> [f64; 3] {
    let brightest = irradiance.into_iter().fold(f64::MIN_POSITIVE, f64::max);
    irradiance.map(|e| e / brightest)
}
