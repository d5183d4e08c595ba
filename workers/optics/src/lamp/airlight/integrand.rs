//! Integrand of the airlight quadratures.

use imaging::vectorized;

use super::intervals::Intervals;
use super::{Glow, Lanes, MOST_SWELL, RUN};
use crate::elementary::{HALVINGS, fade, sin_cos};
use crate::lamp::blurred::{Turned, blurred};
use crate::lamp::multiple::{GLOW_SCALE, SATURATION};

/// The integrand at the angle β of this sine and cosine. If the phase function does not rise toward the back, both values of
/// `RISES` have the same bits.
#[inline(always)]
pub(super) fn scattered<const SPOT: bool, const SPREAD: bool, const RISES: bool>(
    lamp: &Glow,
    [nearest, distance, across, along]: [f32; 4],
    (sin, cos): (f32, f32),
) -> [f32; 3] {
    let ([narrow, growth], [cr, cg, cb]) = (lamp.denominator, lamp.attenuation);
    let cos = cos.max(1e-7);
    let ss = sin * sin;
    let denominator = ss.mul_add(growth, narrow);
    let cubed = denominator * denominator.sqrt();
    // One division serves the phase function and the tangent.
    let inverse = 1.0 / (cubed * cos);
    let mut light = inverse * cos;
    if RISES {
        light += lamp.rise_at(ss);
    }
    if SPOT {
        let to_axis = across.mul_add(2.0 * sin * cos, along * cos.mul_add(-cos, ss));
        light *= lamp
            .profile
            .slope
            .mul_add(to_axis, lamp.profile.offset)
            .max(0.0)
            .min(1.0);
    }
    let path = distance.mul_add(sin * inverse * cubed, nearest);
    if SPREAD {
        return swollen(lamp, path).map(|arriving| light * arriving);
    }
    [
        light * fade(cr, path),
        light * fade(cg, path),
        light * fade(cb, path),
    ]
}

/// e^{−c_g L} over a path in meters of mean water, divided by the most that light swells:
/// `a L − 0.06 x/(1 + x/8) + 0.48 = a L + 3.84/(8 + x)`.
#[inline(always)]
pub(super) fn swollen(lamp: &Glow, path: f32) -> [f32; 3] {
    const LATE: f32 = (MOST_SWELL * SATURATION) as f32 * HALVINGS;
    let ([ar, ag, ab], [br, bg, bb]) = (lamp.absorption, lamp.scattering);
    let scale = SATURATION as f32;
    // The camera is before the nearest point of the ray: rounding may carry a path of 0 below it.
    let path = path.max(0.0);
    let (dr, dg, db) = (
        br.mul_add(path, scale),
        bg.mul_add(path, scale),
        bb.mul_add(path, scale),
    );
    // One division for all three.
    let late = LATE / (dr * dg * db);
    [
        fade(1.0, ar.mul_add(path, late * dg * db)),
        fade(1.0, ag.mul_add(path, late * dr * db)),
        fade(1.0, ab.mul_add(path, late * dr * dg)),
    ]
}

/// Scattered lamp light of a spot, on a run of rays at one node of each. First for an isotropic lamp, then with the blurred
/// profile: a single loop runs out of registers and is several times slower.
pub(super) struct SpreadNode {
    pub(super) light: [Lanes; 3],
    /// Scale of the kernel of each channel.
    scale: [Lanes; 3],
    turned: Turned,
    blurs: [Lanes; 3],
}

impl SpreadNode {
    pub(super) fn dark() -> Self {
        let dark = [0.0; RUN];
        Self {
            light: [dark; 3],
            scale: [dark; 3],
            turned: Turned::new(),
            blurs: [dark; 3],
        }
    }

    /// The integrand at each ray's angle β.
    pub(super) fn shine(&mut self, lamp: &Glow, to: &Intervals, angles: &Lanes) {
        vectorized!(shine_evenly(lamp, to, angles, self));
        blurred(&lamp.profile, &self.turned, &self.scale, &mut self.blurs);
        for (light, blur) in self.light.iter_mut().zip(&self.blurs) {
            for (light, blur) in light.iter_mut().zip(blur) {
                *light *= blur;
            }
        }
    }
}

#[inline(always)]
fn shine_evenly(lamp: &Glow, to: &Intervals, angles: &Lanes, node: &mut SpreadNode) {
    let ([narrow, growth], slope) = (lamp.denominator, lamp.profile.slope);
    for i in 0..RUN {
        let (sin, cos) = sin_cos(angles[i]);
        let cos = cos.max(1e-7);
        let ss = sin * sin;
        let denominator = ss.mul_add(growth, narrow);
        let light = 1.0 / (denominator * denominator.sqrt()) + lamp.rise_at(ss);
        let path = to.distance[i].mul_add(sin / cos, to.nearest[i]).max(0.0);
        // The angle to the axis: θ = 2 β − π/2.
        let (sin_ray, cos_ray) = (cos.mul_add(-cos, ss), 2.0 * sin * cos);
        let (across, along, out) = (to.across[i], to.along[i], to.out[i]);
        let aside = across.mul_add(sin_ray, -(along * cos_ray));
        node.turned.along[i] = slope * across.mul_add(cos_ray, along * sin_ray);
        node.turned.across[i] = slope * aside.mul_add(aside, out * out).sqrt();
        let all = swollen(lamp, path);
        for channel in 0..3 {
            let direct = fade(lamp.attenuation[channel], path) * UNSWOLLEN;
            node.scale[channel][i] = SCALE[1].mul_add(lamp.scattering[channel] * path, SCALE[0]);
            node.light[channel][i] = light * (all[channel] - direct).max(0.0);
        }
    }
}

/// e^−0.48: `gain` holds the most that light swells by.
pub(super) const UNSWOLLEN: f32 = 0.618_783_4;
pub(super) const SCALE: [f32; 2] = [GLOW_SCALE[0] as f32, GLOW_SCALE[1] as f32];
