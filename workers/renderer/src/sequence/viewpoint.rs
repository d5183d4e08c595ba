//! The camera of a picture: its pose, and the map between positions in the picture and rays in the water.

use camera::geometry::Lens;
use imaging::geometry::Intrinsics;
use imaging::vector::{DVec3, vec3};
use scenes::CameraPose;
use spec::{Camera, Frame};

use crate::context::FrameContext;
use crate::error::RenderError;
use crate::inputs::camera::rendered_parts;

/// The camera of a picture, at the frame's time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Viewpoint {
    /// Columns and rows of the picture.
    pub size: (usize, usize),
    /// Pose in the world.
    pub pose: CameraPose,
    optics: ViewOptics,
}

/// The map from rays to positions.
#[derive(Debug, Clone, Copy, PartialEq)]
enum ViewOptics {
    Pinhole(Intrinsics),
    /// With distortion or a flat port, for the refractive index of green.
    Lens(Lens),
}

/// The map of points from the axes of one camera to those of another: `rotation · point + translation_m`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RelativePose {
    /// Rows of the rotation.
    pub rotation: [[f64; 3]; 3],
    /// Position of the first camera in the axes of the second one, m.
    pub translation_m: [f64; 3],
}

impl RelativePose {
    /// A point in the axes of the second camera.
    #[must_use]
    pub fn apply(&self, point: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = point;
        [0, 1, 2].map(|i| {
            let [a, b, c] = self.rotation[i];
            a * x + b * y + c * z + self.translation_m[i]
        })
    }
}

impl Viewpoint {
    /// The viewpoint of a frame; `None` for a scene without a pose.
    pub(crate) fn new(context: &FrameContext<'_>) -> Option<Self> {
        let pose = context.prepared.pose?;
        Some(match &context.taking {
            Some(taking) if taking.sampling.is_some() => Self {
                size: taking.parts.size,
                pose,
                optics: ViewOptics::Lens(taking.parts.lens),
            },
            _ => Self {
                size: context.setting.size,
                pose,
                optics: ViewOptics::Pinhole(context.prepared.view().camera),
            },
        })
    }

    /// The viewpoint of another frame of a procedural scene. Takes the optics of `self` if both have the same camera.
    pub(crate) fn of_sibling(
        &self,
        own: &Camera,
        frame: &Frame,
        pose: CameraPose,
    ) -> Result<Self, RenderError> {
        let camera = &frame.camera;
        let is_same = Camera {
            path: own.path,
            ..camera.clone()
        } == *own;
        if is_same {
            return Ok(Self { pose, ..*self });
        }
        let lens = rendered_parts(frame)?.filter(|parts| parts.source.is_some());
        let (width, height) = (camera.width, camera.height);
        let pinhole = Intrinsics::centered(camera.focal_px(width), width, height);
        Ok(Self {
            size: (width, height),
            pose,
            optics: lens.map_or(ViewOptics::Pinhole(pinhole), |parts| ViewOptics::Lens(parts.lens)),
        })
    }

    /// The unit vector along the ray through a position of the picture in px, in camera axes (right, down, ahead); `None` where
    /// the lens has no inverse.
    #[must_use]
    pub fn ray(&self, [x, y]: [f64; 2]) -> Option<[f64; 3]> {
        let ray: DVec3 = match &self.optics {
            ViewOptics::Pinhole(camera) => camera.ray(x, y),
            ViewOptics::Lens(lens) => {
                let air = lens.camera.ray(x, y);
                let (u, v) = lens.in_water(lens.undistorted(air.x, air.y)?, 1);
                vec3(u, v, 1.0)
            }
        };
        Some(ray.normalized().into())
    }

    /// Position in the picture of a point in camera axes, px; `None` for a point behind the camera or beyond the view of a port.
    /// May be outside the picture.
    #[must_use]
    pub fn project(&self, [x, y, z]: [f64; 3]) -> Option<[f64; 2]> {
        if z <= 0.0 {
            return None;
        }
        let (u, v) = (x / z, y / z);
        match &self.optics {
            ViewOptics::Pinhole(camera) => {
                Some([camera.cx + camera.focal_px * u, camera.cy + camera.focal_px * v])
            }
            ViewOptics::Lens(lens) => lens.pixel_of((u, v)).map(Into::into),
        }
    }

    /// Whether a position is in the picture.
    #[must_use]
    pub fn contains(&self, [x, y]: [f64; 2]) -> bool {
        let (width, height) = (self.size.0 as f64, self.size.1 as f64);
        (-0.5..width - 0.5).contains(&x) && (-0.5..height - 0.5).contains(&y)
    }

    /// The map of points from the axes of this camera to those of another.
    #[must_use]
    pub fn relative_to(&self, other: &Self) -> RelativePose {
        let own = axes(&self.pose);
        RelativePose {
            rotation: axes(&other.pose).map(|axis| own.map(|column| axis.dot(column))),
            translation_m: other.pose.to_camera(self.pose.position_m).into(),
        }
    }
}

fn axes(pose: &CameraPose) -> [DVec3; 3] {
    [pose.right, pose.down, pose.ahead]
}
