//! Rounding of f32 in the airlight of a lamp.

use std::f32::consts::FRAC_PI_4;

use super::super::nodes::Span;
use super::super::{GlowPhase, Lamp, Lighting};
use crate::turbidity;

/// One rounding of f32.
const STEP: f64 = 6e-8;
/// Roundings of the vector from the ray to the lamp, as a share of its distance from the camera.
const WAY: f64 = 2.0;
/// Roundings of an angle, of the sine and cosine of one, and of the exponential and all factors of the light.
const ANGLE: f64 = 6.0;
const FACTORS: f64 = 12.0;
/// Parts of the whole path of a ray: scattered lamp light comes from all of it.
const PARTS: usize = 16;

/// What f32 may lose of the light of one lamp.
///
/// With D and P the distances of the lamp from ray and camera, r₀ that from the lit stretch of the ray and r₁ from its end,
/// `S = b I₀ e^{−c m P}/D`, and L the light of the lamp, `L = S ∫ p e^{−c m (…)} dθ` loses at most
///
/// ```text
/// S [ p(from) (6 ε + δ/P) + p(to) (7 ε + δ/r₁) + σ (4 ε + δ/r₀) ∫ p dθ ] + L [ 12 ε + 4 ε c m P + 3/2 δ/D + μ ]
/// δ = (2 ε + ℓ) P
/// ```
///
/// ε is one rounding. δ is the error of the vector from the ray to the lamp: of its position and of the direction of the ray, to
/// which the principal point adds ℓ = (|Δcx| + |Δcy|)/f, its error as f32. It moves the ends of the interval and changes D; if all
/// of the ray is farther behind the lamp than its distance from it, light changes by 7/2 δ/r₀ at most. Errors of the angle at a
/// node move the phase function: summed over the nodes, by its values at the two ends. The profile of a spot rises by σ = 1/(1 −
/// cos cone) times the change of its cosine. μ is the error of the means of patches.
pub(super) struct Rounding {
    strength: f64,
    attenuation: [f64; 2],
    phase: GlowPhase,
    distance_m: f64,
    way_m: f64,
    slope: f64,
    /// Number of parts of the integral of the phase function, each bounded by the value at its greater end.
    parts: usize,
    scale_m: Option<f64>,
}

impl Rounding {
    /// Of a lamp whose light fades by `least` per meter and is of the given strength in each channel.
    pub(super) fn new(lamp: &Lamp, lighting: &Lighting, (least, strength): ([f64; 3], [f64; 3])) -> Self {
        let camera = &lighting.camera;
        let lost = |place: f64| (place - f64::from(place as f32)).abs();
        let lens = (lost(camera.cx) + lost(camera.cy)) / camera.focal_px;
        let distance_m = lamp.distance_m();
        Self {
            strength: strength.into_iter().fold(0.0, f64::max),
            attenuation: [
                least.into_iter().fold(f64::INFINITY, f64::min),
                lighting.attenuation.into_iter().fold(0.0, f64::max),
            ],
            phase: lighting.phase,
            distance_m,
            way_m: (STEP * WAY + lens) * distance_m,
            slope: lamp.beam.slope(),
            parts: if lighting.absorption.is_some() { PARTS } else { 1 },
            scale_m: lighting.patches.as_ref().map(turbidity::Field::scale_m),
        }
    }

    /// The bound for a run of pixels with at most `brightest` from the lamp.
    pub(super) fn within(&self, span: Span, brightest: f32) -> f64 {
        let near = f64::from(span.nearest_m);
        let (clearest, murkiest) = (f64::from(span.clearest), f64::from(span.murkiest));
        let [least, most] = self.attenuation;
        let arriving = (-least * clearest * self.distance_m).exp();
        let unit = self.strength * f64::from(span.source) * arriving / near;
        // At β the scattering angle has the cosine cos 2β; the phase function is monotonic.
        let phase = |angle: f32| self.phase.most((2.0 * f64::from(angle)).cos());
        let from = phase(span.from);
        let to = phase(span.least_to).max(phase(span.to));
        let end = self.way_m / f64::from(span.end_m);
        let ends = from * (ANGLE * STEP + self.way_m / self.distance_m.max(near))
            + to * ((ANGLE + 1.0) * STEP + end);
        // At β a ray is D/sin 2β away from the lamp.
        let away = |angle: f32| near / (2.0 * f64::from(angle)).sin().max(1e-6);
        let (is_behind, is_before) = (span.from > FRAC_PI_4, span.to < FRAC_PI_4);
        let lit = match (is_behind, is_before) {
            (true, _) => away(span.from),
            (_, true) => away(span.to),
            _ => near,
        };
        let profile = self.slope * (4.0 * STEP + self.way_m / lit);
        let turned = if self.parts == 1 {
            2.0 * f64::from(span.to - span.from) * from.max(to)
        } else {
            self.integral(span)
        };
        let meters = most * murkiest * self.distance_m;
        // Of the means up to the lamp, and of one over a stretch of that.
        let murk = self.scale_m.map_or(0.0, |scale| {
            turbidity::path_rounding(2.0 * self.distance_m, scale) / clearest
                * (meters + 2.0 * f64::from(span.stretch))
        });
        let moved = if is_behind {
            f64::min(1.5 / near, 3.5 / lit)
        } else {
            1.5 / near
        };
        let shares = STEP * (FACTORS + 4.0 * meters) + moved * self.way_m + murk;
        unit * (ends + profile * turned) + f64::from(brightest) * shares
    }

    /// Upper bound of the integral of the phase function over all angles of a run.
    fn integral(&self, span: Span) -> f64 {
        let (from, length) = (f64::from(span.from), f64::from(span.to - span.from));
        let part = length / self.parts as f64;
        let phase = |end: usize| self.phase.most((2.0 * (from + end as f64 * part)).cos());
        let parts = (0..self.parts).map(|at| 2.0 * part * phase(at).max(phase(at + 1)));
        parts.sum()
    }
}
