//! A procedural world: its objects and their positions, independent of any camera.

use std::sync::OnceLock;

use imaging::geometry::Intrinsics;
use imaging::vector::DVec3;
use imaging::{Plane, Rgb};
use spec::{CameraView, Ground, Life, Path, SceneLighting, Waypoint};

use super::pose::LEAST_CLEARANCE_M;
use super::scene::Scene;
use crate::categories::Category;
use crate::labels::{InstanceInfo, Labels};
use crate::path::CameraPath;
use crate::site::solid::SolidShape;
use crate::site::tree::Tree;
use crate::site::view::{self, Obstacles};
use crate::site::{self, RenderOptions, RenderedRows, Site};
use crate::{CameraPose, FAMILIES, SceneError, SceneFamily, bottom, life};

/// Clearance of [`World::path`], m.
const CLEAR_M: f64 = 0.2;
/// Steps tested on each side of the usual pose.
const STEPS: usize = 60;
/// Height of piles above the water surface, m.
const FREEBOARD_M: f32 = 1.0;
/// Least vertical component of the axis of a pile that reaches the surface.
const LEAST_RISE: f32 = 0.9;
/// Least length of such a pile, m.
const LEAST_PILE_M: f32 = 3.0;
/// Minimum length of a path relative to its usual length.
const SHORTEST_SHARE: f64 = 0.02;

/// The world of a family and a seed; the same for all frames of a sequence.
///
/// Instances of a frame: 0 for open water, 1 for the ground, from 2 on the visible objects, numbered without gaps.
pub struct World {
    pub(crate) site: Site,
    /// Number of solids before the first of the biota.
    structures: usize,
    /// Of the solids; made for the first rays.
    tree: OnceLock<Tree>,
}

impl World {
    /// The world of a seed.
    ///
    /// # Errors
    /// [`SceneError::UnknownFamily`].
    pub fn new(family: &str, seed: u64) -> Result<Self, SceneError> {
        Self::filled(family, seed, None, None)
    }

    /// The world of a seed with biota and a described bottom. Without both it equals [`World::new`]'s. Structures, view
    /// and track are always the same, except for a buried pipe.
    ///
    /// # Errors
    /// [`SceneError::UnknownFamily`].
    pub fn filled(
        family: &str,
        seed: u64,
        life: Option<&Life>,
        ground: Option<&Ground>,
    ) -> Result<Self, SceneError> {
        let known = SceneFamily::parse(family).ok_or_else(|| SceneError::UnknownFamily {
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
        Ok(Self {
            site,
            structures,
            tree: OnceLock::new(),
        })
    }

    /// The ground ends this far from a camera, m. No structure is that far from the paths through it.
    pub const FAR_M: f64 = site::FAR_M as f64;

    /// Mean reflectance of the ground, at z = 0.
    #[must_use]
    pub fn ground_reflectance(&self) -> [f64; 3] {
        self.site.objects[0].finish.base.map(f64::from)
    }

    /// Moves the camera of a single frame: given values replace those drawn from the seed, the others are redrawn to
    /// fit. Growth stays at the positions found from the seed's view.
    ///
    /// # Errors
    /// [`SceneError::View`] if every camera with these values is too close to a surface.
    pub fn set_view(&mut self, view: &CameraView) -> Result<(), SceneError> {
        let stage = Obstacles::new(&self.site.solids[..self.structures], &self.site.objects);
        let chosen = self.site.usual.choose(&stage, view)?;
        self.site.look_from(&chosen);
        Ok(())
    }

    /// Extends piles beyond a water surface at this height above the bottom, m, within the reach of cameras.
    pub fn raise_piles(&mut self, surface_m: f64) {
        self.tree = OnceLock::new();
        let top = surface_m.min(self.site.pose.position_m.z + f64::from(site::FAR_M)) as f32 + FREEBOARD_M;
        for solid in &mut self.site.solids[..self.structures] {
            let is_pile = self.site.objects[usize::from(solid.object)].category == Category::Pile;
            let SolidShape::Tube(tube) = &mut solid.shape else {
                continue;
            };
            let (foot, axis) = (solid.pose.origin, solid.pose.axes[2]);
            // Collars are part of a pile too, but short.
            if is_pile && axis.z > LEAST_RISE && tube.length > LEAST_PILE_M {
                tube.length = tube.length.max((top - foot.z) / axis.z);
            }
        }
    }

    /// The hierarchy of the solids.
    pub(crate) fn tree(&self) -> &Tree {
        self.tree.get_or_init(|| Tree::new(&self.site.solids))
    }

    /// The pose of a single frame.
    #[must_use]
    pub fn pose(&self) -> CameraPose {
        self.site.pose
    }

    /// The target point of a single frame's camera, m.
    #[must_use]
    pub fn target(&self) -> DVec3 {
        self.site.target
    }

    /// Distance in meters of a point from the nearest surface, negative inside a solid or under the ground. Near
    /// stones, pits and round shapes it is a lower bound. Growth, ropes, animals and bubbles do not count.
    #[must_use]
    pub fn clearance(&self, point: DVec3) -> f64 {
        f64::from(view::clearance(
            &self.site.solids[..self.structures],
            point.as_f32(),
        ))
    }

    /// The path of a camera: between the waypoints of the description, or through the usual position past the site
    /// until something blocks it. `seed` is that of the sway.
    ///
    /// # Errors
    /// Those of [`CameraPath::new`].
    pub fn path(&self, path: &Path, seed: u64) -> Result<CameraPath, Vec<SceneError>> {
        let ends = path.start.zip(path.end);
        let (start, end) = ends.unwrap_or_else(|| self.usual_ends(path.sway_m));
        CameraPath::new(path, [start, end], seed)
    }

    fn usual_ends(&self, sway_m: f64) -> (Waypoint, Waypoint) {
        let (eye, target, travel) = (self.site.pose.position_m, self.site.target, self.site.travel);
        let room = CLEAR_M + 2.0 * sway_m;
        // Both directions from the usual pose, until something is near.
        let [mut first, mut last] = [-1.0, 1.0].map(|direction| {
            let steps = (1..=STEPS)
                .take_while(|&step| self.clearance(eye + travel * travel_share(direction, step)) >= room)
                .count();
            travel_share(direction, steps)
        });
        if last - first < SHORTEST_SHARE {
            (first, last) = (-0.5 * SHORTEST_SHARE, 0.5 * SHORTEST_SHARE);
        }
        let [first, last] = [first, last].map(|share| Waypoint {
            position_m: (eye + travel * share).into(),
            target_m: (target + travel * share).into(),
        });
        (first, last)
    }

    /// Checks that a camera on the path stays clear of surfaces, in at most 1000 of its frames.
    ///
    /// # Errors
    /// [`SceneError::Blocked`] with the first blocked frame.
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

    /// Renders the view of a camera. Without width or height the frame is empty.
    #[must_use]
    pub fn render(&self, pose: &CameraPose, size: (usize, usize), intrinsics: &Intrinsics) -> Scene {
        let picture = site::render(
            &self.site,
            pose,
            size,
            intrinsics,
            0..size.1,
            RenderOptions::default(),
        );
        scene(picture, size, intrinsics).0
    }

    /// Renders reflectance and normals of a camera's view: 0.02–0.8, and 0 in open water, without the site's light.
    /// Labels are optional.
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

    /// [`World::render`] with labels: the same scene, bit for bit, in slightly more time.
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
        let wanted = RenderOptions {
            reflectance: light == SceneLighting::Water,
            surfaces: true,
        };
        let mut picture = site::render(&self.site, pose, size, intrinsics, 0..size.1, wanted);
        let surfaces = picture.labels.take().expect("labels were requested");
        let (scene, shown) = scene(picture, size, intrinsics);
        let instances = scene
            .instances
            .as_ref()
            .expect("procedural scenes have instances");
        let labels = Labels::procedural(surfaces, instances, &self.describe(&shown), *pose, *intrinsics);
        (scene, labels)
    }

    /// Descriptions of the instances from 1 on, by their objects in ascending order.
    fn describe(&self, shown: &[u16]) -> Vec<InstanceInfo> {
        let objects = shown.iter().map(|&object| self.site.objects[usize::from(object)]);
        objects
            .map(|object| InstanceInfo {
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
fn scene(
    picture: RenderedRows,
    (width, height): (usize, usize),
    intrinsics: &Intrinsics,
) -> (Scene, Vec<u16>) {
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

/// Renumbers visible objects without gaps, keeping their order; the ground keeps 1. Returns the objects by their new
/// numbers, from 1 on.
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

fn travel_share(direction: f64, steps: usize) -> f64 {
    direction * 0.5 * steps as f64 / STEPS as f64
}

#[cfg(test)]
mod tests;
