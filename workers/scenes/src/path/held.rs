//! Orientation of a camera on a path: level, without flipping where it looks straight up or down.

use std::f64::consts::PI;

use imaging::vector::DVec3;

use crate::CameraPose;
use spec::Waypoint;

/// Steepness (|vertical component| of the direction, about 75°) beyond which a level camera rotates too fast about its
/// axis.
const STEEP: f64 = 0.966;
/// Smaller angles between the first and the last direction define no arc.
const LEAST_ARC_RAD: f64 = 1e-9;

/// The pose without sway. The camera stays level, unless the path passes nearly straight up or down, where a level
/// camera would flip. In that case the axes are transported in parallel along the arc of the directions (do Carmo 1976,
/// section 4.4) from the end farther from the vertical, and the missing roll at the other end is distributed evenly
/// along the path.
pub(super) fn pose(ends: [LookAt; 2], eye: DVec3, target: DVec3) -> CameraPose {
    let level = CameraPose::looking(eye, target, 0.0);
    let ends = ends.map(|end| CameraPose::looking(end.position, end.target, 0.0));
    let (first, last) = (ends[0].ahead, ends[1].ahead);
    let normal = first.cross(last);
    let whole = libm::atan2(normal.length(), first.dot(last));
    if whole < LEAST_ARC_RAD || steepest(first, last, whole) < STEEP {
        return level;
    }
    let axis = normal.normalized();
    let [steep_first, steep_last] = [first, last].map(|ahead| ahead.z.abs());
    let backwards = steep_first > steep_last;
    let [from, to] = if backwards { [ends[1], ends[0]] } else { ends };
    let angle = libm::atan2(axis.dot(first.cross(level.ahead)), first.dot(level.ahead));
    let done = if backwards { angle - whole } else { angle };
    let carried = turned(from.right, axis, done);
    let arrived = turned(from.right, axis, if backwards { -whole } else { whole });
    // Nearly straight up or down, level is undefined and any roll is acceptable.
    let missing = if steep_first.max(steep_last) >= STEEP {
        0.0
    } else {
        libm::atan2(to.ahead.dot(arrived.cross(to.right)), arrived.dot(to.right))
    };
    let right = turned(carried, level.ahead, missing * (done / whole).abs());
    CameraPose {
        right,
        down: level.ahead.cross(right),
        ..level
    }
}

/// The largest |vertical component| on the arc of `whole` radians between two unit directions.
fn steepest(first: DVec3, last: DVec3, whole: f64) -> f64 {
    // On the arc a cos t + b sin t the height is a_z cos t + b_z sin t: extreme at the ends or where its slope is 0.
    let across = (last - first * first.dot(last)).normalized();
    let summit = libm::atan2(across.z, first.z);
    let summits = [summit - PI, summit, summit + PI].into_iter();
    let inside = summits.filter(|t| (0.0..=whole).contains(t));
    inside
        .chain([0.0, whole])
        .map(|t| (first.z * libm::cos(t) + across.z * libm::sin(t)).abs())
        .fold(0.0, f64::max)
}

#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct LookAt {
    pub(super) position: DVec3,
    pub(super) target: DVec3,
}

impl From<Waypoint> for LookAt {
    fn from(waypoint: Waypoint) -> Self {
        Self {
            position: waypoint.position_m.into(),
            target: waypoint.target_m.into(),
        }
    }
}

/// Rotates a vector about a unit axis (Rodrigues).
pub(super) fn turned(v: DVec3, axis: DVec3, angle: f64) -> DVec3 {
    let (sin, cos) = libm::sincos(angle);
    let along = axis * (axis.dot(v) * (1.0 - cos));
    (v * cos + axis.cross(v) * sin + along).normalized()
}

#[cfg(test)]
mod tests {
    use spec::Waypoint;

    use super::super::tests::straight;

    /// Largest rotation of an axis between successive frames, radians.
    fn fastest(start: Waypoint, end: Waypoint, frames: usize) -> f64 {
        let path = straight(start, end, frames);
        let turn = |frame: usize| {
            let (here, next) = (path.pose(frame), path.pose(frame + 1));
            for pose in [&here, &next] {
                assert!(pose.right.dot(pose.ahead).abs() < 1e-9 && pose.down.dot(pose.right).abs() < 1e-9);
                assert!(pose.right.cross(pose.down).dot(pose.ahead) > 1.0 - 1e-9);
            }
            let axes = [
                (here.right, next.right),
                (here.down, next.down),
                (here.ahead, next.ahead),
            ];
            axes.map(|(a, b)| (a - b).length())
                .into_iter()
                .fold(0.0, f64::max)
        };
        (0..frames - 1).map(turn).fold(0.0, f64::max)
    }

    #[test]
    fn the_camera_does_not_turn_over_where_it_looks_straight_down() {
        let looking_at = |target_m: [f64; 3]| Waypoint {
            position_m: [0.0, 0.0, 4.0],
            target_m,
        };
        // Across the vertical, past it at a short distance, up from it, and down to it.
        let ways = [
            (looking_at([3.0, 0.0, 0.0]), looking_at([-3.0, 0.0, 0.0])),
            (looking_at([3.0, 0.05, 0.0]), looking_at([-3.0, 0.05, 0.0])),
            (looking_at([0.0, 0.0, 0.0]), looking_at([0.5, 4.0, 3.0])),
            (looking_at([0.5, 4.0, 3.0]), looking_at([0.001, 0.0, 0.0])),
            (looking_at([1.0, -2.0, 8.0]), looking_at([-1.0, 2.0, 8.5])),
        ];
        for (start, end) in ways {
            let moved = fastest(start, end, 200);
            assert!(moved < 0.05, "{start:?} {end:?}: {moved} radians in one frame");
        }
        let level = |frame: usize| straight(ways[1].0, ways[1].1, 200).pose(frame).right.z;
        assert!(
            level(0).abs() < 1e-9 && level(199).abs() < 1e-9,
            "level at both ends"
        );
    }

    #[test]
    fn a_way_that_stays_clear_of_the_vertical_is_level_all_along() {
        let waypoint = |position_m: [f64; 3], target_m: [f64; 3]| Waypoint { position_m, target_m };
        let path = straight(
            waypoint([-2.0, -3.0, 1.0], [-2.0, 0.0, 1.0]),
            waypoint([2.0, -3.0, 1.5], [2.0, 0.0, 1.0]),
            50,
        );
        assert!((0..50).all(|frame| path.pose(frame).right.z.abs() < 1e-12));
    }
}
