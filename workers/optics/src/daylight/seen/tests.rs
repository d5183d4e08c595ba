use imaging::rays::{Hit, Rays};
use imaging::vector::vec3;

use super::super::surface;
use super::directions::Directions;
use super::*;
use crate::range::is_hole;

/// A floor 1 m below a level camera and a ball above it.
struct Ball;

const FLOOR_Y: f64 = 1.0;
const MIDDLE: [f64; 3] = [0.2, 0.3, 4.0];
const RADIUS: f64 = 0.6;

impl Rays for Ball {
    fn hit(&self, origin: [f64; 3], direction: [f64; 3], from: f64, to: f64) -> Option<Hit> {
        let (o, d) = (DVec3::from(origin), DVec3::from(direction));
        let floor = (FLOOR_Y - o.y) / d.y;
        let floor = (floor >= from && floor <= to).then_some((floor, vec3(0.0, -1.0, 0.0), 1));
        let away = o + -DVec3::from(MIDDLE);
        let (half, rest) = (away.dot(d), away.dot(away) - RADIUS * RADIUS);
        let root = half * half - rest;
        let near = -half - root.max(0.0).sqrt();
        let ball = (root >= 0.0 && near >= from && near <= to)
            .then(|| (near, (away + d * near) * (1.0 / RADIUS), 2));
        let nearest = [floor, ball]
            .into_iter()
            .flatten()
            .min_by(|a, b| a.0.total_cmp(&b.0))?;
        Some(Hit {
            distance: nearest.0,
            normal: nearest.1.into(),
            object: nearest.2,
        })
    }
}

struct Scene {
    range: Plane<f32>,
    normals: [Plane<f32>; 3],
    objects: Plane<u16>,
    daylight: Daylight,
}

fn scene((width, height): (usize, usize)) -> Scene {
    let daylight = surface::tests::daylight((width, height), [0.0, -1.0, 0.0], 0.7, 6.0);
    let hit = |x: usize, y: usize| {
        let ray = daylight.gaze.camera.ray(x as f64, y as f64).normalized();
        Ball.hit([0.0; 3], ray.into(), 0.0, 40.0)
    };
    Scene {
        range: Plane::from_fn(width, height, |x, y| {
            hit(x, y).map_or(f32::NAN, |hit| hit.distance as f32)
        }),
        normals: [0, 1, 2].map(|i| {
            Plane::from_fn(width, height, |x, y| {
                hit(x, y).map_or(0.0, |hit| hit.normal[i] as f32)
            })
        }),
        objects: Plane::from_fn(width, height, |x, y| hit(x, y).map_or(0, |hit| hit.object as u16)),
        daylight,
    }
}

impl Scene {
    fn surfaces(&self) -> Surfaces<'_> {
        Surfaces {
            range: &self.range,
            normals: &self.normals,
            objects: Some(&self.objects),
        }
    }
}

const SIZES: [(usize, usize); 5] = [(1, 1), (3, 1), (1, 9), (65, 41), (96, 64)];
/// Its shadows are traced where they change.
const LARGE: (usize, usize) = (720, 480);

#[test]
fn the_ball_casts_the_shadow_of_the_reference() {
    for size in SIZES.into_iter().chain([LARGE]) {
        let scene = scene(size);
        let sun = scene.daylight.sun.unwrap();
        let exact = sunlit_reference(scene.surfaces(), &scene.daylight, &sun, &Ball);
        let fast = sunlit(scene.surfaces(), &scene.daylight, &sun, &Ball);
        let apart = exact
            .data()
            .iter()
            .zip(fast.data())
            .filter(|(a, b)| a != b)
            .count();
        // A ray may graze the ball.
        let share = if size == LARGE { 1000 } else { 100 };
        assert!(share * apart <= exact.data().len(), "{size:?}: {apart}");
        if size.0 > 60 {
            let floor = |lit: f32| {
                let pixels = exact.data().iter().zip(scene.objects.data());
                pixels.filter(|(v, object)| **v == lit && **object == 1).count()
            };
            assert!(
                floor(0.0) > 40 && floor(1.0) > 400,
                "{} {}",
                floor(0.0),
                floor(1.0)
            );
        }
    }
}

#[test]
fn less_of_the_sky_reaches_the_floor_under_the_ball_and_both_forms_agree() {
    for size in SIZES {
        let scene = scene(size);
        let attenuation = [0.51, 0.26, 0.27];
        let exact = access_reference(scene.surfaces(), &scene.daylight, attenuation, &Ball);
        let fast = access(scene.surfaces(), &scene.daylight, attenuation, &Ball);
        let pairs = exact.planes()[1].data().iter().zip(fast.planes()[1].data());
        let apart: Vec<f32> = pairs.map(|(a, b)| (a - b).abs()).collect();
        let mean = apart.iter().sum::<f32>() / apart.len() as f32;
        // Each of 16 rays is clear or not: between two points, one may change.
        let most = apart.iter().copied().fold(0.0, f32::max);
        assert!(mean < 0.02 && most < 0.35, "{size:?}: {mean} {most}");
        for (v, z) in exact.planes()[0].data().iter().zip(scene.range.data()) {
            assert!((0.0..=1.0).contains(v) && (!is_hole(*z) || *v == 1.0));
        }
        if size.0 > 60 {
            let least = exact.planes()[1].data().iter().copied().fold(1.0, f32::min);
            assert!(least < 0.7, "{least}");
        }
    }
}

#[test]
fn directions_are_unit_vectors_about_the_normal_with_the_mean_cosine_of_even_light() {
    let directions = Directions::new(64);
    for normal in [vec3(0.0, 0.0, 1.0), vec3(0.0, 0.0, -1.0), vec3(0.6, -0.48, 0.64)] {
        let mut mean = 0.0;
        for k in 0..64 {
            let v = directions.about(k, normal);
            assert!((v.length() - 1.0).abs() < 1e-12);
            mean += v.dot(normal) / 64.0;
        }
        assert!((mean - 2.0 / 3.0).abs() < 1e-3, "{mean}");
    }
}

/// The interpolated veil differs by no more in the mean, and by no more than [`MOST_VEIL_ERROR`] in 99 % of the pixels: values that
/// differ by 0.1 are interpolated, and a shadow narrower than the grid is missed.
const MEAN_VEIL_ERROR: f32 = 0.005;
const MOST_VEIL_ERROR: f32 = 0.1;

#[test]
fn the_veil_of_coarse_grids_agrees_with_that_of_every_pixel() {
    for size in [(1, 1), (3, 1), (1, 9), (48, 32), (96, 64), (321, 241), (640, 480)] {
        let scene = scene(size);
        let exact = veil_access_reference(&scene.range, &scene.daylight, &Ball);
        let fast = veil_access(&scene.range, &scene.daylight, &Ball);
        let pairs = exact.data().iter().zip(fast.data());
        let errors: Vec<f32> = pairs.map(|(a, b)| (a - b).abs()).collect();
        assert!(fast.data().iter().all(|v| (0.0..=1.0).contains(v)), "{size:?}");
        let mean = errors.iter().sum::<f32>() / errors.len() as f32;
        let large = errors.iter().filter(|error| **error > MOST_VEIL_ERROR).count();
        assert!(
            mean <= MEAN_VEIL_ERROR && 100 * large <= errors.len(),
            "{size:?}: {mean}, {large}"
        );
        if size.0 > 40 {
            let least = exact.data().iter().copied().fold(1.0, f32::min);
            assert!(least < 0.85, "{least}");
        }
    }
}

/// A wall across the view at this distance; an infinite distance means no wall.
struct Wall(f64);

impl Rays for Wall {
    fn hit(&self, origin: [f64; 3], direction: [f64; 3], from: f64, to: f64) -> Option<Hit> {
        let distance = (self.0 - origin[2]) / direction[2];
        (distance >= from && distance <= to).then_some(Hit {
            distance,
            normal: [0.0, 0.0, -1.0],
            object: 1,
        })
    }
}

/// Mean of the veil that remains before a wall.
fn mean_before_wall(meters: f64) -> f32 {
    let size = (96, 64);
    let daylight = surface::tests::daylight(size, [0.0, -1.0, 0.0], 0.7, 6.0);
    let range = Plane::from_fn(size.0, size.1, |x, y| {
        let ray = daylight.gaze.camera.ray(x as f64, y as f64).normalized();
        (meters / ray.z) as f32
    });
    let range = range.map(|&z| if z.is_finite() { z } else { f32::NAN });
    let access = veil_access(&range, &daylight, &Wall(meters));
    access.data().iter().sum::<f32>() / access.data().len() as f32
}

#[test]
fn open_water_keeps_its_veil_and_a_wall_darkens_it() {
    assert_eq!(mean_before_wall(f64::INFINITY), 1.0);
    let walls = [8.0, 3.0, 1.0].map(mean_before_wall);
    assert!(walls.is_sorted_by(|far, near| far > near), "{walls:?}");
    // A near wall fills the directions from which most light is scattered into the view.
    assert!(walls[0] < 0.999 && walls[2] > 0.05, "{walls:?}");
}
