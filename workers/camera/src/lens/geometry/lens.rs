//! Lens and port as maps of directions.

use imaging::geometry::Intrinsics;
use spec::{Distortion, Port};

use super::brown::{distorted, jacobian};

/// Smallest slope of the distorted radius over the ideal one: below it, neighboring directions meet in one pixel.
const LEAST_SLOPE: f64 = 0.05;
/// Refractive index of sea water of 20 °C and 35 psu at 650, 550 and 450 nm (Quan and Fry 1995). Fresh and cold water
/// differ by less than 0.007, which moves no corner of a view of 80° by more than a hundredth of the picture.
pub(crate) const SEA_WATER: [f64; 3] = [1.3377, 1.3408, 1.3459];
/// Radius, relative to the farthest corner, up to which a lens must not fold.
const BEYOND_CORNER: f64 = 1.1;
const FOLD_STEPS: usize = 256;
/// The inverse has converged after a step below this, in focal lengths.
pub(crate) const ARRIVED: f64 = 1e-13;
/// Limit on the steps of the inverse.
pub(crate) const MOST_STEPS: usize = 50;

/// PortRefraction by the port.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PortRefraction {
    /// No port, or a dome around the pupil.
    None,
    /// A flat port: `sin θ_w = sin θ_a / n` for each channel.
    Flat {
        /// Refractive index of the water, R, G, B.
        index: [f64; 3],
    },
}

/// The lens behind its port.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lens {
    /// Focal length in air and principal point, in pixels of the output.
    pub camera: Intrinsics,
    /// Distortion; all 0 for an ideal lens.
    pub distortion: Distortion,
    /// PortRefraction by the port.
    pub refraction: PortRefraction,
}

/// A lens that cannot make a picture of this size.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Fold {
    /// Two directions map to the same position.
    #[error("the lens folds: at {radius:.3} focal lengths from the axis its radius no longer grows")]
    Radius {
        /// Ideal radius over the focal length.
        radius: f64,
    },
    /// No direction maps to a pixel.
    #[error("the lens folds: no direction falls on pixel ({x}, {y})")]
    Pixel {
        /// Column.
        x: usize,
        /// Row.
        y: usize,
    },
}

/// The factor of a direction's tangent behind a flat port: `tan θ_w / tan θ_a` for `rho2 = tan² θ_a`.
#[inline(always)]
pub(crate) fn refracted(rho2: f64, index: f64) -> f64 {
    // t / ρ with s² = ρ² / ((1 + ρ²) n²), t = s / √(1 - s²): also finite on the axis.
    1.0 / ((1.0 + rho2) * index * index - rho2).sqrt()
}

impl Lens {
    /// A lens behind a described port.
    #[must_use]
    pub fn new(camera: Intrinsics, distortion: Option<Distortion>, port: Option<Port>) -> Self {
        let refraction = match port {
            Some(Port::Flat { .. }) => PortRefraction::Flat { index: SEA_WATER },
            Some(Port::None {} | Port::Dome { .. }) | None => PortRefraction::None,
        };
        Self {
            camera,
            distortion: distortion.unwrap_or_default(),
            refraction,
        }
    }

    /// Whether the channels look in different directions.
    #[must_use]
    pub fn is_chromatic(&self) -> bool {
        matches!(self.refraction, PortRefraction::Flat { index: [r, g, b] } if r != g || g != b)
    }

    /// Ratio of focal lengths of a pinhole in water with the same scale in the center.
    #[must_use]
    pub fn magnification(&self) -> f64 {
        match self.refraction {
            PortRefraction::None => 1.0,
            PortRefraction::Flat { index } => index[1],
        }
    }

    /// The ideal coordinates of distorted ones; `None` if neither fixed-point iteration nor Newton's method converges.
    #[must_use]
    pub fn undistorted(&self, xd: f64, yd: f64) -> Option<(f64, f64)> {
        let (mut x, mut y) = (xd, yd);
        for _ in 0..MOST_STEPS {
            let (dx, dy) = distorted(&self.distortion, x, y);
            let step = (dx - xd, dy - yd);
            (x, y) = (x - step.0, y - step.1);
            if step.0.abs().max(step.1.abs()) < ARRIVED {
                return Some((x, y));
            }
        }
        self.undistorted_by_newton((xd, yd))
    }

    /// Newton's method, for slopes near 0 or above 1, where fixed points attract slowly or not at all.
    fn undistorted_by_newton(&self, (xd, yd): (f64, f64)) -> Option<(f64, f64)> {
        let (mut x, mut y) = (xd, yd);
        for _ in 0..MOST_STEPS {
            let (dx, dy) = distorted(&self.distortion, x, y);
            let [[xx, xy], [yx, yy]] = jacobian(&self.distortion, x, y);
            let determinant = xx * yy - xy * yx;
            let (off_x, off_y) = (dx - xd, dy - yd);
            let step = (
                (yy * off_x - xy * off_y) / determinant,
                (xx * off_y - yx * off_x) / determinant,
            );
            (x, y) = (x - step.0, y - step.1);
            let size = step.0.abs().max(step.1.abs());
            if size < ARRIVED {
                return Some((x, y));
            }
            if !size.is_finite() {
                break;
            }
        }
        None
    }

    /// The direction in the water, as `(x/z, y/z)`, of an ideal direction in air.
    #[must_use]
    pub fn in_water(&self, (x, y): (f64, f64), channel: usize) -> (f64, f64) {
        match self.refraction {
            PortRefraction::None => (x, y),
            PortRefraction::Flat { index } => {
                let factor = refracted(x * x + y * y, index[channel]);
                (x * factor, y * factor)
            }
        }
    }

    /// The pixel that shows a direction in water; `None` beyond the port's field of view.
    #[must_use]
    pub fn pixel_of(&self, (x, y): (f64, f64)) -> Option<(f64, f64)> {
        let (x, y) = match self.refraction {
            PortRefraction::None => (x, y),
            PortRefraction::Flat { index } => {
                let tan2 = x * x + y * y;
                let sin2 = index[1] * index[1] * tan2 / (1.0 + tan2);
                let factor = if tan2 > 0.0 {
                    (sin2 / (1.0 - sin2) / tan2).sqrt()
                } else {
                    index[1]
                };
                (sin2 < 1.0).then_some((x * factor, y * factor))?
            }
        };
        let (x, y) = distorted(&self.distortion, x, y);
        Some((
            self.camera.cx + self.camera.focal_px * x,
            self.camera.cy + self.camera.focal_px * y,
        ))
    }

    /// Checks that each pixel of a picture of this size looks in one direction.
    ///
    /// # Errors
    /// [`Fold`].
    pub fn check(&self, (width, height): (usize, usize)) -> Result<(), Fold> {
        let Intrinsics { focal_px, cx, cy } = self.camera;
        let [far_x, far_y] = [(cx, width), (cy, height)]
            .map(|(center, side)| center.abs().max((side as f64 - 1.0 - center).abs()) / focal_px);
        let corner = far_x.hypot(far_y) * BEYOND_CORNER;
        let Distortion { k1, k2, k3, .. } = self.distortion;
        let (step, mut radius) = (corner / FOLD_STEPS as f64, 0.0);
        loop {
            let r2 = radius * radius;
            let slope = 1.0 + r2 * (3.0 * k1 + r2 * (5.0 * k2 + r2 * 7.0 * k3));
            if slope <= LEAST_SLOPE {
                return Err(Fold::Radius { radius });
            }
            if radius * (1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))) >= corner || step == 0.0 {
                break;
            }
            radius += step;
        }
        border((width, height))
            .chain(inside((width, height)))
            .try_for_each(|(x, y)| {
                let found = self.undistorted((x as f64 - cx) / focal_px, (y as f64 - cy) / focal_px);
                let keeps_sides = |(x, y)| {
                    let [[xx, xy], [yx, yy]] = jacobian(&self.distortion, x, y);
                    xx * yy > xy * yx
                };
                found
                    .filter(|&ideal| keeps_sides(ideal))
                    .map(|_| ())
                    .ok_or(Fold::Pixel { x, y })
            })
    }
}

/// Error in px at the corner of a picture for objects at this range, because rays behind a flat port do not meet in a
/// single viewpoint; 0 for other ports.
///
/// In water the ray of angle θ meets the axis `dz(θ) = (d_p tan θ_a + d_g tan θ_g)/tan θ_w` behind the outer face, for
/// small angles `n_w (d_p + d_g/n_g)`; this is the viewpoint, the origin of the range. The error is `|dz(θ) - dz(0)|
/// sin θ_w / Z` radians (d_p from pupil to glass, d_g its thickness, n_g = 1.5).
#[must_use]
pub fn pupil_error_px(lens: &Lens, port: &Port, (width, height): (usize, usize), range_m: f64) -> f64 {
    const GLASS: f64 = 1.5;
    let &Port::Flat { pupil_m, glass_m } = port else {
        return 0.0;
    };
    let index = lens.magnification();
    let (x, y) = ((width as f64 - 1.0) / 2.0, (height as f64 - 1.0) / 2.0);
    let tan_air = x.hypot(y) / lens.camera.focal_px;
    let sin_air = tan_air / (1.0 + tan_air * tan_air).sqrt();
    let sin_water = sin_air / index;
    if sin_water == 0.0 {
        return 0.0;
    }
    let at_corner = (pupil_m * tan_air + glass_m * tangent(sin_air / GLASS)) / tangent(sin_water);
    let on_axis = index * (pupil_m + glass_m / GLASS);
    (at_corner - on_axis).abs() * sin_water / range_m * lens.camera.focal_px * index
}

/// Border pixels tested per side: a lens is smooth, and a map has a margin.
const BORDER_STEPS: usize = 64;

/// Sampled border pixels, including the corners.
pub(crate) fn border((width, height): (usize, usize)) -> impl Iterator<Item = (usize, usize)> {
    let rows = sample_side(width, BORDER_STEPS).flat_map(move |x| [(x, 0), (x, height - 1)]);
    rows.chain(sample_side(height, BORDER_STEPS).flat_map(move |y| [(0, y), (width - 1, y)]))
}

/// Pixels tested per side within a picture.
const INSIDE_STEPS: usize = 16;

/// Sampled pixels of a picture.
fn inside((width, height): (usize, usize)) -> impl Iterator<Item = (usize, usize)> {
    let columns = sample_side(width, INSIDE_STEPS);
    columns.flat_map(move |x| sample_side(height, INSIDE_STEPS).map(move |y| (x, y)))
}

/// `steps + 1` evenly spaced pixels of a side.
pub(crate) fn sample_side(side: usize, steps: usize) -> impl Iterator<Item = usize> {
    (0..=steps).map(move |i| i * (side - 1) / steps)
}

fn tangent(sin: f64) -> f64 {
    sin / (1.0 - sin * sin).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lens::geometry::brown::BARREL;

    fn lens(distortion: Distortion, refraction: PortRefraction) -> Lens {
        Lens {
            camera: Intrinsics::centered(60.0, 81, 61),
            distortion,
            refraction,
        }
    }

    #[test]
    fn the_forward_map_returns_to_the_pixel_that_looked() {
        for refraction in [
            PortRefraction::None,
            PortRefraction::Flat {
                index: [1.33, 1.34, 1.35],
            },
        ] {
            let lens = lens(BARREL, refraction);
            for (x, y) in [(0.0, 0.0), (80.0, 0.0), (17.0, 42.0), (40.0, 30.0)] {
                let ideal = lens.undistorted((x - 40.0) / 60.0, (y - 30.0) / 60.0).unwrap();
                let seen = lens.in_water(ideal, 1);
                let (u, v) = lens.pixel_of(seen).unwrap();
                assert!(
                    (u - x).abs() < 1e-9 && (v - y).abs() < 1e-9,
                    "({x}, {y}): ({u}, {v})"
                );
            }
        }
    }

    #[test]
    fn a_flat_port_obeys_snell_and_never_sees_beyond_the_critical_angle() {
        let lens = lens(Distortion::default(), PortRefraction::Flat { index: [1.34; 3] });
        let tan_air = libm::tan(40f64.to_radians());
        let (tan_water, _) = lens.in_water((tan_air, 0.0), 1);
        let expected = libm::asin(libm::sin(40f64.to_radians()) / 1.34);
        assert!((libm::atan(tan_water) - expected).abs() < 1e-14);
        let (widest, _) = lens.in_water((1e9, 0.0), 1);
        assert!(libm::atan(widest).to_degrees() < 48.3);
        assert_eq!(lens.pixel_of((1.2, 0.0)), None);
    }

    #[test]
    fn the_pupil_behind_the_port_shifts_near_corners() {
        let port = |pupil_m| Port::Flat {
            pupil_m,
            glass_m: 0.0,
        };
        let lens = lens(Distortion::default(), PortRefraction::Flat { index: [1.34; 3] });
        let error = |pupil_m, range_m| pupil_error_px(&lens, &port(pupil_m), (81, 61), range_m);
        assert_eq!(error(0.0, 1.0), 0.0);
        // tan of the corner is 50/60: dz = 0.05 tan/tan, 0.08018 against 0.067.
        let (sin, n) = (50.0 / 6100f64.sqrt(), 1.34);
        let water = libm::asin(sin / n);
        let expected = (0.05 * (50.0 / 60.0) / libm::tan(water) - 0.067).abs() * (sin / n) * 60.0 * n;
        assert!((error(0.05, 1.0) - expected).abs() < 1e-9);
        assert!((error(0.05, 2.0) - expected / 2.0).abs() < 1e-9);
    }

    /// A pincushion whose slope exceeds 2 inside of the picture, where fixed points repel.
    #[test]
    fn steep_lenses_are_inverted_within_the_picture() {
        let dice = imaging::random::Stream::stage(3, "lenses");
        let (mut checked, mut steep) = (0, 0);
        for number in 0..400 {
            let draw = |k: u64, most: f64| most * (2.0 * dice.unit(number, k) - 1.0);
            let distortion = Distortion {
                k1: draw(0, 2.0),
                k2: draw(1, 1.0),
                k3: draw(2, 0.1),
                p1: draw(3, 0.03),
                p2: draw(4, 0.03),
            };
            let lens = lens(distortion, PortRefraction::None);
            if lens.check((81, 61)).is_err() {
                continue;
            }
            checked += 1;
            for (x, y) in (0..81).flat_map(|x| (0..61).map(move |y| (x, y))) {
                let [xd, yd] = [(x, 40.0), (y, 30.0)].map(|(v, center)| (f64::from(v) - center) / 60.0);
                let (ideal_x, ideal_y) = lens.undistorted(xd, yd).expect("a checked lens");
                let (dx, dy) = distorted(&distortion, ideal_x, ideal_y);
                assert!((dx - xd).hypot(dy - yd) < 1e-9, "{distortion:?} at {x}, {y}");
                let [[slope, _], _] = jacobian(&distortion, ideal_x, ideal_y);
                steep += usize::from(slope > 2.0);
            }
        }
        assert!(
            checked > 100 && steep > 0,
            "{checked} lenses, {steep} steep pixels"
        );
    }

    #[test]
    fn a_lens_that_folds_is_refused() {
        let strong = Distortion {
            k1: -0.9,
            ..Distortion::default()
        };
        let wrong = lens(strong, PortRefraction::None).check((81, 61)).unwrap_err();
        assert!(wrong.to_string().starts_with("the lens folds"), "{wrong}");
        assert_eq!(lens(BARREL, PortRefraction::None).check((81, 61)), Ok(()));
        assert_eq!(
            lens(Distortion::default(), PortRefraction::None).check((1, 1)),
            Ok(())
        );
    }
}
