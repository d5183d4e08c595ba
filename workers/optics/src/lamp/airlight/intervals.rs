//! The rays of a run of pixels, their angles to a lamp, and the turbidity there.

use imaging::simd::{larger, smaller};

use super::super::nodes::Span;
use super::super::patches::BESIDE;
use super::{FARTHEST_M, Glow, Lanes, RUN};
use crate::attenuation::masked;
use crate::elementary::{angle, full_angle, sin_cos};
use crate::turbidity;

/// The rays of a run as unit vectors, and their lengths; infinite for a hole.
pub(super) struct Rays {
    pub(super) right: Lanes,
    pub(super) down: Lanes,
    pub(super) ahead: Lanes,
    pub(super) end: Lanes,
}

impl Default for Rays {
    fn default() -> Self {
        let [right, down, ahead, end] = [[0.0; RUN]; 4];
        Self {
            right,
            down,
            ahead,
            end,
        }
    }
}

impl Rays {
    /// Sets ray `i` to that of a pixel.
    pub(super) fn aim(
        &mut self,
        [inverse_focal, cx, cy]: [f32; 3],
        i: usize,
        (x, y): (f32, f32),
        range: f32,
    ) {
        let (u, v) = ((x - cx) * inverse_focal, (y - cy) * inverse_focal);
        let inverse = 1.0 / u.mul_add(u, v.mul_add(v, 1.0)).sqrt();
        let (valid, z) = masked(range);
        (self.right[i], self.down[i], self.ahead[i]) = (u * inverse, v * inverse, inverse);
        self.end[i] = if valid { z.min(FARTHEST_M) } else { f32::INFINITY };
    }
}

#[inline(always)]
pub(super) fn rays_of(
    [inverse_focal, cx, cy]: [f32; 3],
    (x, y): (usize, usize),
    range: &Lanes,
    to: &mut Rays,
) {
    let v = (y as f32 - cy) * inverse_focal;
    for i in 0..RUN {
        let u = ((x + i) as f32 - cx) * inverse_focal;
        let inverse = 1.0 / u.mul_add(u, v.mul_add(v, 1.0)).sqrt();
        let (valid, z) = masked(range[i]);
        let z = z.min(FARTHEST_M);
        (to.right[i], to.down[i], to.ahead[i]) = (u * inverse, v * inverse, inverse);
        to.end[i] = if valid { z } else { f32::INFINITY };
    }
}

/// Position of a lamp P relative to a ray d.
pub(super) struct Beside {
    /// P × d, whose length is the distance from the ray.
    pub(super) moment: [f32; 3],
    /// t₀ = P·d.
    pub(super) nearest: f32,
    /// D, at least the lamp's radius.
    pub(super) distance: f32,
}

#[inline(always)]
pub(super) fn beside(lamp: &Glow, rays: &Rays, i: usize) -> Beside {
    let [px, py, pz] = lamp.place;
    let (dx, dy, dz) = (rays.right[i], rays.down[i], rays.ahead[i]);
    let [mx, my, mz] = [py * dz - pz * dy, pz * dx - px * dz, px * dy - py * dx];
    Beside {
        moment: [mx, my, mz],
        nearest: px.mul_add(dx, py.mul_add(dy, pz * dz)),
        distance: mx.mul_add(mx, my.mul_add(my, mz * mz)).sqrt().max(lamp.radius),
    }
}

/// Direction of a spot relative to a ray: its axis in the plane of ray and lamp, and the position of its cone in that plane.
pub(super) struct Aim {
    /// cos of the angle to the axis: `across · cos θ + along · sin θ`.
    pub(super) across: f32,
    pub(super) along: f32,
    /// Length of the part of the axis that is at right angles to the plane.
    pub(super) out: f32,
    /// Middle and half width of the cone in β.
    pub(super) middle: f32,
    pub(super) half: f32,
}

#[inline(always)]
pub(super) fn aim(lamp: &Glow, [dx, dy, dz]: [f32; 3], place: &Beside) -> Aim {
    let ([ax, ay, az], cone) = (lamp.profile.axis, lamp.profile.cos_cone);
    let ([mx, my, mz], distance) = (place.moment, place.distance);
    // (a × d)·(d × P) / D and a·d.
    let (nx, ny, nz) = (ay * dz - az * dy, az * dx - ax * dz, ax * dy - ay * dx);
    let across = -(nx.mul_add(mx, ny.mul_add(my, nz * mz))) / distance;
    let along = ax.mul_add(dx, ay.mul_add(dy, az * dz));
    let out = ax.mul_add(mx, ay.mul_add(my, az * mz)) / distance;
    // A ray through the lamp passes it at its radius: this is the missing part of a unit axis.
    let share = mx.mul_add(mx, my.mul_add(my, mz * mz)).sqrt() / distance;
    let missing = (1.0 - share * share) * (1.0 - along * along).max(0.0);
    let most = across.mul_add(across, along * along).sqrt();
    let share = (cone / most.max(1e-9)).min(1.0);
    Aim {
        across,
        along,
        out: out.mul_add(out, missing).sqrt(),
        middle: 0.5 * (full_angle(along, across) + std::f32::consts::FRAC_PI_2),
        half: 0.5 * angle((1.0 - share * share).max(0.0).sqrt(), share.max(1e-9)),
    }
}

/// The intervals of a run: t₀ and D as meters of mean water, middle and half length in β, the factor of the sum over the nodes, and
/// the geometry of a spot.
pub(super) struct Intervals {
    pub(super) nearest: Lanes,
    pub(super) distance: Lanes,
    pub(super) sin: Lanes,
    pub(super) cos: Lanes,
    pub(super) half: Lanes,
    pub(super) scale: Lanes,
    /// cos of the angle to the axis: `across · cos θ + along · sin θ`.
    pub(super) across: Lanes,
    pub(super) along: Lanes,
    /// Length of the part of the axis that is at right angles to the plane of ray and lamp.
    pub(super) out: Lanes,
    /// Where the ray begins, in β.
    pub(super) from: Lanes,
}

/// Turbidity of the water on the rays of a run, see [`glow_within`](super::glow_within).
pub(super) struct Murk {
    /// The factor of b.
    pub(super) source: Lanes,
    /// The factor of c.
    pub(super) path: Lanes,
    /// How many times as long the ray is as the stretch that the factor of b is a mean of.
    pub(super) stretch: Lanes,
}

impl Default for Murk {
    fn default() -> Self {
        let [source, path, stretch] = [[1.0; RUN]; 3];
        Self {
            source,
            path,
            stretch,
        }
    }
}

#[inline(always)]
pub(super) fn murk_of(
    lamp: &Glow,
    rays: &Rays,
    patches: &turbidity::Rays,
    start: (usize, usize),
    to: &mut Murk,
) {
    let (begin, end) = stretch_of(lamp, rays);
    let to_end = patches.excess(start, &end);
    let is_long = extreme(&begin, f32::max) > 0.0;
    let to_begin = if is_long {
        patches.excess(start, &begin)
    } else {
        [0.0; RUN]
    };
    factors_of((&begin, &end), (&to_begin, &to_end), is_long, to);
}

/// The same of rays outside a single row.
#[inline(always)]
pub(super) fn murk_along(lamp: &Glow, rays: &Rays, patches: &turbidity::Rays, to: &mut Murk) {
    let (begin, end) = stretch_of(lamp, rays);
    let directions = [&rays.right, &rays.down, &rays.ahead];
    let to_end = patches.excess_along(directions, &end);
    let to_begin = patches.excess_along(directions, &begin);
    factors_of((&begin, &end), (&to_begin, &to_end), true, to);
}

/// Where the stretches begin and end that the factor of b is a mean of.
#[inline(always)]
fn stretch_of(lamp: &Glow, rays: &Rays) -> (Lanes, Lanes) {
    let [mut begin, mut end] = [[0.0f32; RUN]; 2];
    for i in 0..RUN {
        let Beside {
            nearest, distance, ..
        } = beside(lamp, rays, i);
        begin[i] = (rays.end[i].min(nearest) - lamp.before * distance).max(0.0);
        end[i] = rays.end[i].min(nearest.max(BESIDE as f32 * distance));
    }
    (begin, end)
}

#[inline(always)]
fn factors_of(
    (begin, end): (&Lanes, &Lanes),
    (to_begin, to_end): (&Lanes, &Lanes),
    is_long: bool,
    to: &mut Murk,
) {
    for i in 0..RUN {
        to.path[i] = (1.0 + to_end[i]).max(0.0);
    }
    to.source = to.path;
    if is_long {
        for i in 0..RUN {
            let excess = (end[i] * to_end[i] - begin[i] * to_begin[i]) / (end[i] - begin[i]);
            to.source[i] = (1.0 + excess).max(0.0);
            to.stretch[i] = end[i] / (end[i] - begin[i]);
        }
    }
}

/// The intervals of a run, of a spot within its cone, or as a `WHOLE` from the camera to the end.
#[inline(always)]
pub(super) fn intervals<const SPOT: bool, const WHOLE: bool>(
    lamp: &Glow,
    rays: &Rays,
    murk: &Murk,
) -> (Intervals, Span) {
    let empty = [0.0f32; RUN];
    let mut to = Intervals {
        nearest: empty,
        distance: empty,
        sin: empty,
        cos: empty,
        half: empty,
        scale: empty,
        across: empty,
        along: empty,
        out: empty,
        from: empty,
    };
    let (mut first, mut last, mut least, mut near, mut met) = (empty, empty, empty, empty, empty);
    for i in 0..RUN {
        let place = beside(lamp, rays, i);
        let Beside {
            nearest, distance, ..
        } = place;
        let square = distance * distance;
        let to_eye = nearest.mul_add(nearest, square).sqrt();
        let ahead = nearest > 0.0;
        let from = angle(
            if ahead { distance } else { to_eye - nearest },
            if ahead { to_eye + nearest } else { distance },
        );
        let beyond = rays.end[i] - nearest;
        let to_end = beyond.mul_add(beyond, square).sqrt();
        let before = beyond < 0.0;
        let end = angle(
            if before { distance } else { to_end + beyond },
            if before { to_end - beyond } else { distance },
        );
        let (mut from, mut end) = (from, end);
        if SPOT {
            let aim = aim(lamp, [rays.right[i], rays.down[i], rays.ahead[i]], &place);
            if WHOLE {
                to.out[i] = aim.out;
            } else {
                from = from.max(aim.middle - aim.half);
                end = end.min(aim.middle + aim.half);
            }
            (to.across[i], to.along[i]) = (aim.across, aim.along);
        }
        if WHOLE {
            to.from[i] = from;
        }
        let half = (0.5 * (end - from)).max(0.0);
        let (sin, cos) = sin_cos((0.5 * (end + from)).max(0.0).min(std::f32::consts::FRAC_PI_2));
        (to.nearest[i], to.distance[i]) = (murk.path[i] * nearest, murk.path[i] * distance);
        (to.half[i], to.scale[i]) = (half, murk.source[i] * half / distance);
        (to.sin[i], to.cos[i]) = (sin, cos);
        // A pixel without any light must not widen the span.
        let lit = half > 0.0;
        first[i] = if lit { from } else { f32::INFINITY };
        last[i] = if lit { end } else { 0.0 };
        least[i] = if lit { end } else { f32::INFINITY };
        met[i] = if lit { to_end } else { f32::INFINITY };
        near[i] = if lit { distance } else { f32::INFINITY };
    }
    let span = Span {
        from: extreme(&first, smaller),
        to: extreme(&last, larger),
        least_to: extreme(&least, smaller),
        nearest_m: extreme(&near, smaller),
        end_m: extreme(&met, smaller),
        clearest: extreme(&murk.path, f32::min),
        murkiest: extreme(&murk.path, f32::max),
        source: extreme(&murk.source, f32::max),
        stretch: extreme(&murk.stretch, f32::max),
    };
    (to, span)
}

/// The minimum or maximum, by halves: a sequential fold does not vectorize.
#[inline(always)]
pub(super) fn extreme(lanes: &Lanes, choose: impl Fn(f32, f32) -> f32) -> f32 {
    let mut best = *lanes;
    let mut half = RUN / 2;
    while half > 0 {
        for i in 0..half {
            best[i] = choose(best[i], best[i + half]);
        }
        half /= 2;
    }
    best[0]
}
