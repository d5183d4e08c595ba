//! The finished picture of a frame, with what later frames of its path compare with.

use std::sync::{Arc, Mutex, PoisonError};

use imaging::{Plane, Rgb8};
use quality::{FrameFeatures, Motion};
use scenes::World;
use spec::Enhancement;

use super::motion::{PixelRays, find_motion_of};
use super::viewpoint::Viewpoint;
use crate::context::FrameContext;

/// The finished picture of a frame.
pub struct Held {
    /// The picture in 8 bits, after sensor and compression.
    pub rgb: Rgb8,
    /// Range of every pixel of the picture, m; `None` if the scene has none.
    pub range: Option<Plane<f32>>,
    /// Its camera.
    pub viewpoint: Viewpoint,
    pixels: PixelRays,
    world: Option<Arc<World>>,
    /// Features of the picture (`None`) and of its enhancements.
    features: Mutex<Vec<(Option<Enhancement>, Arc<FrameFeatures>)>>,
}

impl Held {
    /// The picture of a frame; `None` for a scene without a pose.
    pub(crate) fn new(context: &FrameContext<'_>, rgb: &Rgb8) -> Option<Self> {
        Some(Self {
            rgb: rgb.clone(),
            range: context.range().cloned(),
            viewpoint: Viewpoint::new(context)?,
            pixels: PixelRays::new(context),
            world: context.prepared.world.clone(),
            features: Mutex::default(),
        })
    }

    /// The known features of the picture or of an enhancement.
    pub(crate) fn features(&self, of: Option<&Enhancement>) -> Option<Arc<FrameFeatures>> {
        let known = self.features.lock().unwrap_or_else(PoisonError::into_inner);
        let found = known.iter().find(|(own, _)| own.as_ref() == of);
        found.map(|(_, features)| Arc::clone(features))
    }

    /// Finds and keeps the features of a picture. `mask` excludes pixels of value 0.
    pub(crate) fn find_features(
        &self,
        of: Option<&Enhancement>,
        picture: &Rgb8,
        mask: Option<&Plane<u8>>,
    ) -> Arc<FrameFeatures> {
        let found = Arc::new(FrameFeatures::find(picture, mask));
        let mut known = self.features.lock().unwrap_or_else(PoisonError::into_inner);
        known.push((of.cloned(), Arc::clone(&found)));
        found
    }

    /// Whether the motion to the previous picture can be found: this one has a range, and the previous one a world.
    pub(crate) fn can_move_to(&self, previous: &Self) -> bool {
        self.range.is_some() && previous.world.is_some()
    }

    /// The positions in the previous picture of the points at the features of this one. Other pixels have none. `None` without
    /// range or world.
    pub(crate) fn motion_to(&self, previous: &Self, features: &FrameFeatures) -> Option<Motion> {
        let (range, world) = (self.range.as_ref()?, previous.world.as_ref()?);
        let (width, height) = range.size();
        let keypoints = [&features.adaptive, &features.default].map(|features| &features.keypoints);
        let pixels = keypoints
            .into_iter()
            .flatten()
            .map(|keypoint| [keypoint.x as usize, keypoint.y as usize])
            .filter(|[x, y]| *x < width && *y < height);
        let mut motion = Motion::unknown(width, height);
        let way = [&self.viewpoint, &previous.viewpoint];
        find_motion_of(pixels, (range, &self.pixels), way, world, |pixel, moved| {
            motion.put(pixel, moved);
        });
        Some(motion)
    }
}
