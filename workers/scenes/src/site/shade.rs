//! Gathers the pixels of each solid into groups, wherever they are in the picture, and shades a group at a time.

use super::Site;
use super::camera::Camera;
use super::finish::Points;
use super::lanes::{LANES, Lane, Lane3, ZEROS, larger, mix, ramp, smaller};
use super::light::{Light, Lit, background, illuminate};
use super::noise::Place;
use super::picture::Picture;
use super::solid::Solid;
use super::vector::{Pose, UP, Vec3, ZERO, vec3};

use imaging::simd::vectorised;

/// Reach of the shadow where two surfaces meet, m.
const CONTACT_M: f32 = 0.45;
/// Solids farther off than this are left out; somewhat more than the reach, so that leaving one out changes no bit.
const NEAR_M: f32 = 1.01 * CONTACT_M;
/// Edges are rounded over this width in the normal, m.
const BEVEL_M: f32 = 0.012;
/// The same in the normals of labels, m.
const LABEL_BEVEL_M: f32 = 1e-3;
/// Mounds of the ground run out over this height, m.
const RUN_OUT_M: f32 = 0.06;

/// Pixels of one solid that wait to be shaded.
#[derive(Clone)]
struct Queue {
    len: usize,
    x: Lane,
    y: Lane,
    parameter: Lane,
    pixel: [u32; LANES],
}

/// Shades the pixels of a picture.
pub(super) struct Shader<'a> {
    site: &'a Site,
    camera: &'a Camera,
    light: Light,
    boxes: Vec<[Vec3; 2]>,
    /// For each solid and the ground, the solids that come near it.
    near: Vec<Vec<u16>>,
    queues: Vec<Queue>,
}

impl<'a> Shader<'a> {
    pub(super) fn new(site: &'a Site, camera: &'a Camera) -> Self {
        let boxes: Vec<[Vec3; 2]> = site.solids.iter().map(around).collect();
        let ground = [vec3(-1e9, -1e9, -1e9), vec3(1e9, 1e9, 0.0)];
        let near = boxes.iter().chain([&ground]).enumerate();
        let near = near.map(|(own, one)| {
            let others = boxes.iter().enumerate();
            let others = others.filter(|(other, its)| *other != own && touch(one, its));
            // Mounds are a part of the ground and cast no shadow on it.
            let others = others.filter(|(other, _)| site.solids[*other].object != 0);
            others.map(|(other, _)| other as u16).collect()
        });
        let empty = Queue {
            len: 0,
            x: ZEROS,
            y: ZEROS,
            parameter: ZEROS,
            pixel: [0; LANES],
        };
        Self {
            site,
            camera,
            light: Light::of(site),
            near: near.collect(),
            queues: vec![empty; boxes.len() + 2],
            boxes,
        }
    }

    /// Takes a row, whose first pixel has the given index, and shades what makes up whole groups.
    pub(super) fn row(
        &mut self,
        y: usize,
        first: usize,
        parameter: &[f32],
        owner: &[u16],
        picture: &mut Picture,
    ) {
        let mut start = 0;
        while start < owner.len() {
            let whose = usize::from(owner[start]);
            let room = LANES - self.queues[whose].len;
            let same = owner[start..]
                .iter()
                .take(room)
                .take_while(|&&other| other == owner[start])
                .count();
            let queue = &mut self.queues[whose];
            for i in 0..same {
                let (at, x) = (queue.len + i, start + i);
                queue.x[at] = x as f32;
                queue.y[at] = y as f32;
                queue.parameter[at] = parameter[x];
                queue.pixel[at] = (first + x) as u32;
            }
            queue.len += same;
            if same == room {
                self.flush(whose, picture);
            }
            start += same;
        }
    }

    /// Shades what is left.
    pub(super) fn finish(&mut self, picture: &mut Picture) {
        for whose in 0..self.queues.len() {
            self.flush(whose, picture);
        }
    }

    fn flush(&mut self, whose: usize, picture: &mut Picture) {
        let queue = &mut self.queues[whose];
        let len = std::mem::take(&mut queue.len);
        if len == 0 {
            return;
        }
        // The last pixel fills the rest of the group.
        for i in len..LANES {
            queue.x[i] = queue.x[len - 1];
            queue.y[i] = queue.y[len - 1];
            queue.parameter[i] = queue.parameter[len - 1];
        }
        let queue = &self.queues[whose];
        let light = if whose > self.site.solids.len() {
            let (camera, site) = (self.camera, &self.light);
            let mut light = [ZEROS; 3];
            vectorised(
                #[inline(always)]
                || background(&mut light, camera, site, &queue.x, &queue.y),
            );
            light
        } else {
            self.group(whose, queue, len, picture)
        };
        for (band, light) in picture.bands.iter_mut().zip(&light) {
            for i in 0..len {
                band[queue.pixel[i] as usize] = light[i];
            }
        }
    }

    fn group(&self, whose: usize, queue: &Queue, len: usize, picture: &mut Picture) -> Lane3 {
        let solid = self.site.solids.get(whose);
        let pose = solid.map_or(Pose::upright(ZERO, 0.0), |solid| solid.pose);
        let object = solid.map_or(0, |solid| usize::from(solid.object));
        // Parts of one form lie in different places of the noise: no two plates of a wall rust alike.
        let part = (whose % 251) as f32;
        let origin = if object == 0 {
            pose.origin
        } else {
            vec3(3.71 * part, 5.13 * part, 0.0)
        };
        let mut geometry = Geometry::BLANK;
        let camera = self.camera;
        vectorised(
            #[inline(always)]
            || geometry.place(camera, &pose, origin, queue),
        );
        let mut normal = [ZEROS, ZEROS, [1.0; LANES]];
        let mut edge = ZEROS;
        if let Some(solid) = solid {
            solid.normals(&geometry.local, BEVEL_M, &mut normal, &mut edge);
            if object == 0 {
                let world = &geometry.world;
                vectorised(
                    #[inline(always)]
                    || run_out(&mut normal, &world[2]),
                );
            }
        }
        let up = pose.direction_in(UP);
        let angle = camera.pixel_angle();
        vectorised(
            #[inline(always)]
            || geometry.look(&normal, up, angle),
        );
        let finest = geometry.footprint.iter().copied().fold(f32::INFINITY, f32::min);
        let surface = self.site.objects[object].finish.surface(&Points {
            place: Place {
                position: &geometry.grain,
                footprint: &geometry.footprint,
                finest,
            },
            local: &geometry.local,
            world: &geometry.world,
            edge: &edge,
            rise: &geometry.rise,
        });
        let open = self.openness(whose, object != 0, &geometry.world);
        if picture.labels.is_some() {
            self.label(whose, queue, len, &geometry, &surface.findings, picture);
        }
        let lit = Lit {
            normal: &normal,
            view: &geometry.view,
            range: &geometry.range,
            open: &open,
            up,
            ahead: pose.direction_in(camera.ahead),
            ground: object == 0,
        };
        let (mut bands, light) = ([ZEROS; 3], &self.light);
        vectorised(
            #[inline(always)]
            || illuminate(&mut bands, light, &surface, &lit),
        );
        bands
    }

    /// How open each point is to the light from above: less where another solid or the ground is near.
    fn openness(&self, whose: usize, above_ground: bool, world: &Lane3) -> Lane {
        let reach = vec3(NEAR_M, NEAR_M, NEAR_M);
        let (mut low, mut high) = (ZERO, ZERO);
        vectorised(
            #[inline(always)]
            || (low, high) = extent(world),
        );
        let group = [low - reach, high + reach];
        let mut distance = [CONTACT_M; LANES];
        for &other in &self.near[whose] {
            let other = usize::from(other);
            let [low, high] = &self.boxes[other];
            if overlap(&group, &[*low, *high]) {
                self.site.solids[other].approach(world, &mut distance);
            }
        }
        let mut open = ZEROS;
        let height = &world[2];
        vectorised(
            #[inline(always)]
            || shadow(&mut open, &distance, height, above_ground),
        );
        open
    }

    fn label(
        &self,
        whose: usize,
        queue: &Queue,
        len: usize,
        geometry: &Geometry,
        findings: &[Lane],
        picture: &mut Picture,
    ) {
        let Some(labels) = &mut picture.labels else { return };
        let (mut normal, mut edge) = ([ZEROS, ZEROS, [1.0; LANES]], ZEROS);
        let solid = self.site.solids.get(whose);
        let pose = solid.map_or(Pose::upright(ZERO, 0.0), |solid| solid.pose);
        if let Some(solid) = solid {
            solid.normals(&geometry.local, LABEL_BEVEL_M, &mut normal, &mut edge);
        }
        for i in 0..len {
            let pixel = queue.pixel[i] as usize;
            let toward = pose.direction_out(at(&geometry.view, i));
            let outward = facing(pose.direction_out(at(&normal, i)), toward);
            let camera = self.camera;
            let axes = [camera.right, camera.down, camera.ahead].map(|axis| axis.dot(outward));
            for (plane, value) in labels.normals.iter_mut().zip(axes) {
                plane[pixel] = value;
            }
            let bits = findings.iter().enumerate();
            labels.findings[pixel] =
                bits.fold(0, |mask, (bit, lane)| mask | (u8::from(lane[i] > 0.5) << bit));
        }
    }
}

/// A normal that an edge has turned away from the camera, brought back to the edge of what the camera can see.
fn facing(normal: Vec3, toward: Vec3) -> Vec3 {
    let facing = normal.dot(toward);
    let seen = if facing < 0.0 {
        normal - toward * (facing * 1.001)
    } else {
        normal
    };
    seen.unit()
}

/// Where the points of a group are.
struct Geometry {
    world: Lane3,
    local: Lane3,
    /// Where noise is taken.
    grain: Lane3,
    /// Unit directions to the camera in the solid's frame.
    view: Lane3,
    range: Lane,
    footprint: Lane,
    rise: Lane,
}

impl Geometry {
    const BLANK: Self = Self {
        world: [ZEROS; 3],
        local: [ZEROS; 3],
        grain: [ZEROS; 3],
        view: [ZEROS; 3],
        range: ZEROS,
        footprint: ZEROS,
        rise: ZEROS,
    };

    #[inline(always)]
    fn place(&mut self, camera: &Camera, pose: &Pose, origin: Vec3, queue: &Queue) {
        let (camera, pose) = (*camera, *pose);
        for i in 0..LANES {
            let ray = camera.ray(queue.x[i], queue.y[i]);
            let length = ray.length();
            let point = camera.eye + ray * queue.parameter[i];
            let local = pose.point_in(point);
            set(&mut self.world, i, point);
            set(&mut self.local, i, local);
            set(&mut self.grain, i, local + origin);
            set(&mut self.view, i, pose.direction_in(ray * (-1.0 / length)));
            self.range[i] = queue.parameter[i] * length;
        }
    }

    #[inline(always)]
    fn look(&mut self, normal: &Lane3, up: Vec3, pixel_angle: f32) {
        for i in 0..LANES {
            let n = at(normal, i);
            let facing = larger(n.dot(at(&self.view, i)), 0.04).sqrt();
            self.footprint[i] = self.range[i] * pixel_angle / facing;
            self.rise[i] = n.dot(up);
        }
    }
}

/// A box around a solid in the world; around a hollow's wall, everything.
fn around(solid: &Solid) -> [Vec3; 2] {
    if solid.is_hollow() {
        return [vec3(-1e9, -1e9, -1e9), vec3(1e9, 1e9, 1e9)];
    }
    let corners = solid.corners();
    corners.iter().fold([corners[0]; 2], |[low, high], corner| {
        [lowest(low, *corner), highest(high, *corner)]
    })
}

fn touch(a: &[Vec3; 2], b: &[Vec3; 2]) -> bool {
    let reach = vec3(NEAR_M, NEAR_M, NEAR_M);
    overlap(&[a[0] - reach, a[1] + reach], b)
}

fn overlap(a: &[Vec3; 2], b: &[Vec3; 2]) -> bool {
    let along = |low: f32, high: f32, other_low: f32, other_high: f32| low <= other_high && other_low <= high;
    along(a[0].x, a[1].x, b[0].x, b[1].x)
        && along(a[0].y, a[1].y, b[0].y, b[1].y)
        && along(a[0].z, a[1].z, b[0].z, b[1].z)
}

#[inline(always)]
fn lowest(a: Vec3, b: Vec3) -> Vec3 {
    vec3(smaller(a.x, b.x), smaller(a.y, b.y), smaller(a.z, b.z))
}

#[inline(always)]
fn highest(a: Vec3, b: Vec3) -> Vec3 {
    vec3(larger(a.x, b.x), larger(a.y, b.y), larger(a.z, b.z))
}

/// Lowest and highest coordinates of a group.
#[inline(always)]
fn extent(points: &Lane3) -> (Vec3, Vec3) {
    const WIDE: usize = 8;
    let (mut low, mut high) = ([[0.0; WIDE]; 3], [[0.0; WIDE]; 3]);
    for axis in 0..3 {
        low[axis].copy_from_slice(&points[axis][..WIDE]);
        high[axis].copy_from_slice(&points[axis][..WIDE]);
        for chunk in 1..LANES / WIDE {
            for i in 0..WIDE {
                let p = points[axis][chunk * WIDE + i];
                low[axis][i] = smaller(p, low[axis][i]);
                high[axis][i] = larger(p, high[axis][i]);
            }
        }
    }
    let least = low.map(|lane| lane.into_iter().fold(f32::INFINITY, smaller));
    let most = high.map(|lane| lane.into_iter().fold(f32::NEG_INFINITY, larger));
    (
        vec3(least[0], least[1], least[2]),
        vec3(most[0], most[1], most[2]),
    )
}

#[inline(always)]
fn shadow(open: &mut Lane, distance: &Lane, height: &Lane, above_ground: bool) {
    for i in 0..LANES {
        let ground = ramp(height[i], -0.15, CONTACT_M);
        let ground = if above_ground { ground } else { 1.0 };
        open[i] = mix(0.3, 1.0, ramp(distance[i], -0.05, CONTACT_M)) * mix(0.45, 1.0, ground);
    }
}

#[inline(always)]
fn run_out(normal: &mut Lane3, height: &Lane) {
    for i in 0..LANES {
        let share = ramp(height[i], 0.0, RUN_OUT_M);
        let n = vec3(
            normal[0][i] * share,
            normal[1][i] * share,
            mix(1.0, normal[2][i], share),
        );
        set(normal, i, n * (1.0 / n.length()));
    }
}

#[inline(always)]
fn set(lanes: &mut Lane3, i: usize, v: Vec3) {
    lanes[0][i] = v.x;
    lanes[1][i] = v.y;
    lanes[2][i] = v.z;
}

#[inline(always)]
fn at(lanes: &Lane3, i: usize) -> Vec3 {
    vec3(lanes[0][i], lanes[1][i], lanes[2][i])
}
