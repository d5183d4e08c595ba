//! What a particle looks like in the picture: a soft spot, or the blur circle of a lens drawn out by the current.

use std::f64::consts::PI;

use spec::{Snow, SnowDiscs};

use super::flakes::REACH;

/// Nothing is drawn smaller than this, px.
const LEAST_PX: f64 = 0.5;

/// The opacity of a particle about its middle, as a share of that in the middle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Spot {
    /// `exp(−d²/2σ²)`.
    Soft {
        /// σ, pixels.
        sigma: f64,
    },
    /// 1 up to `radius − edge` from a way of the particle, 0 from `radius + edge` on, even between: the disc of a particle of
    /// radius a under a blur circle of radius b is about `max(a, b)` wide, with an edge of `min(a, b)` on either side.
    Disc {
        /// Where half of the opacity is left, pixels.
        radius: f64,
        /// Half the width of the edge, pixels.
        edge: f64,
        /// The way from one end to the other while the shutter is open, pixels.
        streak: [f64; 2],
    },
}

impl Spot {
    /// The spot of a particle of so many pixels' radius, and its opacity in the middle, so that opacity times area is that of
    /// the particle itself. `blur` is the radius of the circle of confusion, `streak` the way in the picture.
    pub(super) fn of(snow: &Snow, size: f64, blur: f64, streak: [f64; 2]) -> (Self, f64) {
        if snow.discs != Some(SnowDiscs::Lens) {
            let sigma = size.max(LEAST_PX);
            return (Self::Soft { sigma }, (size / sigma).powi(2));
        }
        let radius = size.max(blur).max(LEAST_PX);
        let edge = size.min(blur).max(LEAST_PX);
        let length = streak[0].hypot(streak[1]);
        // Of the profile about a way of this length.
        let area = PI * (radius * radius + edge * edge / 3.0) + 2.0 * radius * length;
        let opacity = (PI * size * size / area).min(1.0);
        (Self::Disc { radius, edge, streak }, opacity)
    }

    /// How far from its middle along x and y it may matter where the opacity in the middle is `over` times one that does not.
    pub(super) fn reach(&self, over: f64) -> [f64; 2] {
        match *self {
            Self::Soft { sigma } => [sigma * (2.0 * over.ln()).sqrt().min(REACH); 2],
            Self::Disc { radius, edge, streak } => streak.map(|way| radius + edge + 0.5 * way.abs()),
        }
    }

    /// How far it can reach at most.
    pub(super) fn farthest(&self) -> [f64; 2] {
        self.reach(f64::INFINITY)
    }

    /// The share of the opacity at a place from the middle.
    pub(super) fn at(&self, dx: f64, dy: f64) -> f64 {
        match *self {
            Self::Soft { sigma } => (-(dx * dx + dy * dy) / (2.0 * sigma * sigma)).exp(),
            Self::Disc { radius, edge, streak } => {
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
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The sum over pixels is an integral with steps of one.
    const STEPS: f64 = 0.01;

    #[test]
    fn a_disc_has_the_area_of_its_particle_however_blurred_and_drawn_out() {
        let snow = Snow {
            discs: Some(SnowDiscs::Lens),
            ..Snow::of(1.0)
        };
        for (size, blur, streak) in [
            (0.1, 0.0, [0.0, 0.0]),
            (3.0, 0.2, [0.0, 0.0]),
            (0.7, 9.0, [0.0, 0.0]),
            (4.0, 4.0, [0.0, 0.0]),
            (1.0, 3.0, [20.0, -9.0]),
        ] {
            let (spot, opacity) = Spot::of(&snow, size, blur, streak);
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
        let snow = Snow {
            discs: Some(SnowDiscs::Lens),
            ..Snow::of(1.0)
        };
        let (spot, _) = Spot::of(&snow, 2.0, 5.0, [8.0, 3.0]);
        let [across, down] = spot.farthest();
        assert!(spot.at(across - 0.6, 1.0) > 0.0);
        assert_eq!((spot.at(across, 0.0), spot.at(0.0, down)), (0.0, 0.0));
        let (soft, opacity) = Spot::of(&Snow::of(1.0), 0.25, 5.0, [0.0; 2]);
        assert_eq!((soft, opacity), (Spot::Soft { sigma: 0.5 }, 0.25));
    }
}
