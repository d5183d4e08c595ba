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
mod world;

pub use fast::{is_in_front, snow};
pub use flakes::{Flake, flakes};
pub use lit::{LitFlake, lit, peak};
pub use reference::snow_reference;
pub use spot::Spot;

use imaging::geometry::Intrinsics;
use spec::{Beyond, Snow};

use world::mean_square;
pub use world::{Seeing, Surround, WhiteLight, World};

/// Most particles that a frame may be expected to hold.
pub const MOST_PARTICLES: f64 = 400_000.0;
/// Largest share of the frame that the particles may be expected to cover.
pub const MOST_COVER: f64 = 1.0;
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

/// Whether it may be omitted: its density is 0, or expected pixels × contrast ≤ tolerance. `pixels` of the frame, the least
/// attenuation of the three channels in 1/m, and the largest difference between a particle and its background.
#[must_use]
pub fn is_needless(snow: &Snow, pixels: usize, attenuation: f64, contrast: f64, tolerance: f64) -> bool {
    snow.density_per_m3 == 0.0 || cover(snow, attenuation) * pixels as f64 * contrast <= tolerance
}

/// Cross-section of a view at a depth of 1 m, m²: `W H / f²`.
#[must_use]
pub fn solid(camera: &Intrinsics, (width, height): (usize, usize)) -> f64 {
    width as f64 * height as f64 / (camera.focal_px * camera.focal_px)
}

#[cfg(test)]
mod tests;
