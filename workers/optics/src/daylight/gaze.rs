//! Where a camera looks, against the vertical.

use imaging::geometry::Intrinsics;
use imaging::vector::DVec3;

/// A camera and where up is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Gaze {
    /// The camera.
    pub camera: Intrinsics,
    /// Unit vector against gravity in camera axes (right, down, ahead).
    pub up: [f64; 3],
    /// The horizontal directions of azimuths and positions, unit vectors in camera axes: azimuths turn from the first towards the
    /// second.
    pub(crate) level: [[f64; 3]; 2],
    /// Position of the camera along them, m.
    pub(crate) place: [f64; 2],
    /// Least and greatest cosine from the vertical of the rays of the picture.
    pub(crate) rises: (f64, f64),
    /// Width and height of the picture; `None` if its direction is unknown.
    size: Option<(usize, usize)>,
}

impl Gaze {
    /// The view of a picture of this size; `up` of any length but 0, without which the camera is level.
    #[must_use]
    pub fn new(camera: Intrinsics, (width, height): (usize, usize), up: [f64; 3]) -> Self {
        let up = DVec3::from(up);
        let length = up.length();
        let up = if length > 0.0 && length.is_finite() {
            up * (1.0 / length)
        } else {
            DVec3::from([0.0, -1.0, 0.0])
        };
        let mut gaze = Self {
            camera,
            up: up.into(),
            level: level_axes(up, [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]),
            place: [0.0; 2],
            rises: (0.0, 0.0),
            size: Some((width, height)),
        };
        gaze.rises = gaze.extremes((width, height), gaze.up);
        gaze
    }

    /// The same view of a camera in a world: `east` is the direction of the world's x axis and `place` the camera's position in
    /// meters from the world's origin, both in camera axes.
    #[must_use]
    pub fn in_world(&self, east: [f64; 3], place: [f64; 3]) -> Self {
        let level = level_axes(self.up.into(), [east, [1.0, 0.0, 0.0]]);
        let along = |axis: [f64; 3]| DVec3::from(axis).dot(place.into());
        Self {
            place: level.map(along),
            level,
            ..*self
        }
    }

    /// A level camera of known focal length and unknown direction.
    #[must_use]
    pub(crate) fn unknown(focal_px: f64) -> Self {
        Self {
            camera: Intrinsics {
                focal_px,
                cx: 0.0,
                cy: 0.0,
            },
            up: [0.0, -1.0, 0.0],
            level: [[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
            place: [0.0; 2],
            rises: (-1.0, 1.0),
            size: None,
        }
    }

    /// Least `1 − cos` of the angles between a direction, a unit vector in camera axes, and the rays of the picture.
    pub(crate) fn least_versine(&self, toward: [f64; 3]) -> f64 {
        self.size
            .map_or(0.0, |size| 1.0 - self.extremes(size, toward).1.min(1.0))
    }

    /// μ of the ray of a pixel, the cosine of its angle from the vertical: 1 up, −1 down.
    #[must_use]
    pub fn rise(&self, x: usize, y: usize) -> f64 {
        self.cosine(x, y, self.up)
    }

    /// Cosine between the ray of a pixel and a direction.
    fn cosine(&self, x: usize, y: usize, direction: [f64; 3]) -> f64 {
        let ray = self.camera.ray(x as f64, y as f64);
        (ray.dot(direction.into()) / ray.length()).clamp(-1.0, 1.0)
    }

    /// Least and greatest cosine between the rays and a direction. On a convex picture they are on its border, unless it shows the
    /// direction or its opposite.
    fn extremes(&self, (width, height): (usize, usize), direction: [f64; 3]) -> (f64, f64) {
        let (mut low, mut high) = (1.0f64, -1.0f64);
        let mut take = |x: usize, y: usize| {
            let cosine = self.cosine(x, y, direction);
            (low, high) = (low.min(cosine), high.max(cosine));
        };
        for x in 0..width {
            take(x, 0);
            take(x, height.saturating_sub(1));
        }
        for y in 0..height {
            take(0, y);
            take(width.saturating_sub(1), y);
        }
        let [ux, uy, uz] = direction;
        for sign in [1.0, -1.0] {
            if sign * uz > 0.0 {
                let Intrinsics { focal_px, cx, cy } = self.camera;
                let (x, y) = (cx + focal_px * ux / uz, cy + focal_px * uy / uz);
                let is_shown = x >= 0.0 && y >= 0.0 && x < width as f64 && y < height as f64;
                if is_shown && sign > 0.0 {
                    high = 1.0;
                } else if is_shown {
                    low = -1.0;
                }
            }
        }
        (low, high)
    }
}

/// Shorter components have an undefined direction.
const SHORTEST: f64 = 1e-3;

/// The horizontal part of the first of these directions that has one, and the direction at right angles to it and to up.
fn level_axes(up: DVec3, directions: [[f64; 3]; 2]) -> [[f64; 3]; 2] {
    let [first, second] = directions.map(|direction| {
        let direction = DVec3::from(direction);
        direction + -(up * up.dot(direction))
    });
    let east = if first.length() < SHORTEST { second } else { first };
    let east = east.normalized();
    [east.into(), up.cross(east).into()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_ray_of_a_picture_is_outside_the_extremes() {
        let camera = Intrinsics {
            focal_px: 20.0,
            cx: 13.0,
            cy: 11.0,
        };
        for up in [
            [0.0, -1.0, 0.0],
            [0.3, -0.8, 0.5],
            [0.0, 0.1, 1.0],
            [0.2, -0.1, -2.0],
        ] {
            let gaze = Gaze::new(camera, (31, 23), up);
            let (low, high) = gaze.rises;
            for y in 0..23 {
                for x in 0..31 {
                    let rise = gaze.rise(x, y);
                    assert!(rise >= low - 1e-12 && rise <= high + 1e-12, "{up:?} {x} {y}");
                }
            }
        }
        assert_eq!(Gaze::new(camera, (31, 23), [0.0, 0.1, 1.0]).rises.1, 1.0);
        assert_eq!(Gaze::new(camera, (31, 23), [0.0; 3]).up, [0.0, -1.0, 0.0]);
    }
}
