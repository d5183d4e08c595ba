//! How bright the glow of lamps may be in a frame, and what may be wrong with it: from where the lamps stand beside its rays.

use super::legendre::gauss_legendre;
use super::nodes::{Source, Span, least_error};
use super::{Beam, Lamp, Lighting, henyey_greenstein};
use crate::turbidity::Field;

/// Rounding of f32 in angles and paths, as a share of the brightest glow: some hundred roundings of 6e-8. In trials half of it.
const ROUNDING: f64 = 1e-5;
/// Rounding of the profile of a spot: of a cosine, times what the profile rises with it.
const PROFILE_ROUNDING: f64 = 1e-6;
/// Nodes of the integral over the phase function.
const NODES: usize = 64;

/// No glow of a frame of this size is brighter in any channel, whatever the range.
#[must_use]
pub fn brightest_glow(lighting: &Lighting, size: (usize, usize)) -> f64 {
    lighting
        .lamps
        .iter()
        .map(|lamp| brightest(lamp, lighting, size))
        .sum()
}

/// What f32 may lose of the glow.
#[must_use]
pub fn glow_rounding(lighting: &Lighting, size: (usize, usize)) -> f64 {
    let lost = |lamp: &Lamp| {
        let profile = match lamp.beam {
            Beam::Point => 0.0,
            Beam::Spot { cos_cone, .. } => PROFILE_ROUNDING / (1.0 - cos_cone),
        };
        (ROUNDING + profile) * brightest(lamp, lighting, size)
    };
    lighting.lamps.iter().map(lost).sum()
}

/// What the most nodes may leave of all lamps beyond `tolerance`, which they share.
#[must_use]
pub fn glow_left(lighting: &Lighting, size: (usize, usize), tolerance: f64) -> f64 {
    let share = tolerance / lighting.lamps.len().max(1) as f64;
    let (clearest, murkiest) = lighting.patches.as_ref().map_or((1.0, 1.0), Field::extremes);
    let left = |lamp: &Lamp| {
        let beside = Beside::new(lamp, lighting, size);
        let span = Span {
            from: (0.5 * beside.from + std::f64::consts::FRAC_PI_4) as f32,
            to: std::f32::consts::FRAC_PI_2,
            nearest_m: beside.distance as f32,
            clearest: clearest as f32,
            murkiest: murkiest as f32,
            source: murkiest as f32,
        };
        let source = Source {
            strength: strength(lamp, lighting),
            attenuation: lighting.attenuation.into_iter().fold(f64::INFINITY, f64::min),
            asymmetry: lighting.asymmetry,
            tolerance: share,
        };
        (least_error(span, source) - share).max(0.0)
    };
    lighting.lamps.iter().map(left).sum()
}

/// The largest b I₀ of the three channels.
pub(super) fn strength(lamp: &Lamp, lighting: &Lighting) -> f64 {
    let strengths = [0, 1, 2].map(|i| lighting.scattering[i] * lamp.intensity[i]);
    strengths.into_iter().fold(0.0, f64::max)
}

/// `(b I₀ e^{−c |P|}/D) ∫ p(−sin θ) dθ` from the ray that looks nearest to the lamp: with the angle ψ between ray and lamp the light has the
/// farther to go, and the more to turn, the larger ψ is.
fn brightest(lamp: &Lamp, lighting: &Lighting, size: (usize, usize)) -> f64 {
    let Beside { from, distance } = Beside::new(lamp, lighting, size);
    let half = 0.5 * (std::f64::consts::FRAC_PI_2 - from);
    let phase = |node: f64| henyey_greenstein(lighting.asymmetry, -(from + half * (1.0 + node)).sin());
    let integral: f64 = gauss_legendre(NODES)
        .iter()
        .map(|(node, weight)| weight * phase(*node))
        .sum();
    let (clearest, murkiest) = lighting.patches.as_ref().map_or((1.0, 1.0), Field::extremes);
    // No way from the lamp to the eye is shorter than the straight one.
    let arriving = |i: usize| {
        let fade = (-lighting.attenuation[i] * clearest * length(lamp.position_m)).exp();
        lighting.scattering[i] * lamp.intensity[i] * fade
    };
    let arriving = [0, 1, 2].map(arriving).into_iter().fold(0.0, f64::max);
    murkiest * arriving / distance * half * integral
}

fn length(place: [f64; 3]) -> f64 {
    place.iter().map(|v| v * v).sum::<f64>().sqrt()
}

/// Where a lamp stands beside the ray that looks nearest to it.
struct Beside {
    /// θ of the camera.
    from: f64,
    /// D, m.
    distance: f64,
}

impl Beside {
    fn new(lamp: &Lamp, lighting: &Lighting, size: (usize, usize)) -> Self {
        let length = length(lamp.position_m);
        let angle = least_angle(lamp.position_m, lighting, size);
        let distance = (length * angle.sin()).max(lighting.radius_m);
        Self {
            from: (-length * angle.cos()).atan2(distance),
            distance,
        }
    }
}

/// The least angle between a place and a ray of the frame; 0 of a place in view.
fn least_angle(place: [f64; 3], lighting: &Lighting, (width, height): (usize, usize)) -> f64 {
    let camera = &lighting.camera;
    let length = length(place);
    let (right, bottom) = (width as f64 - 1.0, height as f64 - 1.0);
    if length < lighting.radius_m {
        return 0.0;
    }
    if place[2] > 0.0 {
        let x = camera.cx + camera.focal_px * place[0] / place[2];
        let y = camera.cy + camera.focal_px * place[1] / place[2];
        if (0.0..=right).contains(&x) && (0.0..=bottom).contains(&y) {
            return 0.0;
        }
    }
    let columns = (0..width).flat_map(|x| [(x as f64, 0.0), (x as f64, bottom)]);
    let rows = (0..height).flat_map(|y| [(0.0, y as f64), (right, y as f64)]);
    let cosine = |(x, y): (f64, f64)| {
        let (u, v) = (
            (x - camera.cx) / camera.focal_px,
            (y - camera.cy) / camera.focal_px,
        );
        (u * place[0] + v * place[1] + place[2]) / (length * (u * u + v * v + 1.0).sqrt())
    };
    let nearest = columns.chain(rows).map(cosine).fold(-1.0, f64::max);
    // Between two pixels of the border the angle may be smaller by half a step.
    (nearest.clamp(-1.0, 1.0).acos() - 0.5 / camera.focal_px).max(0.0)
}
