//! The part of a segment that a lamp illuminates.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::lamp::SphereLamp;
use crate::phase::AngleRange;
use crate::scene::Along;

/// A lamp in the plane through a segment. Its coordinate is the scattering angle θ between the segment and the direction to the lamp,
/// with the distance along the segment `nearest − offset / tan θ`: dt/(distance to the lamp)² = dθ/offset (Kulla and Fajardo 2012). An
/// angle drawn from the phase function leaves only transmittance and profile to chance.
pub(super) struct LampView {
    /// Position of the point nearest to the lamp along the segment, m.
    nearest: f64,
    /// Distance of the lamp from the line, at least its radius, m.
    offset: f64,
    /// The illuminated angles.
    pub(super) range: AngleRange,
}

impl LampView {
    /// `None` if the beam misses the segment.
    pub(super) fn new(lamp: &SphereLamp, along: Along, end: f64) -> Option<Self> {
        let Along { origin, direction } = along;
        let away = lamp.place + -origin;
        let nearest = direction.dot(away);
        let across = away + direction * -nearest;
        let true_offset = across.length();
        let offset = true_offset.max(lamp.radius_m);
        let is_inside = true_offset < lamp.radius_m;
        let mut ends = [
            offset.atan2(nearest),
            if end.is_finite() {
                offset.atan2(nearest - end)
            } else {
                PI
            },
        ];
        if let Some((axis, cosine)) = lamp.beam.filter(|_| !is_inside) {
            // The cosine between the axis and the direction from the lamp is `most cos(θ − middle)`.
            let [ahead, aside] = [-axis.dot(direction), -axis.dot(across) / true_offset];
            let most = ahead.hypot(aside);
            if most <= cosine {
                return None;
            }
            let (middle, half) = (aside.atan2(ahead), (cosine / most).acos());
            ends = clip(ends, middle, half)?;
        }
        (ends[0] < ends[1]).then_some(Self {
            nearest,
            offset,
            range: AngleRange { ends, is_inside },
        })
    }

    /// Distance along the segment at an angle, m.
    pub(super) fn distance(&self, angle: f64) -> f64 {
        self.nearest + self.offset * (angle - FRAC_PI_2).tan()
    }

    /// Meters per radian at a distance along the segment.
    pub(super) fn stretch(&self, distance: f64) -> f64 {
        let beyond = distance - self.nearest;
        (self.offset * self.offset + beyond * beyond) / self.offset
    }
}

/// The part of an interval within 0..=π that is within `half`, at most π/2, of an angle `middle` in −π..=π.
fn clip([low, high]: [f64; 2], middle: f64, half: f64) -> Option<[f64; 2]> {
    // An interval around −π continues below π.
    let middle = if middle + half < 0.0 {
        middle + 2.0 * PI
    } else {
        middle
    };
    let clipped = [low.max(middle - half), high.min(middle + half)];
    (clipped[0] < clipped[1]).then_some(clipped)
}

#[cfg(test)]
mod tests {
    use super::*;
    use imaging::vector::{DVec3, vec3};

    #[test]
    fn a_beam_illuminates_the_part_of_a_segment_within_its_cone() {
        let stream = imaging::random::Stream::stage(2, "truth");
        let mut element = 0;
        let mut draw = || {
            element += 1;
            2.0 * stream.unit(0, element) - 1.0
        };
        let (mut lit, mut missed) = (0, 0);
        for _ in 0..2000 {
            let mut vector = || vec3(draw(), draw(), draw());
            let (place, axis, direction): (DVec3, DVec3, DVec3) =
                (vector(), vector().normalized(), vector().normalized());
            let lamp = SphereLamp {
                place,
                intensity: [1.0; 3],
                beam: Some((axis, 35f64.to_radians().cos())),
                radius_m: 1e-3,
                disc_m: 0.0,
            };
            let along = Along {
                origin: vec3(0.1, -0.2, 0.3),
                direction,
            };
            let view = LampView::new(&lamp, along, 2.0);
            for step in 0..100 {
                let distance = 0.02 * f64::from(step) + 0.01;
                let from_lamp = (along.origin + direction * distance + -place).normalized();
                let angle = direction.dot(-from_lamp).acos();
                let profile = lamp.profile(from_lamp);
                let is_inside = view.as_ref().is_some_and(|view| {
                    assert!((view.distance(angle) - distance).abs() < 1e-6);
                    (view.range.ends[0]..=view.range.ends[1]).contains(&angle)
                });
                if profile > 1e-6 {
                    assert!(is_inside, "{lamp:?} {along:?} {distance}");
                    lit += 1;
                } else if !is_inside {
                    missed += 1;
                }
            }
        }
        assert!(lit > 1000 && missed > 100_000, "{lit} {missed}");
    }
}
