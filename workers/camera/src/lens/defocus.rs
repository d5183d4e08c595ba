//! Defocus: each pixel gathers over a disc as large as its circle of confusion.
//!
//! `r_b = f (A/2) |1/v(Z) - 1/v(Z_f)|` pixels at range Z: f is the focal length of the lens in air, A the diameter of
//! the aperture, Z_f the focus range. v(Z) is the apparent range: Z in air, Z/n behind a flat port, and behind a dome
//! of radius r_d `r_d + 1/((n-1)/r_d + n/(Z - r_d))`. The weight of a pixel in a disc is the share of its 8×8 points
//! within the radius; borders are mirrored including the edge. Blurred foregrounds do not spill over sharp backgrounds:
//! each pixel uses its own range only.
//!
//! Weights are at least 0 and sum to 1, so errors of the light do not grow (gain 1). The fast variant uses the same
//! discs and differs by rounding only.

mod counts;
mod gather;
mod reference;

pub use gather::{blur, rounding_bound};
pub use reference::blur_reference;

use imaging::{Plane, vectorized};
use spec::{Defocus, Port};

use crate::geometry::SEA_WATER;

/// Below this radius in pixels a disc contains points of a single pixel and is the identity: the nearest points of the
/// next pixel are more than 9/16 away.
pub const SHARP_PX: f64 = 0.5625;
/// Largest radius in pixels; wider discs are clamped to 129 pixels.
pub const MOST_PX: f64 = 64.0;
/// Points of a pixel along a side.
const POINTS: usize = 8;

/// The circle of confusion of a lens by range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Focus {
    /// `f A/2`, pixels times meters.
    scale: f64,
    /// 1/v at the focus range, 1/m.
    sharp: f64,
    port: Option<Port>,
}

impl Focus {
    /// For a lens of this focal length in air, in pixels.
    #[must_use]
    pub fn new(law: Defocus, focal_px: f64, port: Option<Port>) -> Self {
        Self {
            scale: focal_px * law.aperture_m / 2.0,
            sharp: nearness(law.focus_m, port),
            port,
        }
    }

    /// The radius in pixels at a range in water, at most [`MOST_PX`]; holes count as infinitely far.
    #[must_use]
    #[inline(always)]
    pub fn radius_px(&self, range_m: f64) -> f64 {
        let is_there = range_m.is_finite() && range_m > 0.0;
        let range_m = if is_there { range_m } else { f64::INFINITY };
        (self.scale * (nearness(range_m, self.port) - self.sharp).abs()).min(MOST_PX)
    }

    /// The largest radius in pixels between two ranges. Pass infinity as `farthest_m` if pixels have holes.
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
            // Contact with the dome appears at the dome.
            let beyond = (range_m - radius_m).max(0.0);
            1.0 / (radius_m + 1.0 / ((n - 1.0) / radius_m + n / beyond))
        }
    }
}

/// Mirrors an index into `0..n`, `c b a | a b c | c b a`, at any distance.
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
