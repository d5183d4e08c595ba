//! A picture with everything that metrics compare it with.

use imaging::vector::DVec3;
use imaging::{Plane, Rgb8};

use crate::illumination::Illumination;
use crate::matching::features::FrameFeatures;
use crate::matching::motion::Motion;
use crate::pose::rays::RelativePose;

/// A picture to measure.
#[derive(Clone, Copy)]
pub struct Subject<'a> {
    /// 8-bit sRGB codes.
    pub picture: &'a Rgb8,
    /// The clean picture, of the same size.
    pub clean: Option<&'a Rgb8>,
    /// Only pixels of values other than 0 count.
    pub mask: Option<&'a Plane<u8>>,
    /// The previous frames.
    pub sequence: Option<&'a Sequence<'a>>,
    /// The true illumination, prepared with the same mask.
    pub illumination: Option<&'a Illumination>,
}

impl<'a> Subject<'a> {
    /// The picture alone.
    #[must_use]
    pub fn new(picture: &'a Rgb8) -> Self {
        Self {
            picture,
            clean: None,
            mask: None,
            sequence: None,
            illumination: None,
        }
    }
}

/// A frame's place in a camera path. The features of all frames are of the same kind of picture, each found with the mask
/// of its frame.
#[derive(Clone, Copy)]
pub struct Sequence<'a> {
    /// Features of the picture.
    pub features: &'a FrameFeatures,
    /// The frames before, the newest first; empty for the first frame of a path.
    pub previous: &'a [PreviousFrame<'a>],
    /// The camera's motion from the newest of them.
    pub camera: Option<CameraMotion<'a>>,
}

/// A frame before the picture.
#[derive(Clone, Copy)]
pub struct PreviousFrame<'a> {
    /// Its features.
    pub features: &'a FrameFeatures,
    /// Positions in this frame of the pixels of the next.
    pub motion: &'a Motion,
}

/// The ray of a position (x, y), in camera axes: right, down, ahead. Positions are in pixels of the picture, the center of
/// the first pixel is (0.5, 0.5). Rays need not have length 1.
pub type RayOf<'a> = &'a dyn Fn(f64, f64) -> DVec3;

/// The true motion of the camera between the previous frame and the picture.
#[derive(Clone, Copy)]
pub struct CameraMotion<'a> {
    /// Rays of the picture.
    pub current: RayOf<'a>,
    /// Rays of the previous frame.
    pub previous: RayOf<'a>,
    /// The true pose.
    pub pose: RelativePose,
    /// Angle of a pixel in the center of the picture, rad.
    pub pixel_rad: f64,
    /// Address of RANSAC's samples in the random stream.
    pub seed: u64,
}
