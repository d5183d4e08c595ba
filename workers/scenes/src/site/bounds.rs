//! Boxes along the axes of the world: lowest and highest corner, in metres.

use super::lanes::{LANES, Lane3, larger, smaller};
use super::solid::Solid;
use super::vector::{Vec3, vec3};

/// A box around a solid in the world; around a hollow's wall, everything.
pub(super) fn around(solid: &Solid) -> [Vec3; 2] {
    if solid.is_hollow() {
        return [vec3(-1e9, -1e9, -1e9), vec3(1e9, 1e9, 1e9)];
    }
    let corners = solid.corners();
    corners.iter().fold([corners[0]; 2], |[low, high], corner| {
        [lowest(low, *corner), highest(high, *corner)]
    })
}

/// Whether two boxes come within `reach` metres of each other along every axis.
pub(super) fn touch(a: &[Vec3; 2], b: &[Vec3; 2], reach: f32) -> bool {
    let reach = vec3(reach, reach, reach);
    overlap(&[a[0] - reach, a[1] + reach], b)
}

fn overlap(a: &[Vec3; 2], b: &[Vec3; 2]) -> bool {
    let along = |low: f32, high: f32, other_low: f32, other_high: f32| low <= other_high && other_low <= high;
    along(a[0].x, a[1].x, b[0].x, b[1].x)
        && along(a[0].y, a[1].y, b[0].y, b[1].y)
        && along(a[0].z, a[1].z, b[0].z, b[1].z)
}

#[inline(always)]
fn lowest(a: Vec3, b: Vec3) -> Vec3 {
    vec3(smaller(a.x, b.x), smaller(a.y, b.y), smaller(a.z, b.z))
}

#[inline(always)]
fn highest(a: Vec3, b: Vec3) -> Vec3 {
    vec3(larger(a.x, b.x), larger(a.y, b.y), larger(a.z, b.z))
}

/// Lowest and highest coordinates of a group.
#[inline(always)]
pub(super) fn extent(points: &Lane3) -> [Vec3; 2] {
    const WIDE: usize = 8;
    let (mut low, mut high) = ([[0.0; WIDE]; 3], [[0.0; WIDE]; 3]);
    for axis in 0..3 {
        low[axis].copy_from_slice(&points[axis][..WIDE]);
        high[axis].copy_from_slice(&points[axis][..WIDE]);
        for chunk in 1..LANES / WIDE {
            for i in 0..WIDE {
                let p = points[axis][chunk * WIDE + i];
                low[axis][i] = smaller(p, low[axis][i]);
                high[axis][i] = larger(p, high[axis][i]);
            }
        }
    }
    let least = low.map(|lane| lane.into_iter().fold(f32::INFINITY, smaller));
    let most = high.map(|lane| lane.into_iter().fold(f32::NEG_INFINITY, larger));
    [
        vec3(least[0], least[1], least[2]),
        vec3(most[0], most[1], most[2]),
    ]
}
