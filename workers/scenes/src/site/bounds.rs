//! Axis-aligned bounding boxes.

use imaging::vector::{Vec3, vec3};

use super::lanes::{larger, smaller};

/// A box between its lowest and its highest corner, m.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Bounds {
    pub(crate) low: Vec3,
    pub(crate) high: Vec3,
}

/// Larger than any site.
pub(super) const EVERYWHERE_M: f32 = 1e9;

impl Bounds {
    /// A box without points.
    pub(crate) const EMPTY: Self = Self {
        low: vec3(f32::INFINITY, f32::INFINITY, f32::INFINITY),
        high: vec3(f32::NEG_INFINITY, f32::NEG_INFINITY, f32::NEG_INFINITY),
    };

    /// A box about the origin with the given half sides.
    pub(crate) fn about_origin(half: Vec3) -> Self {
        Self {
            low: -half,
            high: half,
        }
    }

    /// A box about the z axis, from 0 to `length`.
    pub(crate) fn along_z(half: f32, length: f32) -> Self {
        Self {
            low: vec3(-half, -half, 0.0),
            high: vec3(half, half, length),
        }
    }

    pub(crate) fn from_point(place: Vec3) -> Self {
        Self {
            low: place,
            high: place,
        }
    }

    pub(super) fn half_space(height: f32) -> Self {
        Self {
            low: vec3(-EVERYWHERE_M, -EVERYWHERE_M, -EVERYWHERE_M),
            high: vec3(EVERYWHERE_M, EVERYWHERE_M, height),
        }
    }

    /// The box around a group of points.
    #[inline(always)]
    pub(crate) fn from_points<const COUNT: usize>(points: &[[f32; COUNT]; 3]) -> Self {
        const WIDE: usize = 8;
        let (mut low, mut high) = ([[0.0; WIDE]; 3], [[0.0; WIDE]; 3]);
        for axis in 0..3 {
            low[axis].copy_from_slice(&points[axis][..WIDE]);
            high[axis].copy_from_slice(&points[axis][..WIDE]);
            for chunk in 1..COUNT / WIDE {
                for i in 0..WIDE {
                    let p = points[axis][chunk * WIDE + i];
                    low[axis][i] = smaller(p, low[axis][i]);
                    high[axis][i] = larger(p, high[axis][i]);
                }
            }
        }
        Self {
            low: low
                .map(|lane| lane.into_iter().fold(f32::INFINITY, smaller))
                .into(),
            high: high
                .map(|lane| lane.into_iter().fold(f32::NEG_INFINITY, larger))
                .into(),
        }
    }

    /// The box enlarged by `margin` meters on every side.
    pub(crate) fn grown(&self, margin: f32) -> Self {
        let margin = vec3(margin, margin, margin);
        Self {
            low: self.low - margin,
            high: self.high + margin,
        }
    }

    /// The corners `low` and `high`.
    pub(crate) fn ends(&self) -> [[f32; 3]; 2] {
        [self.low.into(), self.high.into()]
    }

    pub(crate) fn union(&self, other: &Self) -> Self {
        Self {
            low: self.low.zip(other.low, smaller),
            high: self.high.zip(other.high, larger),
        }
    }

    /// Whether two boxes come within `reach` meters of each other along every axis.
    pub(super) fn touches(&self, other: &Self, reach: f32) -> bool {
        let reach = vec3(reach, reach, reach);
        let (low, high) = (self.low - reach, self.high + reach);
        low.x <= other.high.x
            && other.low.x <= high.x
            && low.y <= other.high.y
            && other.low.y <= high.y
            && low.z <= other.high.z
            && other.low.z <= high.z
    }
}
