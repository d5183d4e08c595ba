//! A room of three textured planes, seen by a camera that moves through it: pictures with exact motion and poses.

use imaging::vector::{DVec3, vec3};
use imaging::{Plane, Rgb8};
use quality::{Motion, RelativePose};

pub(crate) const WIDTH: usize = 384;
pub(crate) const HEIGHT: usize = 288;
const FOCAL_PX: f64 = 330.0;

/// A camera in the room: x to the right, y down, z ahead, in meters.
#[derive(Clone, Copy)]
pub(crate) struct Camera {
    pub(crate) position: DVec3,
    pub(crate) yaw: f64,
    pub(crate) pitch: f64,
}

impl Camera {
    /// Frame `i` of a path that drifts, turns and sinks.
    pub(crate) fn on_path(i: usize) -> Self {
        let i = i as f64;
        Self {
            position: vec3(0.07 * i, -0.02 * i, 0.05 * i),
            yaw: 0.03 + 0.012 * i,
            pitch: 0.1 + 0.006 * i,
        }
    }

    /// Right, down and ahead in the room.
    fn axes(&self) -> [DVec3; 3] {
        let ((sin_yaw, cos_yaw), (sin_pitch, cos_pitch)) = (self.yaw.sin_cos(), self.pitch.sin_cos());
        let ahead = vec3(sin_yaw * cos_pitch, sin_pitch, cos_yaw * cos_pitch);
        let right = vec3(cos_yaw, 0.0, -sin_yaw);
        [right, ahead.cross(right), ahead]
    }

    /// The point seen at a position of the picture.
    fn trace(&self, x: f64, y: f64) -> Surface {
        let [right, down, ahead] = self.axes();
        let seen = ray(x, y);
        let direction = right * seen.x + down * seen.y + ahead * seen.z;
        // Floor, wall ahead and wall to the right.
        let distances = [
            (1.1 - self.position.y) / direction.y,
            (4.5 - self.position.z) / direction.z,
            (1.6 - self.position.x) / direction.x,
        ];
        let mut nearest = (0, f64::INFINITY);
        for (plane, distance) in distances.into_iter().enumerate() {
            if distance > 0.0 && distance < nearest.1 {
                nearest = (plane, distance);
            }
        }
        Surface {
            plane: nearest.0,
            point: self.position + direction * nearest.1,
        }
    }

    /// The position of a point in the picture.
    fn project(&self, point: DVec3) -> [f64; 2] {
        let [right, down, ahead] = self.axes();
        let from_camera = point - self.position;
        let scale = FOCAL_PX / from_camera.dot(ahead);
        [
            from_camera.dot(right) * scale + WIDTH as f64 / 2.0,
            from_camera.dot(down) * scale + HEIGHT as f64 / 2.0,
        ]
    }

    /// The picture with this contrast, a mean code, and noise, both in codes.
    pub(crate) fn render(&self, contrast: f64, mean: f64, noise: f64) -> Rgb8 {
        Rgb8::from_fn(WIDTH, HEIGHT, |x, y| {
            let Surface { plane, point } = self.trace(x as f64 + 0.5, y as f64 + 0.5);
            let (u, v) = match plane {
                0 => (point.x, point.z),
                1 => (point.x, point.y),
                _ => (point.z, point.y),
            };
            let grain = lattice(x as i64, y as i64, 900 + (1e4 * self.position.x) as i64) - 0.5;
            [(mean + contrast * (texture(u, v, plane as i64) - 0.5) + noise * grain) as u8; 3]
        })
    }

    /// True motion from this frame into a previous one; the room has no occluders.
    pub(crate) fn motion_from(&self, previous: &Self) -> Motion {
        Motion {
            positions: Plane::from_fn(WIDTH, HEIGHT, |x, y| {
                let point = self.trace(x as f64 + 0.5, y as f64 + 0.5).point;
                let [x, y] = previous.project(point);
                if (0.0..WIDTH as f64).contains(&x) && (0.0..HEIGHT as f64).contains(&y) {
                    [x as f32, y as f32]
                } else {
                    [f32::NAN; 2]
                }
            }),
        }
    }

    pub(crate) fn pose_from(&self, previous: &Self) -> RelativePose {
        let (own, other) = (self.axes(), previous.axes());
        let shift = previous.position - self.position;
        RelativePose {
            rotation: own.map(|row| other.map(|column| row.dot(column))),
            translation: vec3(own[0].dot(shift), own[1].dot(shift), own[2].dot(shift)),
        }
    }
}

/// The ray of a position in camera axes.
pub(crate) fn ray(x: f64, y: f64) -> DVec3 {
    vec3(
        (x - WIDTH as f64 / 2.0) / FOCAL_PX,
        (y - HEIGHT as f64 / 2.0) / FOCAL_PX,
        1.0,
    )
}

/// Angle of a pixel in the center, rad.
pub(crate) const PIXEL_RAD: f64 = 1.0 / FOCAL_PX;

struct Surface {
    plane: usize,
    point: DVec3,
}

/// A random value of a lattice point, 0..1.
fn lattice(i: i64, j: i64, salt: i64) -> f64 {
    let hash = (i as u32).wrapping_mul(0x9e37_79b1)
        ^ (j as u32).wrapping_mul(0x85eb_ca77)
        ^ (salt as u32).wrapping_mul(0xc2b2_ae3d);
    let hash = (hash ^ (hash >> 15)).wrapping_mul(0x2c1b_3c6d);
    f64::from((hash ^ (hash >> 12)).wrapping_mul(0x297a_2d39) >> 8) / f64::from(1u32 << 24)
}

/// Value noise of four octaves, 0..1.
fn texture(u: f64, v: f64, salt: i64) -> f64 {
    let octave = |cell: f64, salt: i64| {
        let (u, v) = (u / cell, v / cell);
        let (i, j) = (u.floor(), v.floor());
        let [s, t] = [u - i, v - j].map(|f| f * f * (3.0 - 2.0 * f));
        let value = |across: i64, down: i64| lattice(i as i64 + across, j as i64 + down, salt);
        let (upper, lower) = (
            value(0, 0) * (1.0 - s) + value(1, 0) * s,
            value(0, 1) * (1.0 - s) + value(1, 1) * s,
        );
        upper * (1.0 - t) + lower * t
    };
    let cells = [0.4, 0.15, 0.06, 0.025];
    cells
        .iter()
        .zip(10 * salt..)
        .map(|(&cell, salt)| octave(cell, salt))
        .sum::<f64>()
        / cells.len() as f64
}
