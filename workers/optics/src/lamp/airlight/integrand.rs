//! What the quadratures of the glow sum up.

use imaging::vectorized;

use super::intervals::Intervals;
use super::{Glow, Lanes, MOST_SWELL, RUN};
use crate::elementary::{HALVINGS, fade, sin_cos};
use crate::lamp::blurred::blurred;
use crate::lamp::multiple::{GLOW_SCALE, SATURATION};

/// The integrand at the angle β of this sine and cosine.
#[inline(always)]
pub(super) fn scattered<const SPOT: bool, const SPREAD: bool>(
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
fn swollen(lamp: &Glow, path: f32) -> [f32; 3] {
    const LATE: f32 = (MOST_SWELL * SATURATION) as f32 * HALVINGS;
    let ([ar, ag, ab], [br, bg, bb]) = (lamp.absorption, lamp.scattering);
    let scale = SATURATION as f32;
    // The camera lies before the nearest place of the ray: rounding may carry a path of 0 below it.
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

/// What of the light of a spot was spread on its way: as if it shone in all directions, the scale of the kernel of each channel,
/// and cosine and sine of the angle to its axis.
pub(super) struct Spread {
    pub(super) light: [f32; 3],
    pub(super) scale: [f32; 3],
    pub(super) turned: [f32; 2],
}

/// At the angle β of this sine and cosine.
#[inline(always)]
pub(super) fn spread_evenly(lamp: &Glow, to: &Intervals, i: usize, (sin, cos): (f32, f32)) -> Spread {
    let [narrow, growth] = lamp.denominator;
    let cos = cos.max(1e-7);
    let ss = sin * sin;
    let denominator = ss.mul_add(growth, narrow);
    let light = 1.0 / (denominator * denominator.sqrt());
    let path = to.distance[i].mul_add(sin / cos, to.nearest[i]).max(0.0);
    // The angle to the axis: θ = 2 β − π/2.
    let (sin_ray, cos_ray) = (cos.mul_add(-cos, ss), 2.0 * sin * cos);
    let (across, along, out) = (to.across[i], to.along[i], to.out[i]);
    let cos_axis = across.mul_add(cos_ray, along * sin_ray);
    let aside = across.mul_add(sin_ray, -(along * cos_ray));
    let sin_axis = aside.mul_add(aside, out * out).sqrt();
    let all = swollen(lamp, path);
    let mut spread = Spread {
        light: [0.0; 3],
        scale: [0.0; 3],
        turned: [cos_axis, sin_axis],
    };
    for channel in 0..3 {
        let direct = fade(lamp.attenuation[channel], path) * UNSWOLLEN;
        spread.scale[channel] = SCALE[1].mul_add(lamp.scattering[channel] * path, SCALE[0]);
        spread.light[channel] = light * (all[channel] - direct).max(0.0);
    }
    spread
}

/// What of the light of a spot was spread on its way, on a run of rays at one node of each. First as if the lamp shone in all
/// directions, then with its blurred profile: in one loop that is too much for the registers, and takes several times as long.
pub(super) struct SpreadNode {
    pub(super) light: [Lanes; 3],
    scale: [Lanes; 3],
    cos: Lanes,
    sin: Lanes,
}

impl SpreadNode {
    pub(super) fn dark() -> Self {
        let dark = [0.0; RUN];
        Self {
            light: [dark; 3],
            scale: [dark; 3],
            cos: dark,
            sin: dark,
        }
    }

    /// The integrand at each ray's angle β.
    pub(super) fn shine(&mut self, lamp: &Glow, to: &Intervals, angles: &Lanes) {
        vectorized!(shine_evenly(lamp, to, angles, self));
        let shape = [lamp.profile.slope, lamp.profile.offset];
        for channel in 0..3 {
            vectorized!(shape_light(shape, channel, self));
        }
    }
}

#[inline(always)]
fn shine_evenly(lamp: &Glow, to: &Intervals, angles: &Lanes, node: &mut SpreadNode) {
    for i in 0..RUN {
        let spread = spread_evenly(lamp, to, i, sin_cos(angles[i]));
        for channel in 0..3 {
            node.light[channel][i] = spread.light[channel];
            node.scale[channel][i] = spread.scale[channel];
        }
        [node.cos[i], node.sin[i]] = spread.turned;
    }
}

#[inline(always)]
fn shape_light(shape: [f32; 2], channel: usize, node: &mut SpreadNode) {
    let (light, scale) = (&mut node.light[channel], &node.scale[channel]);
    for i in 0..RUN {
        light[i] *= blurred(shape, [node.cos[i], node.sin[i]], scale[i]);
    }
}

/// The integrand of what of the light of a spot was spread on its way, at the angle β of this sine and cosine.
#[inline(always)]
pub(super) fn spread_at(lamp: &Glow, to: &Intervals, i: usize, at: (f32, f32)) -> [f32; 3] {
    let Spread { light, scale, turned } = spread_evenly(lamp, to, i, at);
    let shape = [lamp.profile.slope, lamp.profile.offset];
    let mut spread = [0.0f32; 3];
    for channel in 0..3 {
        spread[channel] = light[channel] * blurred(shape, turned, scale[channel]);
    }
    spread
}

/// e^−0.48: `gain` holds the most that light swells by.
const UNSWOLLEN: f32 = 0.618_783_4;
const SCALE: [f32; 2] = [GLOW_SCALE[0] as f32, GLOW_SCALE[1] as f32];
