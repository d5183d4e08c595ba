//! Features of a frame matched with the previous one, drawn over both.

use cli::exit::Failure;
use imaging::{Plane, Rgb8};
use quality::{Features, FrameFeatures, Match, Motion, match_features};
use spec::SceneRecord;

use super::shot::Shot;

/// A point is occluded if the visible surface is nearer by more than this share of its range.
const OCCLUSION_TOLERANCE: f64 = 0.02;
/// Columns between the two frames.
const GAP_PX: usize = 8;
const CORRECT: [u8; 3] = [40, 220, 80];
const WRONG: [u8; 3] = [255, 60, 50];

/// Matches between two pictures.
pub(super) struct Matched {
    /// Both pictures with a line for each match at the default threshold.
    pub(super) picture: Rgb8,
    /// At the default threshold, then at the adaptive one.
    pub(super) counts: [Count; 2],
}

/// Numbers of matches.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Count {
    pub(super) correct: usize,
    pub(super) all: usize,
}

/// Matches an artifact of a frame with that of the previous frame.
///
/// # Errors
/// A frame lacks the artifact, its range or its pose.
pub(super) fn match_shots(current: &Shot, previous: &Shot, kind: &str) -> Result<Matched, Failure> {
    let motion = true_motion(&View::new(current)?, &View::new(previous)?);
    let pictures = [current.picture(kind)?, previous.picture(kind)?];
    let [now, before] = pictures
        .each_ref()
        .map(|picture| FrameFeatures::find(picture, None));
    let mut picture = join(&pictures);
    let default = MatchSet::new(&now.default, &before.default, &motion);
    let adaptive = MatchSet::new(&now.adaptive, &before.adaptive, &motion);
    default.draw(&mut picture);
    let counts = [default.count(), adaptive.count()];
    Ok(Matched { picture, counts })
}

/// Ranges of a frame with its camera and pose.
struct View {
    range_m: Plane<f32>,
    scene: SceneRecord,
    world_from_camera: [[f64; 4]; 4],
}

impl View {
    fn new(shot: &Shot) -> Result<Self, Failure> {
        let posed = shot
            .scene()
            .and_then(|scene| Some((scene.clone(), scene.world_from_camera?)));
        let (scene, world_from_camera) = posed.ok_or_else(|| anyhow::anyhow!("a frame has no pose"))?;
        Ok(Self {
            range_m: shot.range_m()?,
            scene,
            world_from_camera,
        })
    }

    /// A pixel's surface point in the world.
    fn surface(&self, x: usize, y: usize) -> Option<[f64; 3]> {
        let range_m = f64::from(self.range_m.pixel(x, y));
        let ray = self.scene.intrinsics.ray(x as f64, y as f64).normalized();
        let seen = [ray.x * range_m, ray.y * range_m, ray.z * range_m, 1.0];
        let world = [0, 1, 2].map(|row| (0..4).map(|k| self.world_from_camera[row][k] * seen[k]).sum());
        (range_m > 0.0).then_some(world)
    }

    /// Picture position of a visible point of the world; the center of the first pixel is (0.5, 0.5).
    fn position(&self, world: [f64; 3]) -> Option<[f32; 2]> {
        let [right, down, ahead] = [0, 1, 2].map(|column| {
            let pose = &self.world_from_camera;
            (0..3)
                .map(|row| pose[row][column] * (world[row] - pose[row][3]))
                .sum::<f64>()
        });
        let camera = &self.scene.intrinsics;
        let (x, y) = (
            camera.focal_px * right / ahead + camera.cx,
            camera.focal_px * down / ahead + camera.cy,
        );
        let (width, height) = self.range_m.size();
        let (column, row) = (x.round(), y.round());
        let is_inside =
            ahead > 0.0 && (0.0..width as f64).contains(&column) && (0.0..height as f64).contains(&row);
        let visible_m = is_inside.then(|| self.range_m.pixel(column as usize, row as usize))?;
        let range_m = (right * right + down * down + ahead * ahead).sqrt();
        let is_visible = range_m <= f64::from(visible_m) * (1.0 + OCCLUSION_TOLERANCE);
        is_visible.then_some([(x + 0.5) as f32, (y + 0.5) as f32])
    }
}

fn true_motion(current: &View, previous: &View) -> Motion {
    let (width, height) = current.range_m.size();
    let positions = Plane::from_fn(width, height, |x, y| {
        let before = current.surface(x, y).and_then(|world| previous.position(world));
        before.unwrap_or([f32::NAN; 2])
    });
    Motion { positions }
}

/// The previous picture to the left of the current one.
fn join([current, previous]: &[Rgb8; 2]) -> Rgb8 {
    let (width, height) = (current.width(), current.height());
    Rgb8::from_fn(2 * width + GAP_PX, height, |x, y| match x {
        _ if x < width => previous.pixel(x, y),
        _ if x < width + GAP_PX => [0; 3],
        _ => current.pixel(x - width - GAP_PX, y),
    })
}

/// Matches of features, and the correct ones of them.
struct MatchSet<'a> {
    now: &'a Features,
    before: &'a Features,
    all: Vec<Match>,
    correct: Vec<Match>,
}

impl<'a> MatchSet<'a> {
    fn new(now: &'a Features, before: &'a Features, motion: &Motion) -> Self {
        let all = match_features(now, before);
        let correct = motion.correct_matches(now, before, &all);
        Self {
            now,
            before,
            all,
            correct,
        }
    }

    fn count(&self) -> Count {
        Count {
            correct: self.correct.len(),
            all: self.all.len(),
        }
    }

    /// Draws a line for each match between two joined pictures.
    fn draw(&self, picture: &mut Rgb8) {
        let offset = ((picture.width() - GAP_PX) / 2 + GAP_PX) as f32;
        for pair in &self.all {
            let start = &self.before.keypoints[pair.previous as usize];
            let end = &self.now.keypoints[pair.current as usize];
            let color = if self.correct.contains(pair) {
                CORRECT
            } else {
                WRONG
            };
            draw_line(picture, [start.x, start.y], [end.x + offset, end.y], color);
        }
    }
}

fn draw_line(picture: &mut Rgb8, from: [f32; 2], to: [f32; 2], color: [u8; 3]) {
    let (width, height) = (picture.width(), picture.height());
    let steps = (to[0] - from[0])
        .abs()
        .max((to[1] - from[1]).abs())
        .ceil()
        .max(1.0) as usize;
    for step in 0..=steps {
        let share = step as f32 / steps as f32;
        let [x, y] = [0, 1].map(|axis| (from[axis] + share * (to[axis] - from[axis])).max(0.0) as usize);
        let first = 3 * (y.min(height - 1) * width + x.min(width - 1));
        picture.data_mut()[first..first + 3].copy_from_slice(&color);
    }
}

#[cfg(test)]
mod tests {
    use imaging::geometry::Intrinsics;

    use super::*;

    /// A wall 4 m ahead of a camera with a focal length of 8 px.
    fn view(right_m: f64, wall_m: f64) -> View {
        let intrinsics = Intrinsics::centered(8.0, 17, 9);
        let range_m = Plane::from_fn(17, 9, |x, y| {
            (wall_m * intrinsics.ray(x as f64, y as f64).length()) as f32
        });
        let mut world_from_camera = [[0.0; 4]; 4];
        (0..4).for_each(|axis| world_from_camera[axis][axis] = 1.0);
        world_from_camera[0][3] = right_m;
        let scene = SceneRecord {
            world_from_camera: Some(world_from_camera),
            intrinsics,
            lens: None,
            instances: None,
            categories: None,
            visible: None,
            least_visibility: None,
            mean_visibility: None,
        };
        View {
            range_m,
            scene,
            world_from_camera,
        }
    }

    #[test]
    fn a_wall_moves_by_the_step_times_the_focal_length_over_its_distance() {
        let motion = true_motion(&view(0.5, 4.0), &view(0.0, 4.0));
        let [x, y] = motion.positions.pixel(5, 3);
        assert!((x - 6.5).abs() < 1e-4 && (y - 3.5).abs() < 1e-4, "{x} {y}");
        assert!(
            motion.positions.pixel(16, 3)[0].is_nan(),
            "outside the previous frame"
        );
        let occluded = true_motion(&view(0.5, 4.0), &view(0.0, 2.0));
        assert!(occluded.positions.data().iter().all(|[x, _]| x.is_nan()));
    }
}
