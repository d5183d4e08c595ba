//! Camera paths: from a start to an end at constant speed, with the small sway of a vehicle.

mod held;

use std::f64::consts::TAU;

use imaging::random::Stream;
use imaging::vector::DVec3;
use spec::{Path, Waypoint};

use crate::{CameraPose, SceneError};
use held::{LookAt, turned};

/// Minimum distance between camera and target, and minimum length of a path of several frames, m.
const SHORTEST_M: f64 = 1e-3;

/// A straight path from a start to an end at constant speed. Frame 0 is at the start, the last frame at the end; a path
/// of one frame stays at the start. A pose is a pure function of the path and the frame.
///
/// The vehicle sways: each of three shifts and three rotations along and about the camera's axes is the sum of two
/// sines with periods of about `sway_frames` and 0.37 of it, seeded phases, and 0.7 and 0.3 of the amplitude (`sway_m`,
/// `sway_deg`). The sum never exceeds the amplitude.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CameraPath {
    start: LookAt,
    end: LookAt,
    path: Path,
    seed: u64,
}

impl CameraPath {
    /// A path between two waypoints with the frames and the sway of a description.
    ///
    /// # Errors
    /// [`SceneError::Number`] for a path of several frames shorter than [`SHORTEST_M`] and for a target closer to the
    /// camera than that anywhere on the path.
    pub fn new(path: &Path, ends: [Waypoint; 2], seed: u64) -> Result<Self, Vec<SceneError>> {
        let [start, end] = ends.map(LookAt::from);
        let mut errors = Vec::new();

        let traveled = (end.position - start.position).length() + (end.target - start.target).length();
        let moves = path.frames == 1 || traveled >= SHORTEST_M;
        if !moves {
            errors.push(SceneError::Number {
                field: "path.end",
                value: traveled,
                limit: "at least 0.001 m from the start",
            });
        }
        let nearest = nearest_target(&start, &end);
        let is_clear = nearest >= SHORTEST_M;
        if !is_clear {
            errors.push(SceneError::Number {
                field: "path.end.target_m",
                value: nearest,
                limit: "at least 0.001 m from the camera, all the way",
            });
        }
        if errors.is_empty() {
            let path = *path;
            Ok(Self {
                start,
                end,
                path,
                seed,
            })
        } else {
            Err(errors)
        }
    }

    /// Number of frames.
    #[must_use]
    pub fn frames(&self) -> usize {
        self.path.frames
    }

    /// The pose of a frame, counted from 0. Later frames stay at the end.
    #[must_use]
    pub fn pose(&self, frame: usize) -> CameraPose {
        self.pose_at(frame as f64)
    }

    /// The pose at a fractional frame. Negative times stay at the start.
    #[must_use]
    pub fn pose_at(&self, frame: f64) -> CameraPose {
        let steps = self.path.frames.saturating_sub(1);
        let share = frame.max(0.0).min(steps as f64) / steps.max(1) as f64;
        let eye = interpolate(self.start.position, self.end.position, share);
        let target = interpolate(self.start.target, self.end.target, share);
        let still = held::pose([self.start, self.end], eye, target);
        let mut moved = still;
        for (i, axis) in [still.right, still.down, still.ahead].into_iter().enumerate() {
            let [shift, turn] = [i, 3 + i].map(|axis| self.swing(frame, axis as u64));
            moved.position_m = moved.position_m + axis * (self.path.sway_m * shift);
            let angle = self.path.sway_deg.to_radians() * turn;
            moved.right = turned(moved.right, axis, angle);
            moved.down = turned(moved.down, axis, angle);
            moved.ahead = turned(moved.ahead, axis, angle);
        }
        moved
    }

    /// Sway in -1..=1.
    fn swing(&self, frame: f64, axis: u64) -> f64 {
        let dice = Stream::stage(self.seed, "path/sway");
        let periods = [self.path.sway_frames, 0.37 * self.path.sway_frames];
        let [slow, fast] = [0, 1].map(|k| {
            let choice = 2 * k as u64;
            let period = periods[k] * (0.8 + 0.4 * dice.unit(axis, choice));
            libm::sin(TAU * (frame / period + dice.unit(axis, choice + 1)))
        });
        0.7 * slow + 0.3 * fast
    }
}

fn nearest_target(start: &LookAt, end: &LookAt) -> f64 {
    let first = start.target - start.position;
    let change = end.target - end.position - first;
    let square = change.dot(change);
    let share = (-first.dot(change) / square).clamp(0.0, 1.0);
    (first + change * if square > 0.0 { share } else { 0.0 }).length()
}

fn interpolate(a: DVec3, b: DVec3, share: f64) -> DVec3 {
    a + (b - a) * share
}

#[cfg(test)]
pub(crate) mod tests {
    use imaging::vector::vec3;

    use super::*;

    pub(crate) const STILL: Path = Path {
        frames: 1,
        frame: 0,
        start: None,
        end: None,
        sway_m: 0.0,
        sway_deg: 0.0,
        sway_frames: 40.0,
    };
    const START: Waypoint = Waypoint {
        position_m: [-2.0, -3.0, 1.0],
        target_m: [-2.0, 0.0, 1.0],
    };
    const END: Waypoint = Waypoint {
        position_m: [2.0, -3.0, 1.5],
        target_m: [2.0, 0.0, 1.0],
    };
    const SWAY: Path = Path {
        frames: 200,
        sway_m: 0.05,
        sway_deg: 1.72,
        ..STILL
    };

    pub(crate) fn straight(start: Waypoint, end: Waypoint, frames: usize) -> CameraPath {
        CameraPath::new(&Path { frames, ..STILL }, [start, end], 0).unwrap()
    }

    #[test]
    fn a_path_without_sway_is_a_straight_line_at_constant_speed() {
        let path = straight(START, END, 5);
        let (start, end) = (LookAt::from(START), LookAt::from(END));
        assert_eq!(path.pose(0).position_m, start.position);
        assert_eq!(path.pose(4).position_m, end.position);
        assert_eq!(path.pose(2).position_m, vec3(0.0, -3.0, 1.25));
        assert_eq!(path.pose(99), path.pose(4));
        assert_eq!(path.pose(0).ahead, vec3(0.0, 1.0, 0.0));
        assert_eq!(straight(START, END, 1).pose(0).position_m, start.position);
    }

    #[test]
    fn sway_is_smooth_small_and_of_its_seed() {
        let swaying = |seed: u64| CameraPath::new(&SWAY, [START, END], seed).unwrap();
        let (path, straight) = (swaying(9), straight(START, END, 200));
        let away = |frame: usize| path.pose(frame).position_m - straight.pose(frame).position_m;
        let mut most = 0.0f64;
        for frame in 0..200 {
            let (here, next) = (away(frame), away(frame + 1));
            most = most.max(here.length());
            assert!(here.length() <= 0.05 * 3f64.sqrt() + 1e-12);
            // Five periods of the fast sine in 40 frames: at most a few percent of the amplitude per frame.
            assert!((next - here).length() < 0.05 * 0.6, "frame {frame}");
            let pose = path.pose(frame);
            assert!(pose.ahead.dot(straight.pose(frame).ahead) > libm::cos(0.03 * 3.0));
            assert!(pose.right.cross(pose.down).dot(pose.ahead) > 1.0 - 1e-9);
        }
        assert!(most > 0.02);
        assert_eq!(path.pose(17), swaying(9).pose(17));
        assert_ne!(path.pose(17), swaying(0).pose(17));
    }

    #[test]
    fn everything_that_is_wrong_is_named_at_once() {
        let errors = CameraPath::new(&SWAY, [START, START], 0).unwrap_err();
        assert!(errors[0].to_string().contains("`path.end` is 0"), "{}", errors[0]);
        // The target passes through the camera half way.
        let behind = Waypoint {
            target_m: [2.0, -6.0, 1.5],
            ..END
        };
        let errors = CameraPath::new(&SWAY, [START, behind], 0).unwrap_err();
        assert_eq!(errors[0].field(), "path.end.target_m");
        let blind = Waypoint {
            target_m: START.position_m,
            ..START
        };
        let errors = CameraPath::new(&SWAY, [blind, blind], 0).unwrap_err();
        let fields: Vec<_> = errors.iter().map(SceneError::field).collect();
        assert_eq!(fields, ["path.end", "path.end.target_m"]);
        assert!(CameraPath::new(&STILL, [START, START], 0).is_ok());
    }
}
