//! Sizes of particles, their world and their light.

use imaging::Plane;
use spec::Snow;

use crate::eye::Eye;
use crate::lit_point::LitPoint;

/// The largest radius of Junge's law over the least: a spectrum of marine particles is followed over about a decade of sizes
/// (McCave 1984; Jackson et al. 1997 measured slopes of diameters between 3 and 4 with several instruments).
pub(super) const RADII: f64 = 10.0;

/// `E[r²]`, m², of Junge's law between r and R r with the slope s: `r² (s − 1)/(3 − s) (R^{3−s} − 1)/(1 − R^{1−s})`.
pub(super) fn mean_square(snow: &Snow) -> f64 {
    let slope = snow.spectrum;
    let rest = 3.0 - slope;
    let grown = if rest.abs() < 1e-9 {
        RADII.ln()
    } else {
        (RADII.powf(rest) - 1.0) / rest
    };
    snow.radius_m.powi(2) * (slope - 1.0) * grown / (1.0 - RADII.powf(1.0 - slope))
}

/// The largest radius.
pub(super) fn largest_m(snow: &Snow) -> f64 {
    RADII * snow.radius_m
}

/// The particles of one world: of a seed, and of frames that share their particles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct World {
    /// Seed of the job.
    pub seed: u64,
    /// Which of its worlds: the frame, or 0 for all frames of a path.
    pub index: u64,
}

/// Effect of camera and current on particles.
#[derive(Clone, Copy)]
pub struct Seeing<'a> {
    /// Radius of the circle of confusion at a range in meters, in pixels of the picture.
    pub blur_px: &'a dyn Fn(f64) -> f64,
    /// How long the shutter is open, s.
    pub exposure_s: f64,
    /// Time that the current has carried the particles, s.
    pub time_s: f64,
}

impl Seeing<'_> {
    /// A pinhole's, at the first moment.
    pub const STILL: Seeing<'static> = Seeing {
        blur_px: &|_| 0.0,
        exposure_s: 0.0,
        time_s: 0.0,
    };

    /// The largest circle of confusion of this snow: that of its nearest or farthest particles.
    pub(super) fn most_blur_px(&self, snow: &Snow) -> f64 {
        (self.blur_px)(snow.near_m).max((self.blur_px)(snow.far_m))
    }
}

/// Radiance of white particles at some points, of each R, G and B.
pub type WhiteLight<'a> = &'a dyn Fn(&[LitPoint]) -> Vec<[f64; 3]>;

/// Surroundings of the particles.
#[derive(Clone, Copy)]
pub struct Surround<'a> {
    /// Meters along the ray to the surface, which occludes farther particles; infinite at a hole.
    pub range: &'a Plane<f32>,
    /// The camera.
    pub eye: &'a Eye,
    /// Beam attenuation c, 1/m.
    pub attenuation: [f64; 3],
    /// Meters of water of this attenuation up to a point in camera axes at this range.
    pub path: &'a dyn Fn([f64; 3], f64) -> f64,
    /// Radiance of a white particle at each of some points.
    pub light: WhiteLight<'a>,
}
