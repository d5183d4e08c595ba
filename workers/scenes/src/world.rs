//! A procedural world: its objects and their places, independent of any camera.

use imaging::geometry::Intrinsics;
use imaging::vector::DVec3;
use imaging::{Plane, Rgb};
use spec::{CameraView, Ground, Life, Path, SceneLighting, Waypoint};

use crate::categories::Category;
use crate::labels::{Labels, Shown};
use crate::path::CameraPath;
use crate::site::solid::Shape;
use crate::site::view::{self, Stage};
use crate::site::{self, Picture, Site, Wanted};
use crate::{CameraPose, FAMILIES, Family, LEAST_CLEARANCE_M, Scene, SceneError};
use crate::{bottom, life};

/// What [`World::path`] keeps free, m.
const CLEAR_M: f64 = 0.2;
/// Places tested on each side of the usual pose.
const STEPS: usize = 60;
/// Height of piles above the surface of the sea, m.
const FREEBOARD_M: f32 = 1.0;
/// Least vertical component of the axis of a pile that reaches the surface.
const LEAST_RISE: f32 = 0.9;
/// Least length of such a pile, m.
const LEAST_PILE_M: f32 = 3.0;
/// A path is no shorter than this share of its usual length.
const SHORTEST_SHARE: f64 = 0.02;

/// The world of a family and a seed. It does not change between the frames of a sequence.
///
/// Instances of a frame: 0 where nothing is met, 1 the ground, from 2 on the objects in view, numbered without gaps.
pub struct World {
    pub(crate) site: Site,
    /// How many solids, the first ones, are no life.
    structures: usize,
}

impl World {
    /// The world of a seed.
    ///
    /// # Errors
    /// [`SceneError::UnknownFamily`].
    pub fn new(family: &str, seed: u64) -> Result<Self, SceneError> {
        Self::filled(family, seed, None, None)
    }

    /// The world of a seed with life, and with what is asked of its bottom. Without both it is [`World::new`]'s; structures, view
    /// and way are the same in any case, but for a pipe that is to be buried.
    ///
    /// # Errors
    /// [`SceneError::UnknownFamily`].
    pub fn filled(
        family: &str,
        seed: u64,
        life: Option<&Life>,
        ground: Option<&Ground>,
    ) -> Result<Self, SceneError> {
        let known = Family::parse(family).ok_or_else(|| SceneError::UnknownFamily {
            family: family.to_owned(),
            known: FAMILIES.join(", "),
        })?;
        let burial = ground.and_then(|ground| ground.burial);
        let mut site = (known.site)(seed, burial.map(|share| share as f32));
        if let Some(ground) = ground {
            bottom::dig(&mut site, ground);
        }
        let structures = site.solids.len();
        if let Some(life) = life {
            life::settle(&mut site, life, seed);
        }
        Ok(Self { site, structures })
    }

    /// Moves the camera of a single frame: the given values replace those drawn from the seed, the others are drawn again to fit.
    /// Growth stays where the seed's own view finds it.
    ///
    /// # Errors
    /// [`SceneError::View`] if every camera with these values is too close to a surface.
    pub fn set_view(&mut self, view: &CameraView) -> Result<(), SceneError> {
        let stage = Stage::new(&self.site.solids[..self.structures], &self.site.objects);
        let chosen = self.site.usual.choose(&stage, view)?;
        self.site.look_from(&chosen);
        Ok(())
    }

    /// Extends piles beyond the surface of the sea at this height above the bottom, m, as far as a camera can see them.
    pub fn raise_piles(&mut self, surface_m: f64) {
        let top = surface_m.min(self.site.pose.position_m.z + f64::from(site::FAR_M)) as f32 + FREEBOARD_M;
        for solid in &mut self.site.solids[..self.structures] {
            let is_pile = self.site.objects[usize::from(solid.object)].category == Category::Pile;
            let Shape::Tube(tube) = &mut solid.shape else {
                continue;
            };
            let (foot, axis) = (solid.pose.origin, solid.pose.axes[2]);
            // Collars are piles too, but short.
            if is_pile && axis.z > LEAST_RISE && tube.length > LEAST_PILE_M {
                tube.length = tube.length.max((top - foot.z) / axis.z);
            }
        }
    }

    /// The pose of a single frame.
    #[must_use]
    pub fn pose(&self) -> CameraPose {
        self.site.pose
    }

    /// The point that the camera of a single frame looks at, in meters.
    #[must_use]
    pub fn target(&self) -> DVec3 {
        self.site.target
    }

    /// Distance in meters of a point from the nearest surface, below 0 inside a solid or under the ground. Near stones, pits and
    /// round things it may be less than the true distance, never more; growth, ropes, animals and bubbles do not count.
    #[must_use]
    pub fn clearance(&self, point: DVec3) -> f64 {
        f64::from(view::clearance(
            &self.site.solids[..self.structures],
            point.as_f32(),
        ))
    }

    /// The path of a camera: between the waypoints of the description, or past the site, through the usual position along
    /// what there is to see, as long as nothing is in the way. `seed` is that of the sway.
    ///
    /// # Errors
    /// [`CameraPath::new`]'s.
    pub fn path(&self, path: &Path, seed: u64) -> Result<CameraPath, Vec<SceneError>> {
        let ends = path.start.zip(path.end);
        let (start, end) = ends.unwrap_or_else(|| self.usual_ends(path.sway_m));
        CameraPath::new(path, [start, end], seed)
    }

    fn usual_ends(&self, sway_m: f64) -> (Waypoint, Waypoint) {
        let (eye, target, travel) = (self.site.pose.position_m, self.site.target, self.site.travel);
        let room = CLEAR_M + 2.0 * sway_m;
        // Both ways from the usual pose, until something is near.
        let free = |direction: f64| {
            let share = |steps: usize| direction * 0.5 * steps as f64 / STEPS as f64;
            let clear = |&step: &usize| self.clearance(eye + travel * share(step)) >= room;
            share((1..=STEPS).take_while(clear).count())
        };
        let (mut first, mut last) = (free(-1.0), free(1.0));
        if last - first < SHORTEST_SHARE {
            (first, last) = (-0.5 * SHORTEST_SHARE, 0.5 * SHORTEST_SHARE);
        }
        let waypoint = |share: f64| Waypoint {
            position_m: (eye + travel * share).into(),
            target_m: (target + travel * share).into(),
        };
        (waypoint(first), waypoint(last))
    }

    /// Checks that a camera on the path stays clear of everything, in at most 1000 of its frames.
    ///
    /// # Errors
    /// [`SceneError::Blocked`], naming the first such frame.
    pub fn check(&self, path: &CameraPath) -> Result<(), SceneError> {
        let stride = path.frames().div_ceil(1000);
        for frame in (0..path.frames()).step_by(stride) {
            let distance_m = self.clearance(path.pose(frame).position_m);
            if distance_m < LEAST_CLEARANCE_M {
                return Err(SceneError::Blocked { frame, distance_m });
            }
        }
        Ok(())
    }

    /// What a camera of the given pose, frame size and intrinsics sees. Without width or height the frame is empty.
    #[must_use]
    pub fn render(&self, pose: &CameraPose, size: (usize, usize), intrinsics: &Intrinsics) -> Scene {
        let picture = site::render(&self.site, pose, size, intrinsics, 0..size.1, Wanted::default());
        scene(picture, size, intrinsics).0
    }

    /// The reflectance of what a camera sees, with normals: 0.02-0.8, and 0 where nothing is met. Nothing of the site's own light is
    /// in it. With labels if they are asked for.
    #[must_use]
    pub fn render_reflectance(
        &self,
        pose: &CameraPose,
        size: (usize, usize),
        intrinsics: &Intrinsics,
        labeled: bool,
    ) -> (Scene, Option<Labels>) {
        let (mut scene, labels) = self.with_surfaces(SceneLighting::Water, pose, size, intrinsics);
        scene.normals = labels.surfaces.as_ref().map(|surfaces| surfaces.normals.clone());
        (scene, labeled.then_some(labels))
    }

    /// [`World::render`] with labels: the same scene, bit for bit, in somewhat more time.
    #[must_use]
    pub fn render_labeled(
        &self,
        pose: &CameraPose,
        size: (usize, usize),
        intrinsics: &Intrinsics,
    ) -> (Scene, Labels) {
        self.with_surfaces(SceneLighting::InAir, pose, size, intrinsics)
    }

    fn with_surfaces(
        &self,
        light: SceneLighting,
        pose: &CameraPose,
        size: (usize, usize),
        intrinsics: &Intrinsics,
    ) -> (Scene, Labels) {
        let wanted = Wanted {
            reflectance: light == SceneLighting::Water,
            surfaces: true,
        };
        let mut picture = site::render(&self.site, pose, size, intrinsics, 0..size.1, wanted);
        let surfaces = picture.labels.take().expect("labels were asked for");
        let (scene, shown) = scene(picture, size, intrinsics);
        let instances = scene
            .instances
            .as_ref()
            .expect("procedural scenes have instances");
        let labels = Labels::procedural(surfaces, instances, &self.describe(&shown), *pose, *intrinsics);
        (scene, labels)
    }

    /// What the instances from 1 on are, by their objects in ascending order.
    fn describe(&self, shown: &[u16]) -> Vec<Shown> {
        let objects = shown.iter().map(|&object| self.site.objects[usize::from(object)]);
        objects
            .map(|object| Shown {
                category: object.category,
                host: object
                    .host
                    .and_then(|host| shown.binary_search(&host).ok())
                    .map(|at| at as u16 + 1),
            })
            .collect()
    }
}

/// A scene, and the object of each instance from 1 on.
fn scene(picture: Picture, (width, height): (usize, usize), intrinsics: &Intrinsics) -> (Scene, Vec<u16>) {
    let plane = |data| Plane::new(width, height, data).expect("one sample for each pixel");
    let mut instances = picture.objects;
    let shown = renumber(&mut instances);
    let scene = Scene {
        radiance: Rgb::new(picture.bands.map(plane)).expect("three planes of one frame"),
        range: Some(plane(picture.range)),
        instances: Some(Plane::new(width, height, instances).expect("one instance for each pixel")),
        intrinsics: Some(*intrinsics),
        normals: None,
    };
    (scene, shown)
}

/// Numbers the objects in view without gaps, in the order of their own numbers; the ground keeps 1. Returns the objects by
/// their new numbers, from 1 on.
fn renumber(instances: &mut [u16]) -> Vec<u16> {
    let most = instances.iter().copied().max().unwrap_or(0);
    let mut numbers = vec![0u16; usize::from(most) + 2];
    instances.iter().for_each(|&id| numbers[usize::from(id)] = 1);
    numbers[1] = 1;
    let mut shown = Vec::new();
    for object in 1..numbers.len() {
        if numbers[object] != 0 {
            shown.push(object as u16 - 1);
            numbers[object] = shown.len() as u16;
        }
    }
    numbers[0] = 0;
    let ids = instances.iter_mut();
    ids.for_each(|id| *id = numbers[usize::from(*id)]);
    shown
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::FAMILIES;
    use crate::path::tests::{STILL, straight};
    use crate::site::solid::Solid;

    const SEEDS: std::ops::Range<u64> = 0..24;

    fn frame(family: &str, seed: u64, width: usize, height: usize) -> (World, CameraPose, Intrinsics, Scene) {
        let world = World::new(family, seed).unwrap();
        let lens = Intrinsics::centered(0.6 * width as f64, width, height);
        let pose = world.pose();
        let scene = world.render(&pose, (width, height), &lens);
        (world, pose, lens, scene)
    }

    #[test]
    fn every_size_and_seed_gives_finite_light_that_is_never_negative() {
        for family in FAMILIES {
            for (width, height) in [(1, 1), (3, 2), (97, 61)] {
                for seed in SEEDS {
                    let (.., scene) = frame(family, seed, width, height);
                    assert_eq!(scene.radiance.size(), (width, height));
                    let light = scene.radiance.planes().iter().flat_map(|plane| plane.data());
                    assert!(
                        light.into_iter().all(|v| v.is_finite() && *v >= 0.0),
                        "{family} {seed}"
                    );
                }
            }
        }
    }

    #[test]
    fn the_same_seed_is_the_same_scene_and_another_one_is_not() {
        for family in FAMILIES {
            assert_eq!(frame(family, 5, 64, 41).3, frame(family, 5, 64, 41).3);
            assert_ne!(
                frame(family, 5, 64, 41).3.radiance,
                frame(family, 6, 64, 41).3.radiance
            );
        }
    }

    #[test]
    fn rows_do_not_depend_on_the_band_that_they_are_rendered_in() {
        for family in FAMILIES {
            for seed in [1, 8] {
                let (world, pose, lens, scene) = frame(family, seed, 97, 61);
                for bands in [2, 3, 61] {
                    let mut radiance = [const { Vec::new() }; 3];
                    let mut range = Vec::new();
                    for band in 0..bands {
                        let rows = 61 * band / bands..61 * (band + 1) / bands;
                        let part = site::render(&world.site, &pose, (97, 61), &lens, rows, Wanted::default());
                        radiance
                            .iter_mut()
                            .zip(part.bands)
                            .for_each(|(all, part)| all.extend(part));
                        range.extend(part.range);
                    }
                    let whole = scene.radiance.planes();
                    assert!((0..3).all(|c| whole[c].data() == radiance[c]), "{family} {seed}");
                    assert!(scene.range.as_ref().unwrap().data() == range);
                }
            }
        }
    }

    #[test]
    fn paths_are_clear_and_the_world_stays_as_it_is() {
        let path = Path {
            frames: 60,
            sway_m: 0.04,
            sway_deg: 1.1,
            ..STILL
        };
        for family in FAMILIES {
            let mut shortest = f64::INFINITY;
            for seed in SEEDS {
                let world = World::new(family, seed).unwrap();
                let path = world.path(&path, 3).unwrap();
                assert_eq!(world.check(&path), Ok(()), "{family} {seed}");
                let (first, last) = (path.pose(0).position_m, path.pose(59).position_m);
                shortest = shortest.min((last - first).length());
            }
            assert!(shortest > 0.2, "{family}: {shortest}");
        }
    }

    #[test]
    fn piles_reach_beyond_the_surface_and_nothing_below_moves() {
        const SURFACE_M: f64 = 25.0;
        let mut raised = 0;
        for seed in SEEDS {
            let bare = World::new("structure", seed).unwrap();
            let mut world = World::new("structure", seed).unwrap();
            world.raise_piles(SURFACE_M);
            assert_eq!(bare.pose(), world.pose());
            for (before, after) in bare.site.solids.iter().zip(&world.site.solids) {
                let top = |solid: &Solid| solid.corners()[4].z;
                assert_eq!(before.pose, after.pose);
                if top(before) != top(after) {
                    raised += 1;
                    assert!(top(before) < top(after) && f64::from(top(after)) > SURFACE_M);
                }
            }
        }
        assert!(raised > 20, "{raised}");
    }

    #[test]
    fn a_path_through_something_is_refused() {
        let world = World::new("pipeline", 3).unwrap();
        let [x, y, _]: [f64; 3] = world.target().into();
        let [start, through] = [3.0, -1.0].map(|height| Waypoint {
            position_m: [x, y, height],
            target_m: [x, y + 1.0, height],
        });
        let path = straight(start, through, 101);
        let error = world.check(&path).unwrap_err();
        assert!(
            matches!(error, SceneError::Blocked { frame: 10..=90, .. }),
            "{error}"
        );
    }

    #[test]
    fn instances_have_no_gaps_and_nothing_is_where_there_is_no_range() {
        for family in FAMILIES {
            for seed in SEEDS {
                let (.., scene) = frame(family, seed, 96, 62);
                let (instances, range) = (scene.instances.unwrap(), scene.range.unwrap());
                let most = *instances.data().iter().max().unwrap();
                assert!(most >= 2, "{family} {seed} shows no structure");
                assert!(
                    (2..=most).all(|id| instances.data().contains(&id)),
                    "{family} {seed}"
                );
                let mut pixels = instances.data().iter().zip(range.data());
                assert!(
                    pixels.all(|(&id, z)| (id == 0) == z.is_infinite()),
                    "{family} {seed}"
                );
            }
        }
    }
}
