//! Bounds of a veil that are known before any of it is computed.

use super::super::field::{BLURRED_EDGE, LEAST_COSINE, SHARP_EDGE, SunnyRay};
use super::super::wide::PEAK_COSINE;
use super::{SunnyWater, VeilOf};
use crate::daylight::model::CRITICAL_COSINE;
use crate::error_bound::ErrorBound;

/// One rounding of f32.
const STEP: f64 = 6e-8;
/// Steps in the cosine from the vertical when a maximum is searched for.
const SEARCH: usize = 64;
/// The bound of roundings grows by less than this between two of these steps.
const BETWEEN_SAMPLES: f64 = 1.5;
/// Roundings of exponentials, lengths and products, as a share of their result.
const FACTORS: f64 = 24.0;
/// Roundings of the argument of the aureole, in steps of it: of its roots, and of a difference that stretches them.
const ROOT: f64 = 8.0;
/// Light that has lost this many e-folds is 0 in f32.
const OPAQUE: f64 = 87.0;
/// Darker veils may be lost in f32.
const UNDERFLOW: f64 = 1e-30;

impl SunnyWater {
    /// 1 − cos of the angles to the sun of the rays at this cosine from the vertical that are nearest to it and farthest from it. No ray
    /// of the picture is nearer than `nearest`.
    fn versines(&self, rise: f64) -> [f64; 2] {
        let across = ((1.0 - rise * rise) * (1.0 - self.rise * self.rise))
            .max(0.0)
            .sqrt();
        let cosine = rise * self.rise;
        let farthest = 1.0 - cosine + across;
        [(1.0 - cosine - across).max(self.nearest.min(farthest)), farthest]
    }
}

impl VeilOf {
    /// The greatest veil between two cosines, with open water in view or without.
    pub(crate) fn brightest(&self, rises: (f64, f64), is_open: bool) -> f64 {
        if self.field.attenuation <= 0.0 {
            return 0.0;
        }
        let step = (rises.1 - rises.0) / SEARCH as f64;
        let light = self.sample(rises).map(|rise| self.most(rise, is_open).sum());
        // Between two steps the logarithms rise by no more than their slopes allow.
        let slope = self.field.source.magnitude() + 0.5 * self.field.mirrored.magnitude();
        light.fold(0.0, f64::max) * (0.5 * step * slope.min(40.0)).exp()
    }

    /// The greatest veil of a direction around the vertical.
    fn most(&self, rise: f64, is_open: bool) -> VeilParts {
        let length = self.end(rise);
        let sunlit = self.sun.map_or(0.0, |sun| {
            let lights = sun.versines(rise).map(|versine| {
                self.field.sunlit(SunnyRay {
                    rise,
                    length,
                    versine,
                    sun_rise: sun.rise,
                })
            });
            lights[0].max(lights[1])
        });
        let aureole = self.sun.map_or(0.0, |sun| {
            let [versine, _] = sun.versines(rise);
            self.field.most_aureole(SunnyRay {
                rise,
                length,
                versine,
                sun_rise: sun.rise,
            })
        });
        let surface = if is_open {
            self.field.surface(rise, self.depth)
        } else {
            0.0
        };
        VeilParts {
            scattered: self.light * self.field.scattered(rise, length),
            sunlit: self.light * sunlit,
            aureole: self.light * aureole,
            surface: self.light * surface,
        }
    }

    /// Bound of the f32 roundings of the veil between two cosines, mostly as a share of it: no other light makes a sample darker than its
    /// veil. Only the edge of Snell's window is so steep that a rounding of the direction is no small share of the light there.
    pub(crate) fn rounding(&self, rises: (f64, f64), is_open: bool) -> ErrorBound {
        let steps = self.sample(rises).map(|rise| self.rounding_at(rise, is_open));
        let has_edge = is_open && rises.1 > CRITICAL_COSINE - BLURRED_EDGE;
        let window = (self.light * self.field.sky).min(self.brightest(rises, is_open));
        let edge = if has_edge {
            STEP * 1.5 / SHARP_EDGE * window
        } else {
            0.0
        };
        ErrorBound {
            absolute: UNDERFLOW + edge,
            relative: BETWEEN_SAMPLES * steps.fold(0.0, f64::max),
        }
    }

    /// Cosines of samples of the veil, including the one nearest to the sun.
    fn sample(&self, (low, high): (f64, f64)) -> impl Iterator<Item = f64> {
        let nearest = self.sun.map(|sun| sun.rise.clamp(low, high));
        let steps = (0..=SEARCH).map(move |k| low + (high - low) * k as f64 / SEARCH as f64);
        steps.chain(nearest)
    }

    fn rounding_at(&self, rise: f64, is_open: bool) -> f64 {
        let field = &self.field;
        let parts = self.most(rise, is_open);
        let size = rise.abs();
        let lengthening = |rate: f64| {
            let length = self.end(rise);
            if rate > 0.0 {
                length.min(1.0 / rate)
            } else {
                length
            }
        };
        let rate = field.rate(rise);
        let scattered = field.source.roundings(size) + field.rate.roundings(size) * lengthening(rate);
        let sunlit = self.sun.map_or(0.0, |sun| {
            let rate = field.attenuation * (1.0 - rise / sun.rise);
            let rates = 6.0 * field.attenuation * (1.0 + size / sun.rise);
            let [near, far] = sun
                .versines(rise)
                .map(|versine| (1.0 - versine).abs().min(PEAK_COSINE));
            field.sunny.roundings(near.max(far)) + rates * lengthening(rate)
        });
        let aureole = self.sun.map_or(0.0, |sun| {
            let rate = field.attenuation * (1.0 - rise / sun.rise) + field.peak;
            let rates = 6.0 * (field.attenuation * (1.0 + size / sun.rise) + field.peak);
            let logarithm = &field.aureole.logarithm;
            logarithm.roundings(1.0) + ROOT * logarithm.magnitude() + rates * lengthening(rate)
        });
        let lost = (field.attenuation + field.peak) * self.depth / rise.max(LEAST_COSINE);
        let surface = 6.0 * lost.min(OPAQUE) + field.mirrored.roundings(size);
        let even = parts.scattered * scattered + parts.sunlit * sunlit + parts.surface * surface;
        // Rays at one cosine from the vertical are near the sun or far from it.
        let shares = [
            (even, parts.sum() - parts.aureole),
            (even + parts.aureole * aureole, parts.sum()),
        ];
        let most = shares.map(|(roundings, light)| roundings / light.max(UNDERFLOW));
        STEP * (FACTORS + most[0].max(most[1]))
    }
}

/// The veil by its origin.
#[derive(Debug, Clone, Copy)]
struct VeilParts {
    /// Scattered light other than singly scattered sunlight.
    scattered: f64,
    /// Singly scattered sunlight.
    sunlit: f64,
    /// The aureole of the sun.
    aureole: f64,
    /// Light from the surface of the sea.
    surface: f64,
}

impl VeilParts {
    fn sum(self) -> f64 {
        self.scattered + self.sunlit + self.aureole + self.surface
    }
}
