//! Marine snow: illuminated particles in the water.
//!
//! The water is cut into cells of the world; each holds a Poisson number of particles, uniform within it, with log-normal radii r.
//! Every number has an address (seed, world, cell, particle), so the particles are the same for any camera, order and number of
//! threads. A particle at the depth z along the axis and the range R along its ray is a Gaussian disc with `σ = max(f r/z, 1/2)`
//! pixels, with the opacity `(f r/(z σ))² e^{−c R}` in its middle: one smaller than a pixel is dimmed by its share of the area. Its
//! color is albedo × incident light. It is composited over the background, the farthest first, if R is less than the range of the
//! pixel. The attenuation of the opacity accounts for the water in front; the sprites of UWSim fade in the same way (Prats, Pérez,
//! Fernández, Sanz 2012).

mod fast;
mod flakes;
mod lit;
mod reference;
mod spot;

pub use fast::snow;
pub use flakes::{Flake, flakes};
pub use lit::{LitFlake, lit, peak};
pub use reference::snow_reference;
pub use spot::Spot;

use imaging::Plane;
use imaging::geometry::Intrinsics;
use spec::{Beyond, Snow};

use crate::eye::Eye;

/// Most particles that a frame may be expected to hold.
pub const MOST_PARTICLES: f64 = 400_000.0;
/// Largest share of the frame that the particles may be expected to cover.
pub const MOST_COVER: f64 = 1.0;
/// The largest radius of Junge's law over the least: a spectrum of marine particles is followed over about a decade of sizes
/// (McCave 1984; Jackson et al. 1997 measured slopes of diameters between 3 and 4 with several instruments).
const RADII: f64 = 10.0;

/// Everything wrong with it.
#[must_use]
pub fn validate(snow: &Snow) -> Vec<Beyond> {
    let mut errors = spec::beyond(snow);
    if !errors.is_empty() {
        return errors;
    }
    if snow.near_m >= snow.far_m {
        errors.push(Beyond {
            field: "near_m",
            part: None,
            value: snow.near_m,
            limit: format!("below `far_m`, {}", snow.far_m),
        });
    }
    let covered = cover(snow, 0.0);
    if covered > MOST_COVER {
        errors.push(Beyond {
            field: "density_per_m3",
            part: None,
            value: snow.density_per_m3,
            limit: format!(
                "at most {:.3e} with these radii and depths, or the particles cover the whole frame",
                snow.density_per_m3 / covered * MOST_COVER
            ),
        });
    }
    errors
}

/// Refuses more particles in view than [`MOST_PARTICLES`]. `solid` is the cross-section of the view at a depth of 1 m, m²:
/// `W H / f²`.
///
/// # Errors
/// The density, with the greatest one for this view.
pub fn check_count(snow: &Snow, solid: f64) -> Result<(), Beyond> {
    let count = expected(snow, solid);
    if count <= MOST_PARTICLES {
        return Ok(());
    }
    Err(Beyond {
        field: "density_per_m3",
        part: None,
        value: snow.density_per_m3,
        limit: format!(
            "at most {:.3e} in this view, which then holds {MOST_PARTICLES} particles",
            snow.density_per_m3 / count * MOST_PARTICLES
        ),
    })
}

/// Particles expected in view: n times the volume of the frustum, `n (W H / f²) (z_f³ − z_n³)/3`.
#[must_use]
pub fn expected(snow: &Snow, solid: f64) -> f64 {
    snow.density_per_m3 * solid * (snow.far_m.powi(3) - snow.near_m.powi(3)).max(0.0) / 3.0
}

/// Share of the frame that the particles are expected to cover, each pixel by its opacity:
/// `2π n E[r²] (e^{−c z_n} − e^{−c z_f})/c` in a water of the attenuation c, half of it with the discs of a lens. `E[r²]` is
/// `median² e^{2 s²}` of log-normal radii.
#[must_use]
pub fn cover(snow: &Snow, attenuation: f64) -> f64 {
    let length = snow.far_m - snow.near_m;
    let thinned = if attenuation * length > 1e-9 {
        (-attenuation * snow.near_m).exp() * -(-attenuation * length).exp_m1() / attenuation
    } else {
        length
    };
    std::f64::consts::PI * snow.density_per_m3 * mean_square(snow) * thinned
}

/// `E[r²]`, m², of Junge's law between r and R r with the slope s: `r² (s − 1)/(3 − s) (R^{3−s} − 1)/(1 − R^{1−s})`.
fn mean_square(snow: &Snow) -> f64 {
    let slope = snow.spectrum;
    let rest = 3.0 - slope;
    let grown = if rest.abs() < 1e-9 {
        RADII.ln()
    } else {
        (RADII.powf(rest) - 1.0) / rest
    };
    snow.radius_m.powi(2) * (slope - 1.0) * grown / (1.0 - RADII.powf(1.0 - slope))
}

/// Whether it may be omitted: its density is 0, or expected pixels × contrast ≤ tolerance. `pixels` of the frame, the least
/// attenuation of the three channels in 1/m, and the largest difference between a particle and its background.
#[must_use]
pub fn is_needless(snow: &Snow, pixels: usize, attenuation: f64, contrast: f64, tolerance: f64) -> bool {
    snow.density_per_m3 == 0.0 || cover(snow, attenuation) * pixels as f64 * contrast <= tolerance
}

/// The largest radius.
fn largest_m(snow: &Snow) -> f64 {
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
    fn most_blur_px(&self, snow: &Snow) -> f64 {
        (self.blur_px)(snow.near_m).max((self.blur_px)(snow.far_m))
    }
}

/// Radiance of white particles at some points in camera axes, of each R, G and B.
pub type WhiteLight<'a> = &'a dyn Fn(&[[f64; 3]]) -> Vec<[f64; 3]>;

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
    /// Radiance of a white particle at each of some points in camera axes.
    pub light: WhiteLight<'a>,
}

/// Cross-section of a view at a depth of 1 m, m²: `W H / f²`.
#[must_use]
pub fn solid(camera: &Intrinsics, (width, height): (usize, usize)) -> f64 {
    width as f64 * height as f64 / (camera.focal_px * camera.focal_px)
}

#[cfg(test)]
mod tests;
