//! The way of a camera through a world: from a start to an end, with the small sway of a vehicle.

mod held;

use std::f64::consts::TAU;

use imaging::random::Stream;
use spec::Waypoint;

use crate::pose::{add, cross, dot, length, scale, sub, unit};
use crate::{CameraPose, SceneError};

/// Most frames of a path.
pub const MOST_FRAMES: usize = 1_000_000;
/// Positions and targets lie within this distance of the origin, in metres.
pub const FARTHEST_M: f64 = 1000.0;
/// A camera must look at something at least this far away, and a path of several frames be at least this long, in metres.
pub const SHORTEST_M: f64 = 1e-3;
/// Largest sway: metres, and radians.
pub const LARGEST_SWAY: (f64, f64) = (1.0, 0.5);

/// How a vehicle that holds its course still moves.
///
/// Each of the three shifts and three turns is the sum of two sines of about `period_frames` and 0.37 of it with seeded phases,
/// 0.7 and 0.3 of the amplitude: smooth, and never more than the amplitude.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sway {
    /// Amplitude along each axis of the camera, m, from 0 to 1.
    pub position_m: f64,
    /// Amplitude of each turn about an axis of the camera, radians, from 0 to 0.5.
    pub angle_rad: f64,
    /// Frames of a slow swing, at least 2.
    pub period_frames: f64,
    /// Seed of the phases.
    pub seed: u64,
}

impl Sway {
    /// None at all.
    pub const NONE: Self = Self {
        position_m: 0.0,
        angle_rad: 0.0,
        period_frames: 100.0,
        seed: 0,
    };
}

/// A straight way from a start to an end at constant speed. Frame 0 is at the start, the last frame at the end; a path of one
/// frame stays at the start. A pose is a pure function of the path and the frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraPath {
    start: Waypoint,
    end: Waypoint,
    frames: usize,
    sway: Sway,
}

impl CameraPath {
    /// A path of `frames` frames, 1 to [`MOST_FRAMES`].
    ///
    /// # Errors
    /// All that is wrong at once: [`SceneError::Number`] for a number of frames, a coordinate, a sway, a length or a target
    /// outside its limits.
    pub fn new(start: Waypoint, end: Waypoint, frames: usize, sway: Sway) -> Result<Self, Vec<SceneError>> {
        let mut errors = Vec::new();
        let mut check = |good: bool, field: &'static str, value: f64, limit: &'static str| {
            if !good {
                errors.push(SceneError::Number { field, value, limit });
            }
        };
        check(
            (1..=MOST_FRAMES).contains(&frames),
            "path.frames",
            frames as f64,
            "1 to 1000000",
        );
        let places = [
            ("path.start.position_m", start.position_m),
            ("path.start.target_m", start.target_m),
            ("path.end.position_m", end.position_m),
            ("path.end.target_m", end.target_m),
        ];
        let mut inside = true;
        for (field, place) in places {
            for value in place {
                let good = value.abs() <= FARTHEST_M;
                inside &= good;
                check(good, field, value, "-1000 to 1000 m");
            }
        }
        if inside {
            let travelled =
                length(sub(end.position_m, start.position_m)) + length(sub(end.target_m, start.target_m));
            check(
                frames == 1 || travelled >= SHORTEST_M,
                "path.end",
                travelled,
                "at least 0.001 m from the start",
            );
            let nearest = nearest_target(&start, &end);
            check(
                nearest >= SHORTEST_M,
                "path.end.target_m",
                nearest,
                "at least 0.001 m from the camera, all the way",
            );
        }
        let (shift, turn) = LARGEST_SWAY;
        check(
            (0.0..=shift).contains(&sway.position_m),
            "path.sway.position_m",
            sway.position_m,
            "0 to 1 m",
        );
        check(
            (0.0..=turn).contains(&sway.angle_rad),
            "path.sway.angle_rad",
            sway.angle_rad,
            "0 to 0.5",
        );
        check(
            sway.period_frames >= 2.0 && sway.period_frames.is_finite(),
            "path.sway.period_frames",
            sway.period_frames,
            "at least 2",
        );
        if errors.is_empty() {
            Ok(Self {
                start,
                end,
                frames,
                sway,
            })
        } else {
            Err(errors)
        }
    }

    /// Number of frames.
    #[must_use]
    pub fn frames(&self) -> usize {
        self.frames
    }

    /// The pose of a frame, from 0 on; frames after the last stay at the end.
    #[must_use]
    pub fn pose(&self, frame: usize) -> CameraPose {
        let share = frame.min(self.frames - 1) as f64 / (self.frames.max(2) - 1) as f64;
        let between = |a: [f64; 3], b: [f64; 3]| add(a, scale(sub(b, a), share));
        let eye = between(self.start.position_m, self.end.position_m);
        let target = between(self.start.target_m, self.end.target_m);
        let pose = held::pose([self.start, self.end], eye, target);
        let swing = |axis: u64| self.swing(frame as f64, axis);
        let axes = [pose.right, pose.down, pose.ahead];
        let mut moved = pose;
        for (i, axis) in axes.into_iter().enumerate() {
            let shift = scale(axis, self.sway.position_m * swing(i as u64));
            moved.position_m = add(moved.position_m, shift);
        }
        for (i, axis) in axes.into_iter().enumerate() {
            let angle = self.sway.angle_rad * swing(3 + i as u64);
            moved.right = turned(moved.right, axis, angle);
            moved.down = turned(moved.down, axis, angle);
            moved.ahead = turned(moved.ahead, axis, angle);
        }
        moved
    }

    /// -1..=1.
    fn swing(&self, frame: f64, axis: u64) -> f64 {
        let dice = Stream::stage(self.sway.seed, "path/sway");
        let draw = |choice: u64| dice.unit(axis, choice);
        let wave = |period: f64, choice: u64| {
            let period = period * (0.8 + 0.4 * draw(choice));
            libm::sin(TAU * (frame / period + draw(choice + 1)))
        };
        let slow = wave(self.sway.period_frames, 0);
        0.7 * slow + 0.3 * wave(0.37 * self.sway.period_frames, 2)
    }
}

/// The least distance between camera and target on the way.
fn nearest_target(start: &Waypoint, end: &Waypoint) -> f64 {
    let from = sub(start.target_m, start.position_m);
    let change = sub(sub(end.target_m, end.position_m), from);
    let square = dot(change, change);
    let share = if square > 0.0 {
        (-dot(from, change) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    length(add(from, scale(change, share)))
}

/// A vector turned about a unit axis (Rodrigues).
fn turned(v: [f64; 3], axis: [f64; 3], angle: f64) -> [f64; 3] {
    let (sin, cos) = libm::sincos(angle);
    let along = scale(axis, dot(axis, v) * (1.0 - cos));
    unit(add(add(scale(v, cos), scale(cross(axis, v), sin)), along))
}

#[cfg(test)]
mod tests {
    use super::*;

    const START: Waypoint = Waypoint {
        position_m: [-2.0, -3.0, 1.0],
        target_m: [-2.0, 0.0, 1.0],
    };
    const END: Waypoint = Waypoint {
        position_m: [2.0, -3.0, 1.5],
        target_m: [2.0, 0.0, 1.0],
    };
    const SWAY: Sway = Sway {
        position_m: 0.05,
        angle_rad: 0.03,
        period_frames: 40.0,
        seed: 9,
    };

    #[test]
    fn a_path_without_sway_is_a_straight_line_at_constant_speed() {
        let path = CameraPath::new(START, END, 5, Sway::NONE).unwrap();
        assert_eq!(path.pose(0).position_m, START.position_m);
        assert_eq!(path.pose(4).position_m, END.position_m);
        assert_eq!(path.pose(2).position_m, [0.0, -3.0, 1.25]);
        assert_eq!(path.pose(99), path.pose(4));
        assert_eq!(path.pose(0).ahead, [0.0, 1.0, 0.0]);
        let still = CameraPath::new(START, END, 1, Sway::NONE).unwrap();
        assert_eq!(still.pose(0).position_m, START.position_m);
    }

    #[test]
    fn sway_is_smooth_small_and_of_its_seed() {
        let path = CameraPath::new(START, END, 200, SWAY).unwrap();
        let straight = CameraPath::new(START, END, 200, Sway::NONE).unwrap();
        let away = |frame: usize| sub(path.pose(frame).position_m, straight.pose(frame).position_m);
        let mut most = 0.0f64;
        for frame in 0..200 {
            let (here, next) = (away(frame), away(frame + 1));
            most = most.max(length(here));
            assert!(length(here) <= 0.05 * 3f64.sqrt() + 1e-12);
            // Five swings of the fast sine in 40 frames: at most a few percent of the amplitude a frame.
            assert!(length(sub(next, here)) < 0.05 * 0.6, "frame {frame}");
            let pose = path.pose(frame);
            assert!(dot(pose.ahead, straight.pose(frame).ahead) > libm::cos(0.03 * 3.0));
            assert!(dot(cross(pose.right, pose.down), pose.ahead) > 1.0 - 1e-9);
        }
        assert!(most > 0.02);
        assert_eq!(
            path.pose(17),
            CameraPath::new(START, END, 200, SWAY).unwrap().pose(17)
        );
        let other = CameraPath::new(START, END, 200, Sway { seed: 0, ..SWAY }).unwrap();
        assert_ne!(path.pose(17), other.pose(17));
    }

    #[test]
    fn everything_that_is_wrong_is_named_at_once() {
        let bad = Waypoint {
            position_m: [f64::NAN, 0.0, 2000.0],
            ..START
        };
        let sway = Sway {
            position_m: -1.0,
            angle_rad: 2.0,
            period_frames: 0.0,
            seed: 0,
        };
        let errors = CameraPath::new(bad, END, 0, sway).unwrap_err();
        let fields: Vec<_> = errors.iter().map(SceneError::field).collect();
        assert_eq!(
            fields,
            [
                "path.frames",
                "path.start.position_m",
                "path.start.position_m",
                "path.sway.position_m",
                "path.sway.angle_rad",
                "path.sway.period_frames"
            ]
        );
        let errors = CameraPath::new(START, START, 2, SWAY).unwrap_err();
        assert!(errors[0].to_string().contains("`path.end` is 0"), "{}", errors[0]);
        // The target passes through the camera half way.
        let behind = Waypoint {
            target_m: [2.0, -6.0, 1.5],
            ..END
        };
        let errors = CameraPath::new(START, behind, 9, SWAY).unwrap_err();
        assert_eq!(errors[0].field(), "path.end.target_m");
        assert!(CameraPath::new(START, START, 1, SWAY).is_ok());
    }
}
