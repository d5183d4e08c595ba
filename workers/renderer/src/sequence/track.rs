//! The last pictures of a camera path, for metrics that follow features from frame to frame.

use std::sync::Arc;

use imaging::vector::{DVec3, vec3};
use quality::{FrameFeatures, Motion};

use super::held::Held;

/// The last pictures of a path, the newest first.
pub(crate) struct Track {
    pub(crate) pictures: Vec<Arc<Held>>,
}

impl Track {
    /// The track of these pictures up to the first unknown motion.
    pub(crate) fn new(mut pictures: Vec<Arc<Held>>) -> Self {
        let pairs = pictures.windows(2);
        let count = pairs.take_while(|pair| pair[0].can_move_to(&pair[1])).count();
        pictures.truncate(count + 1);
        Self { pictures }
    }

    /// The motion from each picture but the last to the one after it in the list, at the features of each.
    pub(crate) fn motions(&self, features: &[Arc<FrameFeatures>]) -> Vec<Motion> {
        let pairs = self.pictures.windows(2).zip(features);
        let motions = pairs.map_while(|(pair, features)| pair[0].motion_to(&pair[1], features));
        motions.collect()
    }

    /// The ray of a position of a picture, in pixels with the center of the first at 0.5. Straight ahead where the lens has
    /// no inverse.
    pub(crate) fn ray(&self, picture: usize, x: f64, y: f64) -> DVec3 {
        let viewpoint = &self.pictures[picture].viewpoint;
        viewpoint
            .ray([x - 0.5, y - 0.5])
            .map_or(vec3(0.0, 0.0, 1.0), Into::into)
    }

    /// Angle of the pixel in the center of the newest picture, rad.
    pub(crate) fn pixel_rad(&self) -> f64 {
        let (width, height) = self.pictures[0].viewpoint.size;
        let (x, y) = (width as f64 / 2.0, height as f64 / 2.0);
        let [one, other] = [0.0, 1.0].map(|step| self.ray(0, x + step, y));
        one.cross(other).length().atan2(one.dot(other))
    }
}
