//! A lamp near a run of rays, and its light along them.
//!
//! Points on a ray are given by w = 1/(1 + tan β) instead of the angle β: it falls from the camera to 0 at infinity, and costs a
//! root and a division. Sine and cosine of β are (1 − w)/√q and w/√q with q = w² + (1 − w)², and dβ = −dw/q.

use std::f32::consts::FRAC_PI_2;

use imaging::vectorized;

use super::super::integrand::{SCALE, UNSWOLLEN, swollen};
use super::super::intervals::{Beside, Murk, Rays, aim, beside};
use super::super::{Glow, Lanes, RUN};
use crate::elementary::{fade, sin_cos};
use crate::lamp::blurred::{Turned, blurred};

/// w of a point `behind` meters behind the one nearest to a lamp.
#[inline(always)]
pub(super) fn opening(distance: f32, behind: f32) -> f32 {
    let sum = behind.mul_add(behind, distance * distance).sqrt() + behind.abs();
    (if behind < 0.0 { sum } else { distance }) / (distance + sum)
}

/// w at an angle β.
#[inline(always)]
fn at_angle(beta: f32) -> f32 {
    let (sin, cos) = sin_cos(beta.max(0.0).min(FRAC_PI_2));
    cos.max(0.0) / (sin + cos)
}

/// A run of rays: t₀ and D as meters of mean water, w at the camera, D in meters, and the geometry of a spot, as in
/// [`Intervals`](super::super::intervals::Intervals).
pub(super) struct Bundle {
    nearest: Lanes,
    distance: Lanes,
    pub(super) start: Lanes,
    pub(super) meters: Lanes,
    across: Lanes,
    along: Lanes,
    out: Lanes,
    /// Entry into the cone of a spot and exit, as a share of w at the camera.
    enter: Lanes,
    leave: Lanes,
}

impl Bundle {
    pub(super) fn new() -> Self {
        let empty = [0.0; RUN];
        Self {
            nearest: empty,
            distance: empty,
            start: empty,
            meters: empty,
            across: empty,
            along: empty,
            out: empty,
            enter: empty,
            leave: empty,
        }
    }

    /// Turns to other rays.
    #[inline(always)]
    pub(super) fn aim(&mut self, lamp: &Glow, rays: &Rays, murk: &Murk) {
        for i in 0..RUN {
            let place = beside(lamp, rays, i);
            let Beside {
                nearest, distance, ..
            } = place;
            let aim = aim(lamp, [rays.right[i], rays.down[i], rays.ahead[i]], &place);
            let [enter, leave] = [aim.middle - aim.half, aim.middle + aim.half].map(at_angle);
            (self.across[i], self.along[i], self.out[i]) = (aim.across, aim.along, aim.out);
            let start = opening(distance, -nearest);
            (self.enter[i], self.leave[i]) = (enter / start, leave / start);
            self.start[i] = start;
            self.meters[i] = distance;
            (self.nearest[i], self.distance[i]) = (murk.path[i] * nearest, murk.path[i] * distance);
        }
    }
}

/// Light of a lamp on a run of rays at one point of each: of a point lamp all of it, of a spot the scattered lamp light.
pub(super) struct Node {
    pub(super) light: [Lanes; 3],
    /// Scale of the kernel of each channel.
    scale: [Lanes; 3],
    turned: Turned,
    blurs: [Lanes; 3],
}

impl Node {
    pub(super) fn dark() -> Self {
        let dark = [[0.0; RUN]; 3];
        Self {
            light: dark,
            scale: dark,
            turned: Turned::new(),
            blurs: dark,
        }
    }

    /// The integrand where `share` of w at the camera is left.
    pub(super) fn shine(&mut self, lamp: &Glow, rays: &Bundle, share: f32) {
        if lamp.profile.slope == 0.0 {
            vectorized!(self.shine_evenly::<false>(lamp, rays, share));
            return;
        }
        vectorized!(self.shine_evenly::<true>(lamp, rays, share));
        blurred(&lamp.profile, &self.turned, &self.scale, &mut self.blurs);
        for (light, blur) in self.light.iter_mut().zip(&self.blurs) {
            for i in 0..RUN {
                light[i] *= blur[i];
            }
        }
    }

    /// Scattered lamp light of a spot as if it were isotropic.
    #[inline(always)]
    fn shine_evenly<const SPOT: bool>(&mut self, lamp: &Glow, rays: &Bundle, share: f32) {
        let slope = lamp.profile.slope;
        for i in 0..RUN {
            let at = At::new(lamp, rays, i, rays.start[i] * share);
            let all = swollen(lamp, at.path);
            if !SPOT {
                for channel in 0..3 {
                    self.light[channel][i] = at.light * all[channel];
                }
                continue;
            }
            let (across, along, out) = (rays.across[i], rays.along[i], rays.out[i]);
            let aside = across.mul_add(at.sin, -(along * at.cos));
            self.turned.along[i] = slope * across.mul_add(at.cos, along * at.sin);
            self.turned.across[i] = slope * aside.mul_add(aside, out * out).sqrt();
            for channel in 0..3 {
                let direct = fade(lamp.attenuation[channel], at.path) * UNSWOLLEN;
                self.scale[channel][i] = SCALE[1].mul_add(lamp.scattering[channel] * at.path, SCALE[0]);
                self.light[channel][i] = at.light * (all[channel] - direct).max(0.0);
            }
        }
    }
}

/// Unscattered light of a spot, at the two nodes of the lit part of a cell, times the share of this part.
pub(super) struct Direct(pub(super) [[Lanes; 3]; 2]);

impl Direct {
    pub(super) fn dark() -> Self {
        Self([[[0.0; RUN]; 3]; 2])
    }

    /// In the cell between two shares of w at the camera.
    #[inline(always)]
    pub(super) fn shine(&mut self, lamp: &Glow, rays: &Bundle, [begin, end]: [f32; 2], nodes: [f32; 2]) {
        let inverse = 1.0 / (begin - end);
        for (light, place) in self.0.iter_mut().zip(nodes) {
            for i in 0..RUN {
                let (from, to) = (rays.enter[i].min(begin), rays.leave[i].max(end));
                let length = (from - to).max(0.0);
                let at = At::new(lamp, rays, i, rays.start[i] * (from - length * place));
                let cos = rays.across[i].mul_add(at.cos, rays.along[i] * at.sin);
                let profile = lamp.profile.slope.mul_add(cos, lamp.profile.offset);
                let lit = at.light * (length * inverse) * UNSWOLLEN * profile.max(0.0).min(1.0);
                for channel in 0..3 {
                    light[channel][i] = lit * fade(lamp.attenuation[channel], at.path);
                }
            }
        }
    }
}

/// A point on a ray: the phase function there by dw, the path of its light in meters of mean water, sine and cosine of θ = 2 β −
/// π/2.
struct At {
    light: f32,
    path: f32,
    sin: f32,
    cos: f32,
}

impl At {
    #[inline(always)]
    fn new(lamp: &Glow, rays: &Bundle, i: usize, w: f32) -> Self {
        let [narrow, growth] = lamp.denominator;
        let v = 1.0 - w;
        let inverse = 1.0 / v.mul_add(v, w * w);
        let ss = v * v * inverse;
        let denominator = ss.mul_add(growth, narrow);
        Self {
            light: inverse.mul_add(lamp.rise_at(ss), inverse / (denominator * denominator.sqrt())),
            path: rays.distance[i]
                .mul_add(v / w.max(1e-7), rays.nearest[i])
                .max(0.0),
            sin: (v - w) * inverse,
            cos: 2.0 * v * w * inverse,
        }
    }
}
