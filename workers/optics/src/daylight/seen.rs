//! Occlusion of daylight by other surfaces.
//!
//! The sun is visible if its shadow ray reaches the sea's surface without occluder. Ambient occlusion is the visible share of n
//! directions about the normal, with occluders within 10/c of the clearest channel. The directions have the azimuths
//! 2.399963229728653 k and the cosines `sqrt(1 − (k + 1/2)/n)`, each weighted by the radiance Φ from there.

mod directions;
mod ordered;
mod sky;
mod sunlit;
mod veil;
mod veil_grid;

pub use sky::{access, access_reference};
pub use sunlit::{sunlit, sunlit_reference};
pub use veil::{occlude_veil, veil_access, veil_access_reference};

use imaging::Plane;
use imaging::vector::DVec3;

use super::conditions::Daylight;

/// Side of the squares in which pixels are processed, so that neighboring rays share a packet.
const SQUARE: usize = 8;

/// Surfaces in camera axes.
#[derive(Clone, Copy)]
pub struct Surfaces<'a> {
    /// Range in meters along the ray.
    pub range: &'a Plane<f32>,
    /// Unit normals that face the camera.
    pub normals: &'a [Plane<f32>; 3],
    /// Object of each pixel; `None` if unknown.
    pub objects: Option<&'a Plane<u16>>,
}

impl Surfaces<'_> {
    fn normal(&self, x: usize, y: usize) -> [f32; 3] {
        self.normals.each_ref().map(|axis| axis.pixel(x, y))
    }

    fn place(&self, daylight: &Daylight, x: usize, y: usize) -> DVec3 {
        let ray = daylight.gaze.camera.ray(x as f64, y as f64).normalized();
        ray * f64::from(self.range.pixel(x, y))
    }
}

/// Distance from a point to the surface of the sea along a unit vector that rises by this much.
fn to_sea(daylight: &Daylight, place: DVec3, rise: f64) -> f64 {
    let depth = (daylight.depth - place.dot(daylight.gaze.up.into())).max(0.0);
    if rise > 0.0 { depth / rise } else { f64::INFINITY }
}

fn single(v: DVec3) -> [f32; 3] {
    <[f64; 3]>::from(v).map(|v| v as f32)
}

#[cfg(test)]
mod tests;
