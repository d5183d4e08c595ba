//! Assembles the solids of a site.

use imaging::vector::{Vec3, vec3};
use spec::CameraView;

use super::chance::Choices;
use super::finish::{JointPattern, Material, SurfaceFinish};
use super::pose::{Pose, UP, horizontal, up};
use super::solid::{Ellipsoid, Ring, Solid, SolidBox, SolidShape, Stone, Tube};
pub(crate) use super::usual::Heights;
use super::usual::{Usual, Viewpoint};
use super::view::{Obstacles, clearance};
use super::{Site, SiteObject};
use crate::categories::Category;

/// Minimum distance of a camera from surfaces, m.
const CLEAR_M: f32 = 0.3;

/// Collects solids. Parts of one object share a number and a finish.
pub(crate) struct SiteBuilder {
    seed: u64,
    family: &'static str,
    pub(crate) dice: Choices,
    solids: Vec<Solid>,
    objects: Vec<SiteObject>,
    current: u16,
}

/// The usual view of a site and its light.
pub(crate) struct SiteView {
    pub(crate) eye: Vec3,
    pub(crate) target: Vec3,
    pub(crate) roll: f32,
    /// Track past the site, m.
    pub(crate) travel: Vec3,
    pub(crate) lamp_m: f32,
    pub(crate) ambient: f32,
    /// Height of the bottom, m; in open water a level below the site.
    pub(crate) floor: f32,
    pub(crate) heights: Heights,
    /// Horizontal distances of drawn cameras relative to that of `eye`.
    pub(crate) stretch: [f32; 2],
    /// Largest rotation of drawn cameras from this view, degrees.
    pub(crate) turn_deg: f32,
    /// Minimum share of structures in the middle of a drawn frame.
    pub(crate) least_structure: f64,
}

impl SiteBuilder {
    /// An empty site on a seabed.
    pub(crate) fn new(seed: u64, family: &'static str) -> Self {
        let dice = Choices::new(seed, &format!("{family}/site"));
        let ground = SiteObject {
            finish: SurfaceFinish::new(Material::Sand, Choices::new(seed, family).object(1)),
            category: Category::Seabed,
            host: None,
        };
        Self {
            seed,
            family,
            dice,
            solids: Vec::new(),
            objects: vec![ground],
            current: 0,
        }
    }

    /// A builder that continues the object numbers of a site, with independent choices.
    pub(crate) fn from_site(site: &Site, seed: u64, family: &'static str) -> Self {
        Self {
            seed,
            family,
            dice: Choices::new(seed, &format!("{family}/site")),
            solids: Vec::new(),
            objects: site.objects.clone(),
            current: 0,
        }
    }

    /// Number of added solids.
    pub(crate) fn count(&self) -> usize {
        self.solids.len()
    }

    /// The added solids, and all objects.
    pub(crate) fn added(self) -> (Vec<Solid>, Vec<SiteObject>) {
        (self.solids, self.objects)
    }

    /// Choices for a topic of this site.
    pub(crate) fn dice_for(&self, topic: &str) -> Choices {
        Choices::new(self.seed, &format!("{}/{topic}", self.family))
    }

    pub(crate) fn site(self, view: &SiteView) -> Site {
        let (eye, target) = (self.clear_eye(view).as_f64(), view.target.as_f64());
        let usual = Usual {
            dice: self.dice_for("view"),
            view: Viewpoint::looking(eye, target),
            roll: f64::from(view.roll),
            floor: f64::from(view.floor),
            heights: view.heights,
            least_structure: view.least_structure,
            stretch: view.stretch,
            turn_deg: view.turn_deg,
        };
        let mut site = Site {
            solids: self.solids,
            objects: self.objects,
            pits: Vec::new(),
            pose: usual.view.pose(usual.roll),
            target,
            usual,
            travel: view.travel.as_f64(),
            lamp_m: view.lamp_m,
            ambient: view.ambient,
        };
        let chosen = usual.choose(
            &Obstacles::new(&site.solids, &site.objects),
            &CameraView::default(),
        );
        if let Ok(chosen) = chosen {
            site.look_from(&chosen);
        }
        site
    }

    /// The eye of a view, moved back until it is clear.
    fn clear_eye(&self, view: &SiteView) -> Vec3 {
        let back = (view.eye - view.target).normalized();
        let mut eye = view.eye;
        for _ in 0..24 {
            if clearance(&self.solids, vec3(eye.x, eye.y, eye.z.max(CLEAR_M))) >= CLEAR_M {
                break;
            }
            eye = eye + back * 0.15;
            eye.z = eye.z.max(CLEAR_M);
        }
        eye
    }

    /// A bolted flange pair around a pipe; `along` is a unit vector.
    pub(crate) fn flange(&mut self, place: Vec3, along: Vec3, radius: f32) {
        self.object(Material::Steel, Category::Fitting);
        for side in [-0.075, 0.075] {
            let middle = place + along * side;
            self.tube(middle - along * 0.05, middle + along * 0.05, radius * 1.45);
        }
        let pose = Pose::pointing(place, place + along, 0.0);
        for bolt in 0..14 {
            let (sin, cos) = libm::sincosf(bolt as f32 * 0.4488);
            let out = (pose.axes[0] * cos + pose.axes[1] * sin) * (radius * 1.24);
            self.tube(place - along * 0.19 + out, place + along * 0.19 + out, 0.028);
        }
    }

    /// Begins an object.
    pub(crate) fn object(&mut self, material: Material, category: Category) {
        let dice = self.dice_for("finish").object(self.objects.len());
        self.object_of(SurfaceFinish::new(material, dice), category);
    }

    /// Begins an object with a given finish.
    pub(crate) fn object_of(&mut self, finish: SurfaceFinish, category: Category) {
        self.push(finish, category, None);
    }

    /// Begins growth on an object.
    pub(crate) fn growth_on(&mut self, host: u16, finish: SurfaceFinish) {
        self.push(finish, Category::Growth, Some(host));
    }

    fn push(&mut self, finish: SurfaceFinish, category: Category, host: Option<u16>) {
        self.objects.push(SiteObject {
            finish,
            category,
            host,
        });
        self.current = self.objects.len() as u16 - 1;
    }

    pub(crate) fn put(&mut self, form: impl Into<SolidShape>, pose: Pose) {
        self.solids.push(Solid {
            shape: form.into(),
            pose,
            object: self.current,
        });
    }

    pub(crate) fn tube(&mut self, a: Vec3, b: Vec3, radius: f32) {
        let length = (b - a).length();
        self.put(Tube { radius, length }, Pose::pointing(a, b, 0.0));
    }

    pub(crate) fn block(&mut self, center: Vec3, half: Vec3, yaw: f32) {
        self.put(SolidBox { half }, Pose::upright(center, yaw));
    }

    pub(crate) fn ball(&mut self, center: Vec3, radii: Vec3, yaw: f32) {
        self.put(Ellipsoid { radii }, Pose::upright(center, yaw));
    }

    /// A bend of a torus about `axis` through the center, its middle towards `toward`.
    pub(crate) fn ring(&mut self, ring: Ring, center: Vec3, axis: Vec3, toward: Vec3) {
        let z = axis.normalized();
        let y = (toward - z * toward.dot(z)).normalized();
        let axes = [y.cross(z), y, z];
        self.put(ring, Pose { origin: center, axes });
    }

    /// A mound of the ground, `height` meters high and `radius` meters wide where it meets the ground under `place`.
    pub(crate) fn mound(&mut self, place: Vec3, radius: f32, height: f32) {
        let object = std::mem::replace(&mut self.current, 0);
        let ball = (radius * radius + height * height) / (2.0 * height);
        self.ball(vec3(place.x, place.y, height - ball), vec3(ball, ball, ball), 0.0);
        self.current = object;
    }

    /// A ladder of two rails and rungs every third of a meter, from `foot` along `up`; `side` is half its width.
    pub(crate) fn ladder(&mut self, foot: Vec3, up: Vec3, side: Vec3, rungs: usize) {
        self.object(Material::Steel, Category::Ladder);
        let length = 0.33 * rungs as f32 + 0.3;
        for side in [-side, side] {
            self.tube(foot + side, foot + side + up * length, 0.032);
        }
        for rung in 0..rungs {
            let height = up * (0.3 + 0.33 * rung as f32);
            self.tube(foot - side + height, foot + side + height, 0.018);
        }
    }

    /// Stones scattered within `reach` meters of a point along x and y.
    pub(crate) fn stones(&mut self, count: usize, place: Vec3, reach: [f32; 2], sizes: [f32; 2]) {
        let first = self.objects.len();
        for i in 0..count {
            let dice = self.dice_for("stone").object(first + i);
            self.object(Material::Stone, Category::Stone);
            // Most are small.
            let share = dice.uniform(0, 0.0, 1.0);
            let size = sizes[0] + (sizes[1] - sizes[0]) * share * share;
            let (length, height) = (size * dice.uniform(1, 0.8, 1.4), size * dice.uniform(2, 0.5, 0.9));
            let half = vec3(length, size, height);
            let center = place + (dice.shift(3, reach) + up(half.z * dice.uniform(7, 0.1, 0.5)));
            let pose = Pose::upright(center, dice.uniform(5, 0.0, 6.3));
            self.put(Stone::broken(half, dice), pose);
        }
    }

    /// Debris: rods, broken blocks, tires and cables, half buried.
    pub(crate) fn debris(&mut self, count: usize, place: Vec3, reach: [f32; 2]) {
        for i in 0..count {
            let dice = self.dice_for("debris").object(i);
            let center = place + dice.shift(0, reach);
            let along = horizontal(dice.uniform(2, 0.0, 6.3));
            match dice.count(3, 0, 3) {
                0 => {
                    self.object(Material::Steel, Category::Debris);
                    let half = along * dice.uniform(4, 0.25, 0.9);
                    let tilt = up(dice.uniform(5, 0.0, 0.12));
                    let radius = dice.uniform(6, 0.015, 0.06);
                    self.tube(center - half - tilt, center + half + tilt, radius);
                }
                1 => {
                    self.object(Material::Concrete(JointPattern::Boards), Category::Debris);
                    let half = dice.point_in(4, [0.12, 0.08, 0.04], [0.4, 0.2, 0.1]);
                    let x = (along + up(dice.uniform(7, -0.4, 0.4))).normalized();
                    let y = UP.cross(x).normalized();
                    let pose = Pose {
                        origin: center + up(0.5 * half.z),
                        axes: [x, y, x.cross(y)],
                    };
                    self.put(SolidBox { half }, pose);
                }
                2 => {
                    self.object(Material::Rubber, Category::Debris);
                    let thick = dice.uniform(4, 0.06, 0.1);
                    let tire = Ring::new(2.6 * thick, thick, std::f32::consts::PI);
                    let lean = dice.shift(5, [0.5, 0.5]) + UP;
                    self.ring(tire, center + up(0.3 * thick), lean, along);
                }
                _ => {
                    self.object(Material::Rubber, Category::Cable);
                    self.cable(dice, center, along);
                }
            }
        }
    }

    /// A cable in two opposite bends.
    fn cable(&mut self, dice: Choices, center: Vec3, along: Vec3) {
        const THICK_M: f32 = 0.02;
        let axis = vec3(dice.uniform(5, -0.04, 0.04), 0.0, 1.0).normalized();
        let toward = (along - axis * along.dot(axis)).normalized();
        let (first, second) = (dice.uniform(4, 0.3, 0.9), dice.uniform(8, 0.3, 0.9));
        let (half, other) = (dice.uniform(6, 0.6, 1.4), dice.uniform(7, 0.5, 1.3));
        self.ring(Ring::new(first, THICK_M, half), center, axis, toward);
        // The second bend starts where the first ends and curves the other way.
        let end = rotate(toward, axis, half);
        let pivot = center + end * (first + second);
        let bend = Ring::new(second, THICK_M, other);
        self.ring(bend, pivot, axis, rotate(-end, axis, -other));
    }
}

/// Rotates a vector perpendicular to a unit axis.
fn rotate(v: Vec3, axis: Vec3, angle: f32) -> Vec3 {
    let (sin, cos) = libm::sincosf(angle);
    v * cos + axis.cross(v) * sin
}
