//! Compares random and directed frames with the bounds of their plans: the exposed light of a frame is within the plan's bound of
//! the light of the f64 reference, and water costs little more than with the cheapest sufficient plan.
//!
//! Each frame is an ordinary job with a camera, a function of its family and seed. Edges of shadows, caustics and sediment have no
//! bound; frames affected by them are counted separately.

mod camera;
mod case;
mod charts;
mod climb;
mod cost;
mod directed;
mod family;
mod knobs;
mod lamps;
mod picture;
mod random;
mod report;
mod studio;
mod water;

use std::collections::BTreeMap;

use spec::{Fidelity, Frame};

pub use case::{Case, Picture};
pub use charts::{bound_chart, cost_chart};
pub use climb::{Climb, starts};
pub use cost::Cost;
pub use family::Family;
pub use knobs::Origin;
pub use report::{Summary, markdown, worst};
pub use studio::{Measured, Promise, Studio};

use knobs::Knobs;

/// Maximum draws of a seed. Contradictory descriptions are drawn again.
const MOST_ATTEMPTS: u64 = 40;

impl Origin {
    /// The source of a family and a seed.
    #[must_use]
    pub fn new(family: Family, seed: u64) -> Self {
        Self {
            family,
            seed,
            attempt: 0,
            turned: BTreeMap::new(),
        }
    }

    /// The sources of a campaign: random frames, then directed ones; with `family`, only those of that family.
    #[must_use]
    pub fn list(seed: u64, random: u64, directed: u64, family: Option<Family>) -> Vec<Self> {
        let parts = [(&Family::RANDOM[..], random), (&Family::DIRECTED[..], directed)];
        let mut origins = Vec::new();
        for (families, count) in parts {
            let own: Vec<Family> = match family {
                Some(only) => families
                    .iter()
                    .copied()
                    .filter(|&other| other == only)
                    .take(1)
                    .collect(),
                None => families.to_vec(),
            };
            let repeated = own.iter().cycle().take(count as usize);
            origins.extend(
                (seed..)
                    .zip(repeated)
                    .map(|(seed, &family)| Self::new(family, seed)),
            );
        }
        origins
    }

    /// Its kind in reports: the family, or `climbs` if a search changed it.
    #[must_use]
    pub fn kind(&self) -> &'static str {
        if self.is_climbed() {
            "climbs"
        } else {
            self.family.name()
        }
    }

    /// Family, seed, and the number of values changed by a search.
    #[must_use]
    pub fn describe(&self) -> String {
        match self.turned.len() {
            0 => format!("{} {}", self.family.name(), self.seed),
            turned => format!("{} {}, {turned} turned", self.family.name(), self.seed),
        }
    }

    /// The description and picture of the frame.
    #[must_use]
    pub fn case(&self) -> Case {
        self.family.draw(Knobs::new(self)).0
    }

    /// Names of the random numbers used by the frame.
    fn names(&self) -> Vec<String> {
        self.family.draw(Knobs::new(self)).1.names()
    }

    fn is_climbed(&self) -> bool {
        !self.turned.is_empty()
    }

    /// The first draw with a valid description, and its frame. A search has only one draw.
    fn resolve(&self, studio: &Studio) -> Option<(Self, Case, Frame)> {
        let attempts = if self.is_climbed() { 1 } else { MOST_ATTEMPTS };
        (self.attempt..self.attempt + attempts).find_map(|attempt| {
            let origin = Self {
                attempt,
                ..self.clone()
            };
            let case = origin.case();
            let frame = studio.resolve(&case)?;
            Some((origin, case, frame))
        })
    }

    /// Renders the frame and its reference; `None` if that fails.
    #[must_use]
    pub fn run(&self, studio: &mut Studio) -> Option<Outcome> {
        let (origin, case, frame) = self.resolve(studio)?;
        let Fidelity::Tolerance(tolerance) = frame.fidelity else {
            return None;
        };
        let measured = studio.measure(&frame, &case)?;
        let cost = match (self.kind(), &case.picture) {
            ("water", Some(picture)) => Cost::measure(&frame, picture),
            _ => None,
        };
        Some(Outcome {
            about: case.about(),
            origin,
            tolerance,
            measured,
            cost,
        })
    }
}

/// A frame compared with its bound.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Source of the frame.
    pub origin: Origin,
    /// Parts of the frame in one line.
    pub about: String,
    /// Tolerance of the frame.
    pub tolerance: f64,
    /// Bound and error.
    pub measured: Measured,
    /// Cost of the water; `None` outside of the family `water`.
    pub cost: Option<Cost>,
}

impl Outcome {
    /// The error over the bound; 0 without an error, even if the bound is 0 too.
    #[must_use]
    pub fn ratio(&self) -> f64 {
        let Measured { error, promise, .. } = self.measured;
        if error == 0.0 { 0.0 } else { error / promise.bound }
    }

    /// Whether the error is above the bound, or one of them is NaN.
    #[must_use]
    pub fn is_broken(&self) -> bool {
        let Measured { error, promise, .. } = self.measured;
        let is_within = error <= promise.bound;
        !promise.is_open && !is_within
    }

    /// Whether the bound exceeds the tolerance without a reason in the plan.
    #[must_use]
    pub fn is_silent(&self) -> bool {
        let promise = self.measured.promise;
        !promise.is_open && !promise.exceeds && promise.bound > self.tolerance * (1.0 + 1e-9)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Outside the seeds of the documented campaign.
    const SEED: u64 = 1_000_000;
    const RANDOM: u64 = 40;
    const DIRECTED: u64 = 24;
    /// Frames whose cost is compared with that of the cheapest sufficient plan.
    const WATER: u64 = 200;
    /// Largest median cost over the cheapest plan.
    const EXCESS_MEDIAN: f64 = 1.5;
    /// Largest 95 % quantile of the cost over the cheapest plan. Runs of 500 frames gave 1.8 to 2.5.
    const EXCESS_95: f64 = 2.5;

    fn outcomes(random: u64, directed: u64, family: Option<Family>) -> Vec<Outcome> {
        let mut studio = Studio::new();
        let origins = Origin::list(SEED, random, directed, family);
        origins
            .iter()
            .filter_map(|origin| origin.run(&mut studio))
            .collect()
    }

    #[test]
    fn no_error_exceeds_its_bound() {
        let outcomes = outcomes(RANDOM, DIRECTED, None);
        let frames = outcomes.len() as u64;
        assert!(frames >= (RANDOM + DIRECTED) * 9 / 10, "{frames} frames");
        let summary = Summary::new(&outcomes);
        assert_eq!(
            (summary.broken, summary.silent),
            (0, 0),
            "{}",
            markdown(&outcomes)
        );
        assert!(summary.picture_codes <= 1, "{}", markdown(&outcomes));
    }

    #[test]
    fn water_costs_little_more_than_in_the_cheapest_form() {
        let summary = Summary::new(&outcomes(WATER, 0, Some(Family::Water)));
        assert!(summary.excess_median <= EXCESS_MEDIAN, "{summary:#?}");
        assert!(summary.excess_95 <= EXCESS_95, "{summary:#?}");
    }

    #[test]
    fn a_bound_that_is_too_small_is_found() {
        let mut outcomes = outcomes(8, 0, Some(Family::Water));
        assert_eq!(Summary::new(&outcomes).broken, 0);
        let measured = &mut outcomes[5].measured;
        measured.promise.bound = measured.error * 0.99 - 1e-12;
        assert_eq!(Summary::new(&outcomes).broken, 1);
    }

    #[test]
    fn a_search_is_a_function_of_its_start() {
        let start = starts(&outcomes(8, 0, Some(Family::Water)), 1).remove(0);
        let mut studio = Studio::new();
        let found = start.run(&mut studio, 6);
        assert_eq!(found, start.run(&mut studio, 6));
        assert!(found.iter().all(|outcome| outcome.origin.kind() == "climbs"));
    }

    #[test]
    fn families_have_names_of_their_own() {
        for family in Family::RANDOM.into_iter().chain(Family::DIRECTED) {
            assert_eq!(Family::parse(family.name()), Some(family));
        }
        assert_eq!(Family::parse("climbs"), None);
    }
}
