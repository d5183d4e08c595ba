//! Airlight of a lamp with shadows in the water.
//!
//! The lit share of the airlight of each ray is summed at the middles of equal angles, `Σ V f / Σ f` with f the integrand, and
//! multiplies the airlight without shadows. An edge of a shadow can be anywhere in its angle: the error of a share is at most the
//! number of edges times half the greatest part of an angle in the sum. Every second pixel has shadow rays; between them shares are
//! interpolated on one surface if the airlight hardly changes by it.

use std::f32::consts::FRAC_PI_2;

use imaging::{Plane, Rgb, vectorized};

use super::integrand::{SpreadNode, scattered};
use super::intervals::{Intervals, Murk, Rays, intervals};
use super::{Airlight, Glow, Lanes, Order, RUN, airlight, shining};
use crate::elementary::small_sin_cos;
use crate::lamp::beam::Beam;
use crate::lamp::coarse;
use crate::lamp::shadow::{on_unit_disc, shared_place};
use crate::lamp::sight::{Sight, across};
use crate::lamp::{Lamp, Lighting};

/// Angles of a ray.
const ANGLES: usize = 32;
/// Columns and rows from one ray with shadow samples to the next.
const STEP: usize = 2;
/// Part of a lamp's share of the tolerance: a lamp with less airlight casts no shadow, and interpolation may change the light by
/// it.
const UNSEEN: f64 = 0.25;
const READ: f64 = 0.5;

/// [`shaded_airlight_reference`](crate::lamp::shaded_airlight_reference) in f32. `left` and `rounding` do not include the edges of
/// shadows.
#[must_use]
pub fn shaded_airlight(
    range: &Plane<f32>,
    lighting: &Lighting,
    tolerance: f64,
    rays: &dyn imaging::rays::Rays,
) -> Airlight {
    let (casting, open): (Vec<Lamp>, Vec<Lamp>) = lighting.lamps.iter().partition(|lamp| lamp.glow_shadow);
    let share = |count: usize| tolerance * count as f64 / lighting.lamps.len().max(1) as f64;
    let of = |lamps: Vec<Lamp>| Lighting {
        lamps,
        ..lighting.clone()
    };
    let count = open.len();
    let mut all = airlight(range, &of(open), share(count));
    for lamp in casting {
        let lighting = of(vec![lamp]);
        let own = airlight(range, &lighting, (1.0 - UNSEEN) * share(1));
        let seen = shares(range, &lighting, &own.light, share(1), rays);
        for (channel, (sum, own)) in all
            .light
            .planes_mut()
            .into_iter()
            .zip(own.light.planes())
            .enumerate()
        {
            for ((sum, own), seen) in sum.iter_mut().zip(own.data()).zip(&seen) {
                *sum = own.mul_add(seen[channel], *sum);
            }
        }
        all.left += own.left + UNSEEN * share(1);
        all.rounding += own.rounding;
    }
    all
}

/// The lit share of the airlight of the only lamp, of each pixel and channel.
fn shares(
    range: &Plane<f32>,
    lighting: &Lighting,
    glow: &Rgb<f32>,
    tolerance: f64,
    rays: &dyn imaging::rays::Rays,
) -> Vec<[f32; 3]> {
    let lamp = &lighting.lamps[0];
    let lights = Lights::new(lamp, lighting);
    let camera = &lighting.camera;
    let lens = [1.0 / camera.focal_px, camera.cx, camera.cy].map(|v| v as f32);
    let brightest = |at: usize| {
        glow.planes()
            .iter()
            .map(|plane| plane.data()[at])
            .fold(0.0, f32::max)
    };
    let (unseen, read) = ((UNSEEN * tolerance) as f32, (READ * tolerance) as f32);
    let mut sight = Sight::new(rays);
    let width = range.width();
    coarse::fill(
        range,
        STEP,
        |at| brightest(at) > unseen,
        |at, around: &[[f32; 3]; 4]| {
            let change = |c: usize| {
                let of = around.map(|values| values[c]);
                of.into_iter().fold(0.0, f32::max) - of.into_iter().fold(1.0, f32::min)
            };
            (0..3).all(|c| change(c) * brightest(at) <= read)
        },
        |pixels, values| {
            values.clear();
            for pixels in pixels.chunks(RUN) {
                let mut rays = Rays::default();
                let mut meters = [f32::INFINITY; RUN];
                for (i, &at) in pixels.iter().enumerate() {
                    meters[i] = range.data()[at];
                    rays.aim(lens, i, ((at % width) as f32, (at / width) as f32), meters[i]);
                }
                let seen = lights.seen(&rays, pixels.len(), &mut sight);
                values.extend_from_slice(&seen[..pixels.len()]);
            }
        },
    )
}

/// The light of a lamp along rays, and its occluders.
struct Lights<'a> {
    lamp: &'a Lamp,
    /// Unscattered lamp light, and the scattered lamp light of a spot.
    direct: Option<Glow>,
    spread: Option<Glow>,
}

/// The middles of the angles of a run of rays: light of each channel, and how far along the ray.
struct Middles {
    light: [[Lanes; 3]; ANGLES],
    along: [Lanes; ANGLES],
}

impl<'a> Lights<'a> {
    fn new(lamp: &'a Lamp, lighting: &Lighting) -> Self {
        let first = |lamps: Vec<Glow>| lamps.into_iter().next();
        let order = Order::Fixed(2);
        Self {
            lamp,
            direct: first(shining(lighting, |lamp| Some(Glow::new(lamp, lighting, order)))),
            spread: first(shining(lighting, |lamp| Glow::spread(lamp, lighting, order))),
        }
    }

    /// The lit shares of the first `count` rays of a run.
    fn seen(&self, rays: &Rays, count: usize, sight: &mut Sight<'_>) -> [[f32; 3]; RUN] {
        let mut seen = [[1.0f32; 3]; RUN];
        let Some(direct) = &self.direct else { return seen };
        let mut middles = Box::new(Middles {
            light: [[[0.0; RUN]; 3]; ANGLES],
            along: [[0.0; RUN]; ANGLES],
        });
        // Direct light of a spot ends at its cone, but scattered light does not: both use the same shadow samples.
        let whole = self.spread.is_some();
        match (self.lamp.beam, direct.profile.slope > 0.0) {
            (Beam::Spot { .. }, _) if whole => vectorized!(sum_up::<true, true>(direct, rays, &mut middles)),
            (_, true) => vectorized!(sum_up::<true, false>(direct, rays, &mut middles)),
            _ => vectorized!(sum_up::<false, false>(direct, rays, &mut middles)),
        }
        if let Some(spread) = &self.spread {
            sum_up_spread(spread, rays, &mut middles);
        }
        let clear = sight.look_along(|ways| {
            let (radius_m, places) = self.lamp.shadow.disc();
            let middle = self.lamp.position_m.map(|v| v as f32);
            for (node, along) in middles.along.iter().enumerate() {
                let place = on_unit_disc(shared_place(node, places), places).map(|v| v as f32);
                for (i, &along) in along.iter().enumerate().take(count) {
                    let from = [rays.right[i], rays.down[i], rays.ahead[i]].map(|v| v * along);
                    // A point lamp has only one sample.
                    let to = if radius_m == 0.0 {
                        middle
                    } else {
                        across(from, middle, place, radius_m as f32)
                    };
                    ways.push(from, to);
                }
            }
        });
        for (i, seen) in seen.iter_mut().enumerate().take(count) {
            for (channel, seen) in seen.iter_mut().enumerate() {
                let (mut lit, mut all) = (0.0f32, 0.0f32);
                for (node, light) in middles.light.iter().enumerate() {
                    let light = light[channel][i];
                    all += light;
                    lit += if clear[node * count + i] { light } else { 0.0 };
                }
                *seen = if all > 0.0 { lit / all } else { 1.0 };
            }
        }
        seen
    }
}

/// Sine and cosine of β in the middle of an angle.
#[inline(always)]
fn middle_of(to: &Intervals, node: usize, i: usize) -> (f32, f32) {
    let share = (2.0 * node as f32 + 1.0) / ANGLES as f32 - 1.0;
    let (sin_step, cos_step) = small_sin_cos(to.half[i] * share);
    let (sin, cos) = (to.sin[i], to.cos[i]);
    (
        sin.mul_add(cos_step, cos * sin_step),
        cos.mul_add(cos_step, -(sin * sin_step)),
    )
}

#[inline(always)]
fn sum_up<const SPOT: bool, const WHOLE: bool>(lamp: &Glow, rays: &Rays, middles: &mut Middles) {
    let (to, _) = intervals::<SPOT, WHOLE>(lamp, rays, &Murk::default());
    let swells = !SPOT && lamp.source.swelling > 0.0;
    for node in 0..ANGLES {
        let [red, green, blue] = &mut middles.light[node];
        let along = &mut middles.along[node];
        for i in 0..RUN {
            let (sin, cos) = middle_of(&to, node, i);
            let at = [to.nearest[i], to.distance[i], to.across[i], to.along[i]];
            let [r, g, b] = if swells {
                scattered::<SPOT, true, true>(lamp, at, (sin, cos))
            } else {
                scattered::<SPOT, false, true>(lamp, at, (sin, cos))
            };
            (red[i], green[i], blue[i]) = (lamp.gain[0] * r, lamp.gain[1] * g, lamp.gain[2] * b);
            // tan θ with θ = 2 β − π/2; an infinite ray is limited to the range of surfaces.
            let tangent = sin.mul_add(sin, -(cos * cos)) / (2.0 * sin * cos).max(1e-9);
            along[i] = to.distance[i]
                .mul_add(tangent, to.nearest[i])
                .max(0.0)
                .min(super::FARTHEST_M);
        }
    }
}

fn sum_up_spread(lamp: &Glow, rays: &Rays, middles: &mut Middles) {
    let (to, _) = vectorized!(intervals::<true, true>(lamp, rays, &Murk::default()));
    let (mut spread, mut angles) = (SpreadNode::dark(), [0.0f32; RUN]);
    for (node, light) in middles.light.iter_mut().enumerate() {
        let halves = (2.0 * node as f32 + 1.0) / ANGLES as f32;
        for i in 0..RUN {
            angles[i] = halves.mul_add(to.half[i], to.from[i]).min(FRAC_PI_2);
        }
        spread.shine(lamp, &to, &angles);
        for ((light, spread), gain) in light.iter_mut().zip(&spread.light).zip(lamp.gain) {
            for i in 0..RUN {
                light[i] = gain.mul_add(spread[i], light[i]);
            }
        }
    }
}
