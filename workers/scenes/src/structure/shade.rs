//! Light: a lamp at the camera with inverse-square falloff, a soft light from above, and shadow where surfaces meet.

use std::ops::Range;

use super::finish::Finish;
use super::lanes::{LANES, Lane, Lane3, ZEROS, larger, mix, ramp};
use super::layout::Site;
use super::noise;
use super::solid::Solid;
use super::vector::{Pose, UP, Vec3, ZERO, vec3};
use super::{NOTHING, SEABED};

/// Reach of the shadow where two surfaces meet, m.
const CONTACT_M: f32 = 0.45;
/// Edges are rounded over this width in the normal, m.
const BEVEL_M: f32 = 0.012;
/// Softens the lamp near the camera: a real lamp is no point. In parts of the full-light distance, squared.
const LAMP_SOFTNESS: f32 = 0.22;
const LAMP_LIGHT: f32 = 0.95;
const SKY: [f32; 3] = [0.86, 0.95, 1.0];
/// What is seen where nothing is met.
const BACKDROP: [f32; 3] = [0.012, 0.016, 0.02];

/// Where a solid can appear in the frame, and where its contact shadow can fall.
pub(super) struct Frame {
    body: [Range<usize>; 2],
    shadow: [Range<usize>; 2],
}

impl Frame {
    fn of(solid: &Solid, site: &Site) -> Self {
        let camera = &site.camera;
        let corners = solid.corners().map(|corner| camera.axes_of(corner));
        let whole = || [0..camera.width, 0..camera.height];
        let nearest = corners
            .iter()
            .fold(f32::INFINITY, |near, corner| near.min(corner.z));
        if nearest < 0.05 {
            let behind = corners.iter().all(|corner| corner.z < 0.0);
            let body = if behind { [0..0, 0..0] } else { whole() };
            return Self {
                body,
                shadow: whole(),
            };
        }
        let mut low = (f32::INFINITY, f32::INFINITY);
        let mut high = (f32::NEG_INFINITY, f32::NEG_INFINITY);
        for corner in corners {
            let (x, y) = camera.project(corner);
            low = (low.0.min(x), low.1.min(y));
            high = (high.0.max(x), high.1.max(y));
        }
        let within = |low: f32, high: f32, side: usize, margin: f32| {
            let start = (low - margin).floor().clamp(0.0, side as f32) as usize;
            start..((high + margin).ceil() + 1.0).clamp(start as f32, side as f32) as usize
        };
        let around = |margin: f32| {
            [
                within(low.0, high.0, camera.width, margin),
                within(low.1, high.1, camera.height, margin),
            ]
        };
        Self {
            body: around(1.0),
            shadow: around(1.0 + CONTACT_M / (camera.pixel_angle() * nearest)),
        }
    }

    /// The columns of a row in which the solid can be met.
    pub(super) fn columns(&self, y: usize) -> Option<Range<usize>> {
        (self.body[1].contains(&y) && !self.body[0].is_empty()).then(|| self.body[0].clone())
    }

    fn may_shade(&self, y: usize, columns: &Range<usize>) -> bool {
        self.shadow[1].contains(&y)
            && self.shadow[0].start < columns.end
            && columns.start < self.shadow[0].end
    }
}

/// Shades the rows of a site.
pub(super) struct Shader<'a> {
    site: &'a Site,
    frames: Vec<Frame>,
}

/// A run of pixels of one row that show one solid.
struct Run {
    y: usize,
    columns: Range<usize>,
    owner: u16,
}

impl<'a> Shader<'a> {
    pub(super) fn new(site: &'a Site) -> Self {
        Self {
            site,
            frames: site.solids.iter().map(|solid| Frame::of(solid, site)).collect(),
        }
    }

    pub(super) fn frames(&self) -> &[Frame] {
        &self.frames
    }

    /// Appends the light of a row to the three bands.
    pub(super) fn row(&self, y: usize, parameter: &[f32], owner: &[u16], bands: &mut [Vec<f32>; 3]) {
        let mut start = 0;
        while start < owner.len() {
            let same = owner[start..]
                .iter()
                .take(LANES)
                .take_while(|&&other| other == owner[start])
                .count();
            let run = Run {
                y,
                columns: start..start + same,
                owner: owner[start],
            };
            if run.owner == NOTHING {
                bands
                    .iter_mut()
                    .zip(BACKDROP)
                    .for_each(|(band, light)| band.extend(std::iter::repeat_n(light, same)));
            } else {
                let light = self.run(&run, parameter);
                bands
                    .iter_mut()
                    .zip(light)
                    .for_each(|(band, light)| band.extend(&light[..same]));
            }
            start += same;
        }
    }

    fn run(&self, run: &Run, parameter: &[f32]) -> Lane3 {
        let camera = &self.site.camera;
        let solid = (run.owner != SEABED).then(|| &self.site.solids[usize::from(run.owner)]);
        let pose = solid.map_or(Pose::upright(ZERO, 0.0), |solid| solid.pose);
        let finish: &Finish = solid.map_or(&self.site.seabed, |solid| &self.site.finishes[solid.finish]);
        let (mut world, mut local, mut grain, mut view) = ([ZEROS; 3], [ZEROS; 3], [ZEROS; 3], [ZEROS; 3]);
        // Parts of one form lie in different places of the noise: no two plates of a wall rust alike.
        let part = f32::from(run.owner % 251);
        let shift = if solid.is_some() {
            vec3(3.71 * part, 5.13 * part, 0.0)
        } else {
            ZERO
        };
        let mut range = ZEROS;
        for i in 0..LANES {
            // The last pixel fills the rest of the group.
            let x = (run.columns.start + i).min(run.columns.end - 1);
            let ray = camera.ray(x as f32, run.y as f32);
            let point = camera.eye + ray * parameter[x];
            range[i] = parameter[x] * ray.length();
            set(&mut world, i, point);
            set(&mut local, i, pose.point_in(point));
            set(&mut grain, i, pose.point_in(point) + shift);
            set(&mut view, i, -pose.direction_in(ray.unit()));
        }
        let (mut normal, mut edge) = ([ZEROS, ZEROS, [1.0; LANES]], ZEROS);
        if let Some(solid) = solid {
            solid.normals(&local, BEVEL_M, &mut normal, &mut edge);
        }
        let footprint = lane(|i| range[i] * camera.pixel_angle() / larger(dot(&normal, &view, i), 0.2));
        let finest = footprint.iter().copied().fold(f32::INFINITY, f32::min);
        let surface = finish.surface(
            &noise::Site {
                position: &grain,
                footprint: &footprint,
                finest,
            },
            &edge,
        );
        let open = self.openness(run, &world, solid);
        let up = pose.direction_in(UP);
        let ahead = pose.direction_in(camera.ahead);
        let lit = Lit {
            normal: &normal,
            view: &view,
            range: &range,
            open: &open,
            up,
            ahead,
        };
        self.light(&surface, &lit)
    }

    /// How open each point is to the light from above: less where another solid or the seabed is near.
    fn openness(&self, run: &Run, world: &Lane3, own: Option<&Solid>) -> Lane {
        let mut distance = [CONTACT_M; LANES];
        for (index, (solid, frame)) in self.site.solids.iter().zip(&self.frames).enumerate() {
            let other = index != usize::from(run.owner);
            if other && frame.may_shade(run.y, &run.columns) {
                solid.approach(world, &mut distance);
            }
        }
        lane(|i| {
            let ground = if own.is_some() {
                ramp(world[2][i], -0.15, CONTACT_M)
            } else {
                1.0
            };
            mix(0.3, 1.0, ramp(distance[i], -0.05, CONTACT_M)) * mix(0.45, 1.0, ground)
        })
    }

    fn light(&self, surface: &super::finish::Surface, lit: &Lit<'_>) -> Lane3 {
        let full = self.site.lamp_m * self.site.lamp_m;
        let mut lamp = ZEROS;
        let mut gleam = ZEROS;
        let mut sky = ZEROS;
        for i in 0..LANES {
            let (n, v) = (at(lit.normal, i), at(lit.view, i));
            let slope = at(&surface.slope, i);
            let bumped = n - (slope - n * n.dot(slope));
            let bumped = bumped * (1.0 / larger(bumped.length(), 1e-6));
            let facing = larger(bumped.dot(v), 0.0);
            let spot = 0.25 + 0.75 * ramp(-lit.ahead.dot(v), 0.62, 0.96);
            let near = full * (1.0 + LAMP_SOFTNESS) / (lit.range[i] * lit.range[i] + LAMP_SOFTNESS * full);
            let reach = LAMP_LIGHT * spot * near;
            lamp[i] = reach * facing * (0.55 + 0.45 * lit.open[i]);
            let squared = facing * facing;
            let sharp = squared * squared * squared * squared;
            gleam[i] = surface.gloss * reach * sharp * sharp * sharp * 0.5;
            sky[i] = self.site.ambient * (0.55 + 0.45 * bumped.dot(lit.up)) * lit.open[i];
        }
        [0, 1, 2]
            .map(|c| lane(|i| larger(surface.albedo[c][i], 0.02) * (lamp[i] + sky[i] * SKY[c]) + gleam[i]))
    }
}

/// Geometry of a group of points in the solid's frame.
struct Lit<'a> {
    normal: &'a Lane3,
    view: &'a Lane3,
    range: &'a Lane,
    open: &'a Lane,
    up: Vec3,
    ahead: Vec3,
}

fn lane(value: impl Fn(usize) -> f32) -> Lane {
    super::lanes::each(value)
}

fn set(lanes: &mut Lane3, i: usize, v: Vec3) {
    lanes[0][i] = v.x;
    lanes[1][i] = v.y;
    lanes[2][i] = v.z;
}

fn at(lanes: &Lane3, i: usize) -> Vec3 {
    vec3(lanes[0][i], lanes[1][i], lanes[2][i])
}

fn dot(a: &Lane3, b: &Lane3, i: usize) -> f32 {
    at(a, i).dot(at(b, i))
}
