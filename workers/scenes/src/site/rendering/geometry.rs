//! Positions and viewing geometry of a group of surface points.

use imaging::vector::Vec3;

use crate::site::camera::ViewCamera;
use crate::site::lanes::{LANES, Lane, Lane3, larger, load, store};
use crate::site::pose::Pose;

#[derive(Default)]
pub(crate) struct Geometry {
    pub(crate) world: Lane3,
    pub(crate) local: Lane3,
    /// NoiseSample coordinates.
    pub(crate) grain: Lane3,
    /// Unit directions to the camera in the solid's frame.
    pub(crate) view: Lane3,
    pub(crate) range: Lane,
    pub(crate) footprint: Lane,
    pub(crate) rise: Lane,
}

impl Geometry {
    #[inline(always)]
    pub(crate) fn place(
        &mut self,
        camera: &ViewCamera,
        pose: &Pose,
        origin: Vec3,
        (x, y, parameter): (&Lane, &Lane, &Lane),
    ) {
        let (camera, pose) = (*camera, *pose);
        for i in 0..LANES {
            let ray = camera.ray(x[i], y[i]);
            let length = ray.length();
            let point = camera.eye + ray * parameter[i];
            let local = pose.point_in(point);
            store(&mut self.world, i, point);
            store(&mut self.local, i, local);
            store(&mut self.grain, i, local + origin);
            store(&mut self.view, i, pose.direction_in(ray * (-1.0 / length)));
            self.range[i] = parameter[i] * length;
        }
    }

    #[inline(always)]
    pub(crate) fn look(&mut self, normal: &Lane3, up: Vec3, pixel_angle: f32) {
        for i in 0..LANES {
            let n = load(normal, i);
            let facing = larger(n.dot(load(&self.view, i)), 0.04).sqrt();
            self.footprint[i] = self.range[i] * pixel_angle / facing;
            self.rise[i] = n.dot(up);
        }
    }
}
