//! The water of one frame: from the description to the numbers of the chain.

mod derive;
mod error;
mod model;
mod properties;
mod rules;
mod two_kernels;

pub use error::WaterError;
pub use properties::{Properties, properties};
pub use rules::RULES;

use spec::{HoleRule, PhaseFunction};

use crate::daylight::{Daylight, Gaze, SurfaceLight, VeilOf};
use crate::lamp::{GlowPhase, asymmetry_of};
use crate::medium::Medium;
use derive::Request;
pub use model::{Scatter, Spread, Tail, Water};

/// Transmission of the light of a point to the camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Arrival {
    /// T = e^{−cZ}, the unscattered share.
    pub(crate) direct: f64,
    /// w = e^{−GZ} − e^{−cZ}, the spread share.
    pub(crate) spread: f64,
    /// γ of the only or the narrow kernel, and of the wide one, pixels.
    pub(crate) gammas: [f64; 2],
    /// Share of the wide kernel; 0 where there is one kernel.
    pub(crate) wide: f64,
}

impl Water {
    /// Completes a description for a camera of this focal length in pixels: preset, given fields, derived fields.
    ///
    /// # Errors
    /// Every contradiction and every missing number together, each with its field, value and limit.
    pub fn resolve(medium: &Medium, focal_px: f64) -> Result<Self, Vec<WaterError>> {
        Self::complete(medium, false, focal_px)
    }

    /// The same for a water with lamps, which needs scattering.
    ///
    /// # Errors
    /// As [`Water::resolve`].
    pub fn resolve_lit(medium: &Medium, focal_px: f64) -> Result<Self, Vec<WaterError>> {
        Self::complete(medium, true, focal_px)
    }

    /// The same checks for water whose camera is not known yet.
    #[must_use]
    pub fn validate(medium: &Medium, lamps: bool) -> Vec<WaterError> {
        /// Any focal length will do: no limit depends on it.
        const ANY_FOCAL_PX: f64 = 1000.0;
        let request = Request { medium, lamps };
        derive::check(&request, ANY_FOCAL_PX).err().unwrap_or_default()
    }

    fn complete(medium: &Medium, lamps: bool, focal_px: f64) -> Result<Self, Vec<WaterError>> {
        let request = Request { medium, lamps };
        derive::resolve(&request, focal_px)
    }

    /// The full name of the preset, if one was used.
    #[must_use]
    pub fn preset(&self) -> Option<&'static str> {
        self.preset
    }

    /// Attenuation of light from the scene, 1/m.
    #[must_use]
    pub fn direct_attenuation(&self) -> [f64; 3] {
        self.direct_attenuation
    }

    /// Daylight by direction and depth, if it is described.
    #[must_use]
    pub fn daylight(&self) -> Option<&Daylight> {
        self.daylight.as_ref()
    }

    /// The same water for a camera with this view, which daylight depends on.
    #[must_use]
    pub fn seen_by(&self, gaze: Gaze) -> Self {
        Self {
            daylight: self.daylight.map(|daylight| daylight.seen_by(gaze)),
            ..self.clone()
        }
    }

    /// The veil of one channel by direction, in daylight.
    pub(crate) fn varied_veil(&self, channel: usize) -> Option<VeilOf> {
        Some(self.daylight?.veil_of(channel))
    }

    /// Upper bound of the veil in this channel, with or without open water in view.
    pub(crate) fn brightest_veil(&self, channel: usize, is_open: bool) -> f64 {
        match (self.varied_veil(channel), self.daylight) {
            (Some(veil), Some(daylight)) => veil.brightest(daylight.gaze.rises, is_open),
            _ => self.veiling_light[channel],
        }
    }

    /// Veiling light, linear; at the horizon where it depends on the direction.
    #[must_use]
    pub fn veiling_light(&self) -> [f64; 3] {
        self.veiling_light
    }

    /// Scattering b, 1/m, where it is known.
    #[must_use]
    pub fn scattering(&self) -> Option<[f64; 3]> {
        self.scattering
    }

    /// Absorption a, 1/m, for multiple scattering of lamp light; c − b if it is not given, `None` without scattering.
    #[must_use]
    pub fn followed_absorption(&self) -> Option<[f64; 3]> {
        let b = self.scattering?;
        let rest = [0, 1, 2].map(|i| (self.direct_attenuation[i] - b[i]).max(0.0));
        Some(self.absorption.unwrap_or(rest))
    }

    /// The phase function of the airlight of lamps.
    #[must_use]
    pub fn glow_phase(&self) -> GlowPhase {
        match self.glow_phase {
            PhaseFunction::Hg => GlowPhase::henyey_greenstein(asymmetry_of(self.backscatter_fraction)),
            PhaseFunction::Ff => GlowPhase::fournier_forand(self.backscatter_fraction),
        }
    }

    /// b_b/b, the share of the scattered light that goes backwards.
    #[must_use]
    pub fn backscatter_fraction(&self) -> f64 {
        self.backscatter_fraction
    }

    /// K_d in 1/m; `None` if it is unknown.
    #[must_use]
    pub fn diffuse_attenuation(&self) -> Option<[f64; 3]> {
        self.diffuse_attenuation
    }

    /// Factor of the scene's radiance, 1 without ambient light.
    #[must_use]
    pub fn radiance_gain(&self) -> [f64; 3] {
        self.radiance_gain
    }

    /// The same water around a scene of known reflectance: all its light is incident light.
    #[must_use]
    pub fn around_reflectance(&self) -> Self {
        let is_lit = self
            .daylight
            .is_some_and(|daylight| daylight.surfaces != SurfaceLight::None);
        Self {
            radiance_gain: if is_lit { self.radiance_gain } else { [0.0; 3] },
            ..self.clone()
        }
    }

    /// The same water around a scene whose radiance has its gain already.
    #[must_use]
    pub fn with_light_applied(&self) -> Self {
        Self {
            radiance_gain: [1.0; 3],
            ..self.clone()
        }
    }

    /// The same water without occlusion of scattered light by near objects.
    #[must_use]
    pub fn without_layers(&self) -> Self {
        let mut open = self.clone();
        if let Scatter::Jaffe { layers, .. } = &mut open.scatter {
            *layers = None;
        }
        open
    }

    /// Meaning of a pixel without a valid range.
    #[must_use]
    pub fn holes(&self) -> HoleRule {
        self.holes
    }

    /// Forward scatter.
    #[must_use]
    pub fn scatter(&self) -> &Scatter {
        &self.scatter
    }

    /// Transmission of the light of a point at a range in meters, in the Jaffe–McGlamery form.
    pub(crate) fn arrival(&self, channel: usize, range_m: f64, widest_px: f64) -> Option<Arrival> {
        let Scatter::Jaffe { g, spread, tail, .. } = self.scatter else {
            return None;
        };
        let c = self.direct_attenuation[channel];
        let g = g[channel].min(c);
        let narrow = spread.gamma(channel, range_m, widest_px);
        let wide = tail.map(|tail| tail.spread.gamma(channel, range_m, widest_px));
        Some(Arrival {
            direct: (-c * range_m).exp(),
            spread: (-g * range_m).exp() * -(-(c - g) * range_m).exp_m1(),
            gammas: [narrow, wide.unwrap_or(narrow)],
            wide: tail.map_or(0.0, |tail| tail.share_at(channel, range_m)),
        })
    }

    /// The derived fields, absent from preset and request.
    #[must_use]
    pub fn derived(&self) -> &[&'static str] {
        &self.derived
    }

    /// The numbers that the chain runs with, by the names of the job description.
    #[must_use]
    pub fn numbers(&self) -> Vec<(&'static str, Option<[f64; 3]>)> {
        let (g, spread, tail) = match self.scatter {
            Scatter::None => (None, None, None),
            Scatter::Jaffe { g, spread, tail, .. } => (Some(g), Some(spread), tail),
            Scatter::Simplified { spread } => (None, Some(spread), None),
        };
        let horizon = self
            .daylight
            .map(|daylight| daylight.fields.each_ref().map(|field| field.horizon));
        vec![
            ("absorption_per_m", self.absorption),
            ("scattering_per_m", self.scattering),
            ("beam_attenuation_per_m", Some(self.direct_attenuation)),
            (
                "backscatter_attenuation_per_m",
                Some(self.backscatter_attenuation),
            ),
            ("diffuse_attenuation_per_m", self.diffuse_attenuation),
            ("veiling_light", Some(self.veiling_light)),
            ("radiance_gain", Some(self.radiance_gain)),
            ("g_per_m", g),
            ("spread_px_per_m", spread.map(|spread| spread.per_m)),
            ("spread_offset_px", spread.map(|spread| spread.offset_px)),
            ("wide_spread_px_per_m", tail.map(|tail| tail.spread.per_m)),
            ("wide_spread_offset_px", tail.map(|tail| tail.spread.offset_px)),
            ("wide_share", tail.map(|tail| [tail.share; 3])),
            ("wide_share_per_m", tail.map(|tail| tail.share_per_m)),
            ("horizon", horizon),
        ]
    }
}

#[cfg(test)]
mod tests;
