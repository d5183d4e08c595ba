//! ViewCamera poses of single frames: drawn from the seed, with described values replacing drawn ones.

use imaging::vector::{DVec3, Vec3, vec3};
use spec::CameraView;

use super::chance::Choices;
use super::solid::Solid;
use super::tree::Tree;
use super::usual::{Heights, Usual, Viewpoint};
use super::{Site, SiteObject};
use crate::pose::LEAST_CLEARANCE_M;
use crate::{CameraPose, SceneError};

const PITCH_DEG: [f32; 2] = [-30.0, 40.0];
/// Minimum distance of a drawn camera from surfaces, m.
const CLEAR_M: f64 = 0.3;
/// Poses per elevation.
const TRIES: usize = 16;
/// Share of the difference between the drawn elevation and the family's that each round of tries keeps.
const LEVELING: [f64; 5] = [1.0, 0.75, 0.5, 0.25, 0.0];
/// Steps of a blocked camera towards its target.
const APPROACHES: usize = 20;
/// Columns and rows of rays that probe the inner part of an 80° frame.
const PROBES: [usize; 2] = [12, 8];
const HALF_FRAME: [f64; 2] = [0.7, 0.42];
/// Length of the probes, m.
const PROBE_M: f32 = 9.0;
/// Largest share of probes that may hit a structure, except in rooms.
const MOST_STRUCTURE: f64 = 0.7;

impl Viewpoint {
    pub(crate) fn looking(eye: DVec3, target: DVec3) -> Self {
        let way = target - eye;
        let flat = libm::hypot(way.x, way.y);
        Self {
            target,
            pitch_deg: libm::atan2(way.z, flat).to_degrees(),
            yaw_deg: libm::atan2(way.x, way.y).to_degrees(),
            height_m: eye.z,
            distance_m: way.length(),
        }
    }

    /// Unit vector of the line of sight.
    fn ahead(&self) -> DVec3 {
        let (rise, flat) = libm::sincos(self.pitch_deg.to_radians());
        let (sin, cos) = libm::sincos(self.yaw_deg.to_radians());
        vec3(flat * sin, flat * cos, rise)
    }

    fn eye(&self) -> DVec3 {
        let away = self.ahead() * self.distance_m;
        vec3(self.target.x - away.x, self.target.y - away.y, self.height_m)
    }

    pub(crate) fn aim(&self) -> DVec3 {
        self.eye() + self.ahead() * self.distance_m
    }

    pub(crate) fn pose(&self, roll: f64) -> CameraPose {
        CameraPose::looking(self.eye(), self.aim(), roll)
    }
}

/// The solids and objects around a view.
pub(crate) struct Obstacles<'a> {
    solids: &'a [Solid],
    objects: &'a [SiteObject],
    tree: Tree,
}

impl<'a> Obstacles<'a> {
    pub(crate) fn new(solids: &'a [Solid], objects: &'a [SiteObject]) -> Self {
        Self {
            solids,
            objects,
            tree: Tree::new(solids),
        }
    }

    fn clearance(&self, point: DVec3) -> f64 {
        f64::from(clearance(self.solids, point.as_f32()))
    }

    /// Whether structures cover at least `least` of the middle of a frame, and other things are visible too.
    fn shows_structure(&self, view: &Viewpoint, least: f64) -> bool {
        let pose = view.pose(0.0);
        let eye = pose.position_m.as_f32();
        let [across, down] = PROBES;
        let mut found = 0;
        for probe in 0..across * down {
            let right = HALF_FRAME[0] * center(probe % across, across);
            let below = HALF_FRAME[1] * center(probe / across, down);
            let heading = (pose.ahead + pose.right * right + pose.down * below).normalized();
            let met = self.tree.first_met(self.solids, eye, heading.as_f32(), PROBE_M);
            found += usize::from(met.is_some_and(|(_, number)| self.is_structure(number)));
        }
        let share = found as f64 / (across * down) as f64;
        let is_room = self.solids.iter().any(Solid::is_hollow);
        share >= least && (share <= MOST_STRUCTURE || is_room)
    }

    fn is_structure(&self, number: u16) -> bool {
        let object = self.solids[usize::from(number)].object;
        self.objects[usize::from(object)].category.is_structure()
    }
}

/// Center of one of `count` equal parts of -1..1.
fn center(part: usize, count: usize) -> f64 {
    (2 * part + 1) as f64 / count as f64 - 1.0
}

/// Distance of a point from the nearest solid and the ground, m; negative inside.
pub(crate) fn clearance(solids: &[Solid], point: Vec3) -> f32 {
    solids
        .iter()
        .map(|solid| solid.distance(point))
        .fold(point.z, f32::min)
}

impl Usual {
    /// The view of a description: the first clear pose of a fixed sequence that shows structures, else the first clear
    /// pose, else the nearest clear one on the way to the target.
    ///
    /// # Errors
    /// [`SceneError::View`] if every pose with the given values is blocked.
    pub(crate) fn choose(&self, stage: &Obstacles<'_>, given: &CameraView) -> Result<Viewpoint, SceneError> {
        let poses = self.poses(given);
        if let Some(view) = poses.iter().find(|view| self.is_good(stage, view)) {
            return Ok(*view);
        }
        if *given == CameraView::default() {
            return Ok(self.view);
        }
        let nearer = self.approach(given);
        let mut candidates = poses.iter().chain(&nearer);
        let found = candidates.find(|view| stage.clearance(view.eye()) >= LEAST_CLEARANCE_M);
        found
            .copied()
            .ok_or_else(|| refuse(given, stage.clearance(poses[0].eye())))
    }

    fn is_good(&self, stage: &Obstacles<'_>, view: &Viewpoint) -> bool {
        stage.clearance(view.eye()) >= CLEAR_M && stage.shows_structure(view, self.least_structure)
    }

    /// Candidate poses, several per elevation.
    fn poses(&self, given: &CameraView) -> Vec<Viewpoint> {
        let rounds = if given.pitch_deg.is_some() {
            1
        } else {
            LEVELING.len()
        };
        let rounds = LEVELING[..rounds].iter();
        rounds
            .flat_map(|&share| (0..TRIES).map(move |attempt| self.draw(attempt, share, given)))
            .collect()
    }

    /// Poses from the first candidate towards the target; empty if the distance is given.
    fn approach(&self, given: &CameraView) -> Vec<Viewpoint> {
        let steps = if given.distance_m.is_some() { 0 } else { APPROACHES };
        let first = self.draw(0, 1.0, given);
        (1..steps)
            .map(|step| Viewpoint {
                distance_m: first.distance_m * (1.0 - step as f64 / APPROACHES as f64),
                ..first
            })
            .collect()
    }

    /// A candidate pose; `share` is a value of [`LEVELING`].
    fn draw(&self, attempt: usize, share: f64, given: &CameraView) -> Viewpoint {
        let dice = self.dice.object(attempt);
        let drawn = f64::from(self.dice.uniform(0, PITCH_DEG[0], PITCH_DEG[1]));
        let pitch_deg = given
            .pitch_deg
            .unwrap_or(self.view.pitch_deg + (drawn - self.view.pitch_deg) * share);
        let turn_deg = draw_from(dice, 1, [-self.turn_deg, self.turn_deg]);
        let flat = self.view.distance_m * libm::cos(self.view.pitch_deg.to_radians());
        // Limit the distance of a steep camera, so that it stays above its base point.
        let slope = libm::cos(pitch_deg.to_radians()).max(0.5);
        let distance_m = given
            .distance_m
            .unwrap_or(flat * draw_from(dice, 2, self.stretch) / slope);
        let height_m = match self.heights {
            Heights::Camera(range) => draw_from(dice, 3, range),
            Heights::Target(range) => {
                draw_from(dice, 3, range) - distance_m * libm::sin(pitch_deg.to_radians())
            }
        };
        Viewpoint {
            target: self.view.target,
            pitch_deg,
            yaw_deg: given.yaw_deg.unwrap_or(self.view.yaw_deg + turn_deg),
            height_m: self.floor + given.height_m.unwrap_or(height_m),
            distance_m,
        }
    }
}

fn refuse(given: &CameraView, clearance_m: f64) -> SceneError {
    let fields = [
        ("view.distance_m", given.distance_m),
        ("view.height_m", given.height_m),
        ("view.yaw_deg", given.yaw_deg),
        ("view.pitch_deg", given.pitch_deg),
    ];
    let first = fields
        .into_iter()
        .find_map(|(field, value)| Some((field, value?)));
    let (field, value) = first.unwrap_or(("view", 0.0));
    SceneError::View {
        field,
        value,
        clearance_m,
    }
}

impl Site {
    pub(crate) fn look_from(&mut self, view: &Viewpoint) {
        self.lamp_m *= (view.distance_m / (self.target - self.pose.position_m).length()) as f32;
        self.pose = view.pose(self.usual.roll);
        self.target = view.aim();
    }
}

fn draw_from(dice: Choices, choice: u64, [low, high]: [f32; 2]) -> f64 {
    f64::from(dice.uniform(choice, low, high))
}
