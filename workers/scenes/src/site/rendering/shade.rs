//! Gathers the pixels of each solid into groups across the picture, and shades whole groups.

use imaging::vector::{Vec3, vec3};
use imaging::vectorized;

use crate::site::bounds::Bounds;
use crate::site::camera::ViewCamera;
use crate::site::finish::Points;
use crate::site::geometry::Geometry;
use crate::site::lanes::{LANES, Lane, Lane3, ZEROS, load, mix, ramp, store};
use crate::site::light::{Lit, SiteLight, background, illuminate, reflect};
use crate::site::noise::NoisePoints;
use crate::site::pose::{Pose, UP, ZERO};
use crate::site::rows::RenderedRows;
use crate::site::solid::Solid;
use crate::site::{Site, pits};

/// Reach of contact shadows, m.
const CONTACT_M: f32 = 0.45;
/// Solids farther off are skipped; slightly more than the reach, so that skipping changes no bit.
const NEAR_M: f32 = 1.01 * CONTACT_M;
/// Width of rounded edges in the normals, m.
const BEVEL_M: f32 = 0.012;
/// Width of rounded edges in label normals, m.
pub(crate) const LABEL_BEVEL_M: f32 = 1e-3;
/// Mounds blend into the ground over this height, m.
const RUN_OUT_M: f32 = 0.06;

/// Pixels of one solid waiting for a full group.
#[derive(Clone, Default)]
struct Queue {
    len: usize,
    x: Lane,
    y: Lane,
    parameter: Lane,
    pixel: [u32; LANES],
}

pub(crate) struct Shader<'a> {
    site: &'a Site,
    camera: &'a ViewCamera,
    light: SiteLight,
    /// Renders reflectance instead of radiance.
    reflectance: bool,
    boxes: Vec<Bounds>,
    /// For each solid and the ground, the solids that shade it; empty for reflectance.
    near: Vec<Vec<u16>>,
    queues: Vec<Queue>,
}

impl<'a> Shader<'a> {
    pub(crate) fn new(site: &'a Site, camera: &'a ViewCamera, reflectance: bool) -> Self {
        let boxes: Vec<Bounds> = site.solids.iter().map(Bounds::from_solid).collect();
        // Reflectance has no shadows.
        let near = if reflectance {
            Vec::new()
        } else {
            find_neighbors(site, &boxes)
        };
        Self {
            site,
            camera,
            light: SiteLight::new(site),
            reflectance,
            near,
            queues: vec![Queue::default(); boxes.len() + 2],
            boxes,
        }
    }

    /// Adds a row that starts at pixel index `first`, and shades the groups that are full.
    pub(crate) fn row(
        &mut self,
        y: usize,
        first: usize,
        parameter: &[f32],
        owner: &[u16],
        picture: &mut RenderedRows,
    ) {
        let mut start = 0;
        while start < owner.len() {
            let whose = usize::from(owner[start]);
            let room = LANES - self.queues[whose].len;
            let run = owner[start..].iter().take(room);
            let same = run.take_while(|&&other| other == owner[start]).count();
            let queue = &mut self.queues[whose];
            for i in 0..same {
                let (place, x) = (queue.len + i, start + i);
                queue.x[place] = x as f32;
                queue.y[place] = y as f32;
                queue.parameter[place] = parameter[x];
                queue.pixel[place] = (first + x) as u32;
            }
            queue.len += same;
            if same == room {
                self.flush(whose, picture);
            }
            start += same;
        }
    }

    /// Shades the remaining pixels.
    pub(crate) fn finish(&mut self, picture: &mut RenderedRows) {
        for whose in 0..self.queues.len() {
            self.flush(whose, picture);
        }
    }

    fn flush(&mut self, whose: usize, picture: &mut RenderedRows) {
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
            if !self.reflectance {
                vectorized!(background(&mut light, camera, site, &queue.x, &queue.y));
            }
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

    fn group(&self, whose: usize, queue: &Queue, len: usize, picture: &mut RenderedRows) -> Lane3 {
        let solid = self.site.solids.get(whose);
        let pose = solid.map_or(Pose::upright(ZERO, 0.0), |solid| solid.pose);
        let object = solid.map_or(0, |solid| usize::from(solid.object));
        let origin = if object == 0 {
            pose.origin
        } else {
            noise_origin(whose)
        };
        let mut geometry = Geometry::default();
        let camera = self.camera;
        vectorized!(geometry.place(camera, &pose, origin, (&queue.x, &queue.y, &queue.parameter)));
        let mut normal = [ZEROS, ZEROS, [1.0; LANES]];
        let mut edge = ZEROS;
        if let Some(solid) = solid {
            solid.normals(&geometry.local, BEVEL_M, &mut normal, &mut edge);
            if object == 0 {
                let world = &geometry.world;
                vectorized!(run_out(&mut normal, &world[2]));
            }
        } else if !self.site.pits.is_empty() {
            pits::tilt(&self.site.pits, &geometry.world, &mut normal);
        }
        let (up, pixel_angle) = (pose.direction_in(UP), camera.inverse_focal);
        vectorized!(geometry.look(&normal, up, pixel_angle));
        let finest = geometry.footprint.iter().copied().fold(f32::INFINITY, f32::min);
        let surface = self.site.objects[object].finish.surface(&Points {
            place: NoisePoints {
                position: &geometry.grain,
                footprint: &geometry.footprint,
                finest,
            },
            local: &geometry.local,
            world: &geometry.world,
            edge: &edge,
            rise: &geometry.rise,
        });
        if picture.labels.is_some() {
            self.label((solid, &pose), queue, len, &geometry, &surface.findings, picture);
        }
        let mut bands = [ZEROS; 3];
        if self.reflectance {
            vectorized!(reflect(&mut bands, &surface));
            return bands;
        }
        let open = self.openness(whose, object != 0, &geometry.world);
        let lit = Lit {
            normal: &normal,
            view: &geometry.view,
            range: &geometry.range,
            open: &open,
            up,
            ahead: pose.direction_in(camera.ahead),
            ground: object == 0,
        };
        let light = &self.light;
        vectorized!(illuminate(&mut bands, light, &surface, &lit));
        bands
    }

    /// Openness of each point to light from above: reduced near other solids and the ground.
    fn openness(&self, whose: usize, above_ground: bool, world: &Lane3) -> Lane {
        let group = vectorized!(Bounds::from_points(world));
        let mut distance = [CONTACT_M; LANES];
        for &other in &self.near[whose] {
            let other = usize::from(other);
            if group.touches(&self.boxes[other], NEAR_M) {
                self.site.solids[other].approach(world, &mut distance);
            }
        }
        let mut open = ZEROS;
        let height = &world[2];
        vectorized!(shadow(&mut open, &distance, height, above_ground));
        open
    }

    fn label(
        &self,
        (solid, pose): (Option<&Solid>, &Pose),
        queue: &Queue,
        len: usize,
        geometry: &Geometry,
        findings: &[Lane],
        picture: &mut RenderedRows,
    ) {
        let Some(labels) = &mut picture.labels else { return };
        let (mut normal, mut edge) = ([ZEROS, ZEROS, [1.0; LANES]], ZEROS);
        if let Some(solid) = solid {
            solid.normals(&geometry.local, LABEL_BEVEL_M, &mut normal, &mut edge);
        } else if !self.site.pits.is_empty() {
            pits::tilt(&self.site.pits, &geometry.world, &mut normal);
        }
        let camera = self.camera;
        let axes = [camera.right, camera.down, camera.ahead].map(|axis| pose.direction_in(axis));
        let (mut shown, mut mask) = ([ZEROS; 3], [0u32; LANES]);
        vectorized!(face_camera(&mut shown, &normal, &geometry.view, &axes));
        vectorized!(set_bits(&mut mask, findings));
        for i in 0..len {
            let pixel = queue.pixel[i] as usize;
            for (plane, value) in labels.normals.iter_mut().zip(&shown) {
                plane[pixel] = value[i];
            }
            labels.findings[pixel] = mask[i] as u8;
        }
    }
}

/// For each solid and the ground, the solids within reach of their contact shadows. Mounds belong to the ground and cast no shadow
/// on it; biota are too small and too numerous.
fn find_neighbors(site: &Site, boxes: &[Bounds]) -> Vec<Vec<u16>> {
    let casting = (0..boxes.len()).filter(|&solid| {
        let object = site.solids[solid].object;
        object != 0 && !site.objects[usize::from(object)].category.is_life()
    });
    let casting: Vec<usize> = casting.collect();
    let ground = Bounds::half_space(0.0);
    let shaded = boxes.iter().chain([&ground]).enumerate();
    let near = shaded.map(|(own, bounds)| {
        let others = casting.iter().filter(|&&other| other != own);
        let others = others.filter(|&&other| bounds.touches(&boxes[other], NEAR_M));
        others.map(|&other| other as u16).collect()
    });
    near.collect()
}

/// Unit normals in camera axes. Normals that an edge turned away from the camera are clamped to perpendicular.
#[inline(always)]
fn face_camera(shown: &mut Lane3, normal: &Lane3, view: &Lane3, axes: &[Vec3; 3]) {
    let axes = *axes;
    for i in 0..LANES {
        let (n, toward) = (load(normal, i), load(view, i));
        let facing = n.dot(toward);
        let away = if facing < 0.0 { facing * 1.001 } else { 0.0 };
        let n = n - toward * away;
        let n = n.normalized();
        store(shown, i, axes.map(|axis| axis.dot(n)).into());
    }
}

/// Sets the bit of each finding that covers more than half of the pixel.
#[inline(always)]
fn set_bits(mask: &mut [u32; LANES], findings: &[Lane]) {
    for (bit, strength) in findings.iter().enumerate() {
        for i in 0..LANES {
            mask[i] |= if strength[i] > 0.5 { 1 << bit } else { 0 };
        }
    }
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
        let n = load(normal, i);
        let n = vec3(n.x * share, n.y * share, mix(1.0, n.z, share));
        store(normal, i, n.normalized());
    }
}

/// Offsets the noise between parts of one shape: no two plates of a wall rust the same way.
fn noise_origin(whose: usize) -> Vec3 {
    let part = (whose % 251) as f32;
    vec3(3.71 * part, 5.13 * part, 0.0)
}
