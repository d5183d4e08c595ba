//! Joints of concrete and masonry: formwork boards, tunnel segments, blocks in courses.

use super::surface::{Courses, Grain, Points, Unroll, line};
use crate::site::lanes::{LANES, Lane, Lane3, ZEROS, angle, floor, ramp, smaller};
use crate::site::lattice::{hash, lattice};

pub(super) struct Joints {
    /// Share of the pixel covered by a joint, 0..1.
    pub(super) joint: Lane,
    /// Depth of shade in pockets.
    pub(super) pocket: Lane,
    /// Brightness factor of the piece.
    pub(super) tint: Lane,
    /// Slope of the groove in the solid's frame.
    pub(super) slope: Lane3,
}

impl Joints {
    pub(super) const NONE: Self = Self {
        joint: ZEROS,
        pocket: ZEROS,
        tint: [1.0; LANES],
        slope: [ZEROS; 3],
    };
}

/// Boards of 0.45 m with seams that waver with the noise.
#[inline(always)]
pub(super) fn boards(joints: &mut Joints, grain: &Grain<'_>, phase: f32) {
    const BOARD_PER_M: f32 = 2.2;
    let Grain { points, broad, .. } = *grain;
    let (local, footprint) = (points.local, points.place.footprint);
    for i in 0..LANES {
        let place = local[2][i] * BOARD_PER_M + phase + 0.02 * broad.value[i];
        let away = (place - floor(place + 0.5)).abs() / BOARD_PER_M;
        let visible = 1.0 - ramp(footprint[i], 0.01, 0.04);
        joints.joint[i] = visible * (1.0 - ramp(away, 0.004, 0.016));
    }
}

/// u of each point, and its gradient.
#[inline(always)]
fn unrolled(unroll: Unroll, local: &Lane3) -> (Lane, [Lane; 2]) {
    let (mut u, mut toward) = (ZEROS, [ZEROS; 2]);
    let [xs, ys, _] = local;
    match unroll {
        Unroll::Round { radius } => {
            for i in 0..LANES {
                let (x, y) = (xs[i], ys[i]);
                (u[i], toward[0][i], toward[1][i]) = (radius * angle(y, x), -y / radius, x / radius);
            }
        }
        Unroll::Walls { half } => {
            for i in 0..LANES {
                let (x, y) = (xs[i], ys[i]);
                let on_x = half[0] - x.abs() < half[1] - y.abs();
                (u[i], toward[0][i], toward[1][i]) = if on_x { (y, 0.0, 1.0) } else { (x, 1.0, 0.0) };
            }
        }
    }
    (u, toward)
}

/// `around`: number of pieces around a cylinder. Piece numbers are modulo this.
#[inline(always)]
pub(super) fn courses(joints: &mut Joints, courses: &Courses, around: f32, key: u32, points: &Points<'_>) {
    let Courses {
        unroll,
        height,
        length,
        joint,
        pocket,
        variety,
    } = *courses;
    let (z, footprint) = (&points.local[2], points.place.footprint);
    let (u, toward) = unrolled(unroll, points.local);
    for i in 0..LANES {
        let v = z[i] / height;
        let course = floor(v);
        let odd = course - 2.0 * floor(course * 0.5);
        let w = u[i] / length + 0.5 * odd;
        let number = floor(w);
        let piece = number - around * floor(number / around);
        let (in_u, in_v) = (w - number, v - course);
        let (from_u, from_v) = (joint_distance(in_u, length), joint_distance(in_v, height));
        let (au, av) = (from_u.abs(), from_v.abs());
        joints.joint[i] = line(smaller(au, av), joint, footprint[i]);
        let visible = 1.0 - ramp(footprint[i], 2.0 * joint, 6.0 * joint);
        let slope_u = visible * worn_slope(from_u, au, joint);
        let slope_v = visible * worn_slope(from_v, av, joint);
        let bolt_u = ((in_u - 0.5).abs() - 0.25) * length;
        let bolt_v = av - 0.17;
        let round = bolt_u * bolt_u * 160.0 + bolt_v * bolt_v * 320.0;
        joints.pocket[i] = pocket * (1.0 - ramp(round, 0.6, 1.0));
        let [x, y, _] = lattice([piece, course, 0.0], key);
        let drawn = hash([x, y, 0]);
        joints.tint[i] = 1.0 + variety * ((drawn >> 8) as i32 as f32 * (2.0 / 16_777_216.0) - 1.0);
        joints.slope[0][i] = slope_u * toward[0][i];
        joints.slope[1][i] = slope_u * toward[1][i];
        joints.slope[2][i] = slope_v;
    }
}

/// Signed distance to the middle of the nearest joint, m.
#[inline(always)]
fn joint_distance(part: f32, side: f32) -> f32 {
    if part > 0.5 {
        (part - 1.0) * side
    } else {
        part * side
    }
}

/// Edges of pieces are worn round over two joint widths: the surface falls towards the joint.
#[inline(always)]
fn worn_slope(signed: f32, distance: f32, joint: f32) -> f32 {
    let near = 1.0 - ramp(distance, joint, 3.0 * joint);
    if signed < 0.0 { -0.9 * near } else { 0.9 * near }
}
