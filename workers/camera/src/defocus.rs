//! Blur of what is out of focus: each pixel gathers over a disc as large as its own circle of confusion.
//!
//! `r_b = f (A/2) |1/v(Z) - 1/v(Z_f)|` pixels at range Z: f of the lens in air, A the diameter of the aperture, Z_f what is in
//! focus. v(Z) is where the lens sees a point: Z in air, Z/n behind a flat port, and behind a dome of radius r_d at
//! `r_d + 1/((n-1)/r_d + n/(Z - r_d))`. A pixel of the disc weighs the share of its 8×8 points within the radius; the border
//! is mirrored with its edge. What is near does not bleed over the edge of what is behind it: each pixel knows its own range alone.
//!
//! Weights are at least 0 and sum to 1, so an error of the light does not grow (gain 1). The fast form has the same discs and
//! errs by rounding alone.

mod counts;
mod gather;
mod reference;

pub use gather::{blur, rounding_bound};
pub use reference::blur_reference;

use imaging::{Plane, vectorized};
use spec::{Defocus, Port};

use crate::geometry::SEA_WATER;

/// Below this radius in pixels a disc holds points of a single pixel and is the identity: the nearest points of the next pixel
/// are more than 9/16 away.
pub const SHARP_PX: f64 = 0.5625;
/// Largest radius in pixels: more light than that of a disc of 129 pixels is beyond what a gather of this kind is for.
pub const MOST_PX: f64 = 64.0;
/// Points of a pixel along a side.
const POINTS: usize = 8;

/// The circle of confusion of a lens by range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Focus {
    /// `f A/2`, pixels times meters.
    scale: f64,
    /// 1/v of what is in focus, 1/m.
    sharp: f64,
    port: Option<Port>,
}

impl Focus {
    /// That of a lens with this focal length in air, in pixels.
    #[must_use]
    pub fn new(law: Defocus, focal_px: f64, port: Option<Port>) -> Self {
        Self {
            scale: focal_px * law.aperture_m / 2.0,
            sharp: nearness(law.focus_m, port),
            port,
        }
    }

    /// The radius in pixels of what is at a range in the water, at most [`MOST_PX`]; no range is infinitely far.
    #[must_use]
    #[inline(always)]
    pub fn radius_px(&self, range_m: f64) -> f64 {
        let is_there = range_m.is_finite() && range_m > 0.0;
        let range_m = if is_there { range_m } else { f64::INFINITY };
        (self.scale * (nearness(range_m, self.port) - self.sharp).abs()).min(MOST_PX)
    }

    /// The largest radius in pixels of ranges between these two. Pass infinity as the farthest one if pixels have no range.
    #[must_use]
    pub fn largest_px(&self, nearest_m: f64, farthest_m: f64) -> f64 {
        // The radius falls and rises again with the range.
        self.radius_px(nearest_m).max(self.radius_px(farthest_m))
    }

    /// The radius of every pixel, in f64: the disc of a pixel depends on the last bit.
    #[must_use]
    pub fn radii(&self, range: &Plane<f32>) -> Plane<f64> {
        let (width, height) = range.size();
        let mut radii = Plane::filled(width, height, 0.0);
        for y in 0..height {
            let (range, radii) = (range.row(y), radii.row_mut(y));
            vectorized!(radii_row(self, range, &mut *radii));
        }
        radii
    }
}

#[inline(always)]
fn radii_row(focus: &Focus, range: &[f32], radii: &mut [f64]) {
    let focus = *focus;
    for (radius, &meters) in radii.iter_mut().zip(range) {
        *radius = focus.radius_px(f64::from(meters));
    }
}

/// `1/v(Z)`, 1/m.
#[inline(always)]
fn nearness(range_m: f64, port: Option<Port>) -> f64 {
    match port {
        None | Some(Port::None {}) => 1.0 / range_m,
        Some(Port::Flat { .. }) => SEA_WATER[1] / range_m,
        Some(Port::Dome { radius_m }) => {
            let n = SEA_WATER[1];
            // What touches the dome is seen at the dome.
            let beyond = (range_m - radius_m).max(0.0);
            1.0 / (radius_m + 1.0 / ((n - 1.0) / radius_m + n / beyond))
        }
    }
}

/// The index inside `0..n` that stands for `i`: `c b a | a b c | c b a`, any way outside.
fn mirrored(i: isize, n: usize) -> usize {
    let folded = i.rem_euclid(2 * n as isize);
    folded.min(2 * n as isize - 1 - folded) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_in_focus_is_sharp_and_blur_grows_away_from_it() {
        let law = Defocus {
            aperture_m: 0.01,
            focus_m: 1.0,
        };
        let dome = Port::Dome { radius_m: 0.1 };
        for port in [None, Some(dome)] {
            let focus = Focus::new(law, 800.0, port);
            assert_eq!(focus.radius_px(1.0), 0.0);
            assert!(focus.radius_px(2.0) > 0.5 && focus.radius_px(4.0) > focus.radius_px(2.0));
            assert_eq!(focus.radius_px(f64::NAN), focus.radius_px(f64::INFINITY));
            assert!(focus.radius_px(0.05) <= MOST_PX);
        }
        // In air: 800 * 0.005 * (1 - 1/2).
        assert!((Focus::new(law, 800.0, None).radius_px(2.0) - 2.0).abs() < 1e-12);
    }

    #[test]
    fn the_largest_radius_is_that_of_every_range_between() {
        let flat = Port::Flat {
            pupil_m: 0.0,
            glass_m: 0.0,
        };
        let dome = Port::Dome { radius_m: 0.1 };
        for port in [None, Some(flat), Some(dome)] {
            for focus_m in [0.05, 0.7, 1000.0] {
                let law = Defocus {
                    aperture_m: 0.01,
                    focus_m,
                };
                let focus = Focus::new(law, 800.0, port);
                let known = Plane::from_fn(500, 1, |x, _| 0.05 * 1.02f32.powi(x as i32));
                let holes = known.map(|&meters| if meters > 3.0 { f32::NAN } else { meters });
                let farthest = f64::from(known.pixel(499, 0));
                for (range, farthest) in [(known, farthest), (holes, f64::INFINITY)] {
                    let radii = focus.radii(&range);
                    let largest = radii.data().iter().copied().fold(0.0, f64::max);
                    let nearest = f64::from(range.pixel(0, 0));
                    assert_eq!(largest, focus.largest_px(nearest, farthest));
                    let pairs = radii.data().iter().zip(range.data());
                    for (&radius, &meters) in pairs {
                        assert_eq!(radius, focus.radius_px(f64::from(meters)));
                    }
                }
            }
        }
    }

    #[test]
    fn a_dome_shows_infinity_at_four_radii() {
        let dome = Port::Dome { radius_m: 0.1 };
        let far = 1.0 / nearness(f64::INFINITY, Some(dome));
        assert!((far / 0.1 - 3.94).abs() < 0.01, "{far}");
    }
}
