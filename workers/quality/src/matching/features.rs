//! Oriented FAST corners with steered BRIEF descriptors, after ORB (Rublee, Rabaud, Konolige and Bradski 2011).
//!
//! Level l of the pyramid has a share of the budget proportional to `1.2^-l`. Of its corners above the threshold the
//! twice as many with the highest FAST score (and all that equal the last of them) are ranked by Harris' response, of
//! which the share is kept; of equal responses the first, row by row.
//!
//! The adaptive threshold is 0, so the ranking alone decides: a level yields its share unless it has fewer corners of
//! any contrast. An offset of all codes leaves every score and response, and a gain g multiplies them by g and g⁴; both
//! leave the ranking, so brightness and contrast do not change the features, up to the rounding and clipping of codes.
//! The fixed threshold of 20 codes is OpenCV's default.

use imaging::{Plane, Rgb8, vectorized};

use super::descriptor::{self, Descriptor};
use super::fast::{self, Corner};
use super::harris;
use super::orientation;
use super::patch_mask::PatchMask;
use super::pyramid::{self, LEVELS, REACH_PX, SCALE};

/// Most features of a picture.
pub const FEATURE_BUDGET: usize = 1000;

/// Smallest contrast of a feature.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Threshold {
    /// The lowest that fills the budget.
    Adaptive,
    /// More than 20 codes.
    Default,
}

impl Threshold {
    /// A corner's score is above this.
    fn codes(self) -> u8 {
        match self {
            Self::Adaptive => 0,
            Self::Default => 20,
        }
    }
}

/// A feature's position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Keypoint {
    /// Column in pixels of the picture; the center of the first pixel is 0.5.
    pub x: f32,
    /// Row in pixels of the picture; the center of the first pixel is 0.5.
    pub y: f32,
    /// Level of the pyramid, 0..=7.
    pub level: u8,
    /// Harris' response at its level.
    pub response: f64,
}

/// The features of a picture at one threshold.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Features {
    /// Positions, level by level, the strongest first.
    pub keypoints: Vec<Keypoint>,
    /// The 256 bits of each keypoint.
    pub descriptors: Vec<Descriptor>,
}

/// The features of a frame at both thresholds, kept for the next frames of its path.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FrameFeatures {
    /// At the adaptive threshold.
    pub adaptive: Features,
    /// At the fixed threshold.
    pub default: Features,
}

impl Features {
    /// Number of features.
    #[must_use]
    pub fn count(&self) -> usize {
        self.keypoints.len()
    }

    /// Adds the features of another picture from an index on.
    fn extend_from(&mut self, other: &Self, first: usize) {
        self.keypoints.extend(&other.keypoints[first..]);
        self.descriptors.extend(&other.descriptors[first..]);
    }
}

impl FrameFeatures {
    /// Finds the features of a picture. With a mask only those whose patch, 37 × 37 pixels at its level, touches no pixel
    /// of value 0. A picture without room for a patch has none.
    ///
    /// # Panics
    /// If the mask has another size.
    #[must_use]
    pub fn find(picture: &Rgb8, mask: Option<&Plane<u8>>) -> Self {
        if let Some(mask) = mask {
            assert_eq!(
                mask.size(),
                (picture.width(), picture.height()),
                "a mask covers its picture"
            );
        }
        let patches = mask.map(PatchMask::new);
        let mut features = Self::default();
        for (level, gray) in pyramid::build(picture.to_gray8()).iter().enumerate() {
            let scale = [
                picture.width() as f64 / gray.width() as f64,
                picture.height() as f64 / gray.height() as f64,
            ];
            let mut corners = fast::find_corners(gray, REACH_PX);
            if let Some(patches) = &patches {
                corners.retain(|corner| patches.contains(patch(*corner, scale)));
            }
            let described = DescribedLevel {
                gray,
                smoothed: descriptor::smooth(gray),
                level: level as u8,
                scale,
            };
            let [adaptive, default] = [Threshold::Adaptive, Threshold::Default]
                .map(|threshold| candidates(&corners, threshold, 2 * share(level)));
            let added = described.add(&adaptive, &mut features.adaptive);
            if default == adaptive {
                features.default.extend_from(&features.adaptive, added);
            } else {
                described.add(&default, &mut features.default);
            }
        }
        features
    }

    /// The features at a threshold.
    #[must_use]
    pub fn with_threshold(&self, threshold: Threshold) -> &Features {
        match threshold {
            Threshold::Adaptive => &self.adaptive,
            Threshold::Default => &self.default,
        }
    }
}

/// A level's share of the budget. The shares of all levels add up to it.
fn share(level: usize) -> usize {
    let sum_below = |level: usize| {
        let portion = (1.0 - SCALE.powi(-(level as i32))) / (1.0 - SCALE.powi(-(LEVELS as i32)));
        (FEATURE_BUDGET as f64 * portion).round() as usize
    };
    sum_below(level + 1) - sum_below(level)
}

/// The square around a corner of a level in pixels of the picture.
fn patch(corner: Corner, [across, down]: [f64; 2]) -> [f64; 4] {
    let (x, y, reach) = (f64::from(corner.x), f64::from(corner.y), REACH_PX as f64);
    [
        (x - reach) * across,
        (y - reach) * down,
        (x + reach + 1.0) * across,
        (y + reach + 1.0) * down,
    ]
}

/// The corners above a threshold with the highest scores: `wanted`, and all that equal the last of them.
fn candidates(corners: &[Corner], threshold: Threshold, wanted: usize) -> Vec<Corner> {
    let mut counts = [0usize; 256];
    for corner in corners {
        counts[usize::from(corner.score)] += 1;
    }
    let mut cut = 255;
    let mut above = counts[255];
    while above < wanted && cut > usize::from(threshold.codes()) + 1 {
        cut -= 1;
        above += counts[cut];
    }
    let kept = corners.iter().filter(|corner| usize::from(corner.score) >= cut);
    kept.copied().collect()
}

/// A level with the planes that its features are computed from.
struct DescribedLevel<'a> {
    gray: &'a Plane<u8>,
    smoothed: Plane<u8>,
    level: u8,
    scale: [f64; 2],
}

impl DescribedLevel<'_> {
    /// Adds the strongest of the corners and returns the index of the first.
    fn add(&self, corners: &[Corner], features: &mut Features) -> usize {
        let first = features.keypoints.len();
        let mut ranked: Vec<(f64, Corner)> = corners.iter().map(|&corner| (0.0, corner)).collect();
        vectorized!(rank(self.gray, &mut ranked));
        // The order of equal responses is that of the corners: the sort is stable.
        ranked.sort_by(|(one, _), (other, _)| other.total_cmp(one));
        ranked.truncate(share(usize::from(self.level)));
        features
            .keypoints
            .extend(ranked.iter().map(|&(response, corner)| Keypoint {
                x: ((f64::from(corner.x) + 0.5) * self.scale[0]) as f32,
                y: ((f64::from(corner.y) + 0.5) * self.scale[1]) as f32,
                level: self.level,
                response,
            }));
        vectorized!(describe_all(
            self.gray,
            &self.smoothed,
            &ranked,
            &mut features.descriptors
        ));
        first
    }
}

#[inline(always)]
fn rank(gray: &Plane<u8>, ranked: &mut [(f64, Corner)]) {
    for (response, corner) in ranked {
        *response = harris::response(gray, corner.x as usize, corner.y as usize);
    }
}

#[inline(always)]
fn describe_all(
    gray: &Plane<u8>,
    smoothed: &Plane<u8>,
    ranked: &[(f64, Corner)],
    descriptors: &mut Vec<Descriptor>,
) {
    for (_, corner) in ranked {
        let (x, y) = (corner.x as usize, corner.y as usize);
        let direction = orientation::find_direction(gray, x, y);
        descriptors.push(descriptor::describe(smoothed, x, y, direction));
    }
}
