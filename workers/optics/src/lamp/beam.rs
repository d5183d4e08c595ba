//! Where a lamp shines.

/// Where a lamp shines.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Beam {
    /// In all directions.
    Point,
    /// About a unit axis, falling to 0 at the angle of this cosine.
    Spot { axis: [f64; 3], cos_cone: f64 },
}

impl Beam {
    /// Slope of the profile by the cosine to the axis.
    pub(super) fn slope(self) -> f64 {
        match self {
            Self::Point => 0.0,
            Self::Spot { cos_cone, .. } => 1.0 / (1.0 - cos_cone),
        }
    }

    /// Share of the intensity in a direction, whose cosine to the axis is `cosine(axis)`.
    pub(super) fn profile(self, cosine: impl Fn([f64; 3]) -> f64) -> f64 {
        match self {
            Self::Point => 1.0,
            Self::Spot { axis, cos_cone } => ((cosine(axis) - cos_cone) / (1.0 - cos_cone)).clamp(0.0, 1.0),
        }
    }

    /// The same in f32.
    pub(super) fn single(self) -> Profile {
        let (axis, cos_cone, offset) = match self {
            Self::Point => ([0.0; 3], 0.0, 1.0),
            Self::Spot { axis, cos_cone } => (axis, cos_cone, -cos_cone * self.slope()),
        };
        Profile {
            axis: axis.map(|v| v as f32),
            cone: cos_cone.acos() as f32,
            cos_cone: cos_cone as f32,
            offset: offset as f32,
            slope: self.slope() as f32,
        }
    }
}

/// The profile `offset + slope cos`, clamped to 0..=1. A point lamp is a spot without axis whose profile is 1 everywhere.
#[derive(Clone, Copy)]
pub(super) struct Profile {
    pub(super) axis: [f32; 3],
    /// The angle of the cone in radians, and its cosine.
    pub(super) cone: f32,
    pub(super) cos_cone: f32,
    pub(super) offset: f32,
    pub(super) slope: f32,
}
