//! The picture of a particle: the blur circle of the lens, drawn out by the current.

use std::f64::consts::PI;

/// Minimum radius of a disc, px.
const LEAST_PX: f64 = 0.5;

/// The opacity of a particle about its middle, as a share of that in the middle: 1 up to `radius − edge` from its path, 0 from
/// `radius + edge` on, linear between. The disc of a particle of radius a under a blur circle of radius b is about `max(a, b)`
/// wide, with an edge of `min(a, b)` on either side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spot {
    /// Where half of the opacity is left, pixels.
    pub radius: f64,
    /// Half the width of the edge, pixels.
    pub edge: f64,
    /// The motion while the shutter is open, pixels.
    pub streak: [f64; 2],
}

impl Spot {
    /// The spot of a particle with a radius of `size` pixels, and its opacity in the middle, so that opacity times area equals that
    /// of the particle. `blur` is the radius of the circle of confusion, `streak` the motion in the picture.
    pub(super) fn of(size: f64, blur: f64, streak: [f64; 2]) -> (Self, f64) {
        let radius = size.max(blur).max(LEAST_PX);
        let edge = size.min(blur).max(LEAST_PX);
        let length = streak[0].hypot(streak[1]);
        // Of the profile about a path of this length.
        let area = PI * (radius * radius + edge * edge / 3.0) + 2.0 * radius * length;
        let opacity = (PI * size * size / area).min(1.0);
        (Self { radius, edge, streak }, opacity)
    }

    /// How far it reaches from its middle along x and y, pixels.
    pub(super) fn reach(&self) -> [f64; 2] {
        self.streak.map(|way| self.radius + self.edge + 0.5 * way.abs())
    }

    /// The share of the opacity at an offset from the middle.
    pub(super) fn at(&self, dx: f64, dy: f64) -> f64 {
        let Self { radius, edge, streak } = *self;
        let square = streak[0] * streak[0] + streak[1] * streak[1];
        let along = if square > 0.0 {
            ((dx * streak[0] + dy * streak[1]) / square).clamp(-0.5, 0.5)
        } else {
            0.0
        };
        let away = (dx - along * streak[0]).hypot(dy - along * streak[1]);
        ((radius + edge - away) / (2.0 * edge)).clamp(0.0, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The sum over pixels is an integral with steps of one.
    const STEPS: f64 = 0.01;

    #[test]
    fn a_disc_has_the_area_of_its_particle_however_blurred_and_drawn_out() {
        for (size, blur, streak) in [
            (0.1, 0.0, [0.0, 0.0]),
            (3.0, 0.2, [0.0, 0.0]),
            (0.7, 9.0, [0.0, 0.0]),
            (4.0, 4.0, [0.0, 0.0]),
            (1.0, 3.0, [20.0, -9.0]),
        ] {
            let (spot, opacity) = Spot::of(size, blur, streak);
            let side = -40..=40;
            let sum: f64 = side
                .clone()
                .flat_map(|y| side.clone().map(move |x| (f64::from(x), f64::from(y))))
                .map(|(x, y)| opacity * spot.at(x, y))
                .sum();
            let area = PI * size * size;
            // Small discs fall between the pixels.
            let tolerance = if blur.max(size) < 1.0 { 0.3 } else { 2.0 * STEPS };
            assert!(
                (sum / area - 1.0).abs() < tolerance,
                "{size} {blur}: {sum} for {area}"
            );
        }
    }

    #[test]
    fn nothing_is_beyond_the_reach() {
        let (spot, _) = Spot::of(2.0, 5.0, [8.0, 3.0]);
        let [across, down] = spot.reach();
        assert!(spot.at(across - 0.6, 1.0) > 0.0);
        assert_eq!((spot.at(across, 0.0), spot.at(0.0, down)), (0.0, 0.0));
    }
}
