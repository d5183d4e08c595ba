//! How a camera on a path is held: level, and without turning over where it looks straight up or down.

use std::f64::consts::TAU;

use spec::Waypoint;

use super::turned;
use crate::CameraPose;
use crate::pose::{cross, dot, length, scale, sub, unit};

/// From this |vertical component| of the direction on (about 75 degrees) a level camera turns too fast about its axis.
const STEEP: f64 = 0.966;
/// Below this angle between the first and the last direction there is no arc.
const LEAST_ARC_RAD: f64 = 1e-9;

/// The pose without sway. Level all the way, unless the way passes nearly straight up or down, where a level camera
/// would turn over at once: then the axes are carried along without turning about the optical axis (parallel transport
/// on the arc of the directions, do Carmo 1976, section 4.4) from the end that is farther from the vertical, and what
/// is missing to level at the other end is made up evenly on the way.
pub(super) fn pose(ends: [Waypoint; 2], eye: [f64; 3], target: [f64; 3]) -> CameraPose {
    let level = CameraPose::looking(eye, target, 0.0);
    let ends = ends.map(|end| CameraPose::looking(end.position_m, end.target_m, 0.0));
    let (first, last) = (ends[0].ahead, ends[1].ahead);
    let normal = cross(first, last);
    let whole = libm::atan2(length(normal), dot(first, last));
    if whole < LEAST_ARC_RAD || steepest(first, last, whole) < STEEP {
        return level;
    }
    let axis = unit(normal);
    let [steep_first, steep_last] = [first, last].map(|ahead| ahead[2].abs());
    let backwards = steep_first > steep_last;
    let (from, to) = if backwards {
        (ends[1], ends[0])
    } else {
        (ends[0], ends[1])
    };
    let angle = libm::atan2(dot(axis, cross(first, level.ahead)), dot(first, level.ahead));
    let done = if backwards { angle - whole } else { angle };
    let carried = turned(from.right, axis, done);
    let arrived = turned(from.right, axis, if backwards { -whole } else { whole });
    // A level that is not there cannot be reached: looking nearly straight up or down, any roll is as good.
    let missing = if steep_first.max(steep_last) >= STEEP {
        0.0
    } else {
        libm::atan2(dot(to.ahead, cross(arrived, to.right)), dot(arrived, to.right))
    };
    let right = turned(carried, level.ahead, missing * (done / whole).abs());
    CameraPose {
        right,
        down: cross(level.ahead, right),
        ..level
    }
}

/// The largest |vertical component| of the directions on the arc of `whole` radians between two unit vectors.
fn steepest(first: [f64; 3], last: [f64; 3], whole: f64) -> f64 {
    // On the arc a cos t + b sin t the height is a_z cos t + b_z sin t: extreme at the ends or where its slope is 0.
    let across = unit(sub(last, scale(first, dot(first, last))));
    let height = |t: f64| (first[2] * libm::cos(t) + across[2] * libm::sin(t)).abs();
    let summit = libm::atan2(across[2], first[2]);
    let inside = [summit - TAU / 2.0, summit, summit + TAU / 2.0]
        .into_iter()
        .filter(|t| (0.0..=whole).contains(t));
    inside.map(height).fold(height(0.0).max(height(whole)), f64::max)
}

#[cfg(test)]
mod tests {
    use super::super::{CameraPath, Sway};
    use super::*;

    /// Largest turn of an axis from one frame to the next, radians.
    fn fastest(start: Waypoint, end: Waypoint, frames: usize) -> f64 {
        let path = CameraPath::new(start, end, frames, Sway::NONE).unwrap();
        let turn = |frame: usize| {
            let (here, next) = (path.pose(frame), path.pose(frame + 1));
            for pose in [&here, &next] {
                assert!(dot(pose.right, pose.ahead).abs() < 1e-9 && dot(pose.down, pose.right).abs() < 1e-9);
                assert!(dot(cross(pose.right, pose.down), pose.ahead) > 1.0 - 1e-9);
            }
            let axes = [
                (here.right, next.right),
                (here.down, next.down),
                (here.ahead, next.ahead),
            ];
            axes.map(|(a, b)| length(sub(a, b)))
                .into_iter()
                .fold(0.0, f64::max)
        };
        (0..frames - 1).map(turn).fold(0.0, f64::max)
    }

    #[test]
    fn the_camera_does_not_turn_over_where_it_looks_straight_down() {
        let at = |target_m: [f64; 3]| Waypoint {
            position_m: [0.0, 0.0, 4.0],
            target_m,
        };
        // Over the vertical from one side to the other; past it, a hand's breadth beside; up from it; and down to it.
        let ways = [
            (at([3.0, 0.0, 0.0]), at([-3.0, 0.0, 0.0])),
            (at([3.0, 0.05, 0.0]), at([-3.0, 0.05, 0.0])),
            (at([0.0, 0.0, 0.0]), at([0.5, 4.0, 3.0])),
            (at([0.5, 4.0, 3.0]), at([0.001, 0.0, 0.0])),
            (at([1.0, -2.0, 8.0]), at([-1.0, 2.0, 8.5])),
        ];
        for (start, end) in ways {
            let moved = fastest(start, end, 200);
            assert!(moved < 0.05, "{start:?} {end:?}: {moved} radians in one frame");
        }
        let level = |frame: usize| {
            CameraPath::new(ways[1].0, ways[1].1, 200, Sway::NONE)
                .unwrap()
                .pose(frame)
                .right[2]
        };
        assert!(
            level(0).abs() < 1e-9 && level(199).abs() < 1e-9,
            "level at both ends"
        );
    }

    #[test]
    fn a_way_that_stays_clear_of_the_vertical_is_level_all_along() {
        let at = |position_m: [f64; 3], target_m: [f64; 3]| Waypoint { position_m, target_m };
        let path = CameraPath::new(
            at([-2.0, -3.0, 1.0], [-2.0, 0.0, 1.0]),
            at([2.0, -3.0, 1.5], [2.0, 0.0, 1.0]),
            50,
            Sway::NONE,
        )
        .unwrap();
        assert!((0..50).all(|frame| path.pose(frame).right[2].abs() < 1e-12));
    }
}
