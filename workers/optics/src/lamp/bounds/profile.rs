//! Bounds of the profile of a lamp over an interval of angles to its axis.

use super::super::beam::Beam;
use super::super::multiple::{AZIMUTHS, RINGS, rings};

/// Light up to this angle beyond the cone may be there by rounding of the cosine to the axis, rad.
pub(super) const MARGIN: f64 = 1e-4;
/// Cosines of the azimuths of a ring above 0.
const TURN: [f64; AZIMUTHS / 2] = [0.923_879_532_511_286_7, 0.382_683_432_365_089_8];

/// The profile of a lamp in f64.
#[derive(Clone, Copy)]
pub(super) struct Profile {
    pub(super) axis: Option<[f64; 3]>,
    /// Slope of the profile by the cosine to the axis.
    pub(super) slope: f64,
    cos_cone: f64,
    /// Angle and sine of the cone.
    pub(super) cone: f64,
    pub(super) sin_cone: f64,
    /// Errors in f32 of its axis, and of the profile by its two coefficients.
    pub(super) axis_error: f64,
    pub(super) line_error: f64,
    rings: [f64; RINGS],
}

/// Bounds of the blurred profile.
#[derive(Clone, Copy)]
pub(super) struct Blurred {
    /// Its most.
    pub(super) most: f64,
    /// The share of the rings that may reach the cone.
    pub(super) lit: f64,
    /// The mean angle of these rings as a multiple of the scale, the others counted as 0.
    pub(super) reach: f64,
}

impl Profile {
    pub(super) fn new(beam: Beam) -> Self {
        let (axis, cos_cone) = match beam {
            Beam::Point => (None, 0.0),
            Beam::Spot { axis, cos_cone } => (Some(axis), cos_cone),
        };
        let (single, slope) = (beam.single(), beam.slope());
        let lost = |cos: f64| {
            let line = f64::from(single.slope) * cos + f64::from(single.offset);
            (line - slope * (cos - cos_cone)).abs()
        };
        let turned = axis.map_or([0.0; 3], |axis| {
            [0, 1, 2].map(|i| axis[i] - f64::from(single.axis[i]))
        });
        let is_spot = axis.is_some();
        Self {
            axis,
            slope,
            cos_cone,
            cone: cos_cone.acos(),
            sin_cone: (1.0 - cos_cone * cos_cone).max(0.0).sqrt(),
            axis_error: turned.iter().map(|v| v * v).sum::<f64>().sqrt(),
            line_error: if is_spot {
                lost(1.0).max(lost(cos_cone))
            } else {
                0.0
            },
            rings: rings(),
        }
    }

    /// The most of the profile at these angles; above 0 up to a `margin` beyond the cone.
    pub(super) fn most(&self, [least, _]: [f64; 2], margin: f64) -> f64 {
        if self.axis.is_none() {
            return 1.0;
        }
        if least > self.cone + margin {
            return 0.0;
        }
        (self.slope * (least.cos() - self.cos_cone)).clamp(1e-9, 1.0)
    }

    /// Bounds of the blurred profile at these angles for kernels of these scales, rad.
    pub(super) fn blurred(&self, [least, most]: [f64; 2], scale: [f64; 2], margin: f64) -> Blurred {
        if self.axis.is_none() {
            return Blurred {
                most: 1.0,
                lit: 1.0,
                reach: 0.0,
            };
        }
        let (cos, sin) = ([most.cos(), least.cos()], largest_sine([least, most]));
        let offset = -self.slope * self.cos_cone;
        let (mut sum, mut lit, mut reach) = (0.0, 0.0, 0.0);
        for out in self.rings {
            let ring = scale.map(|scale| (scale * out).min(std::f64::consts::PI));
            let is_outside = least - ring[1] > self.cone + margin || ring[0] - most > self.cone + margin;
            if is_outside {
                continue;
            }
            lit += 1.0 / RINGS as f64;
            reach += out / RINGS as f64;
            let middle = self.slope * most_product(cos, ring) + offset;
            for turn in TURN {
                // Two samples in opposite azimuths.
                let aside = self.slope * sin * ring[1].min(1.0) * turn;
                sum += (2.0 * middle).max(middle + aside).clamp(0.0, 2.0);
            }
        }
        Blurred {
            most: (sum / (RINGS * AZIMUTHS) as f64 + 1e-6 * lit).min(lit),
            lit,
            reach,
        }
    }
}

/// Upper bound of the product of a cosine in this interval and the cosine of any angle of a ring.
fn most_product([least, most]: [f64; 2], [from, to]: [f64; 2]) -> f64 {
    if to >= 1.5 {
        let ends = [to.cos(), from.cos()];
        let products = [least, most].map(|cos| ends.map(|end| cos * end));
        return products.into_iter().flatten().fold(f64::MIN, f64::max);
    }
    let square = from * from;
    most.max(0.0) * (1.0 - 0.5 * square * (1.0 - square / 12.0))
}

/// The largest sine of an angle in an interval within 0..=π.
pub(super) fn largest_sine([least, most]: [f64; 2]) -> f64 {
    let right = std::f64::consts::FRAC_PI_2;
    if least <= right && most >= right {
        1.0
    } else {
        least.sin().max(most.sin())
    }
}
