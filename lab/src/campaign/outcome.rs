//! One frame of a campaign: its source, and its comparison with its bound.

use std::collections::BTreeMap;

use spec::{Fidelity, Frame};

use super::case::Case;
use super::cost::Cost;
use super::family::Family;
use super::knobs::{Knobs, Source};
use super::measured::Measured;
use crate::studio::Studio;

/// Maximum draws of a seed. Contradictory descriptions are drawn again.
const MOST_ATTEMPTS: u64 = 40;

/// The source of a frame.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Origin {
    family: Family,
    pub(super) source: Source,
}

impl Origin {
    /// The source of a family and a seed.
    fn new(family: Family, seed: u64) -> Self {
        let source = Source {
            family: family.name(),
            seed,
            attempt: 0,
            turned: BTreeMap::new(),
        };
        Self { family, source }
    }

    /// The sources of a campaign: random frames, then directed ones; with `family`, only those of that family.
    pub(super) fn list(seed: u64, random: usize, directed: usize, family: Option<Family>) -> Vec<Self> {
        let mut origins = Vec::new();
        for (families, count) in [(&Family::RANDOM[..], random), (&Family::DIRECTED[..], directed)] {
            let mut wanted = families.to_vec();
            if let Some(only) = family {
                wanted.retain(|&other| other == only);
                wanted.truncate(1);
            }
            let repeated = wanted.into_iter().cycle().take(count);
            origins.extend(
                (seed..)
                    .zip(repeated)
                    .map(|(seed, family)| Self::new(family, seed)),
            );
        }
        origins
    }

    /// Its kind in reports: the family, or `climbs` if a search changed it.
    pub(super) fn kind(&self) -> &'static str {
        if self.source.turned.is_empty() {
            self.family.name()
        } else {
            "climbs"
        }
    }

    /// The description and picture of the frame.
    pub(super) fn case(&self) -> Case {
        self.family.draw(Knobs::new(&self.source)).0
    }

    /// Names of the random numbers used by the frame.
    pub(super) fn names(&self) -> Vec<String> {
        self.family.draw(Knobs::new(&self.source)).1.names()
    }

    /// The first draw with a valid description, and its frame. A search has only one draw.
    fn resolve(&self, studio: &Studio) -> Option<(Self, Case, Frame)> {
        let attempts = if self.source.turned.is_empty() {
            MOST_ATTEMPTS
        } else {
            1
        };
        (self.source.attempt..self.source.attempt + attempts).find_map(|attempt| {
            let mut origin = self.clone();
            origin.source.attempt = attempt;
            let case = origin.case();
            let frame = studio.frame(&case.job, 0).ok()?;
            Some((origin, case, frame))
        })
    }
}

/// A frame compared with its bound.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Outcome {
    /// Source of the frame.
    pub(super) origin: Origin,
    /// Parts of the frame in one line.
    about: String,
    /// Tolerance of the frame.
    tolerance: f64,
    /// Bound and error.
    pub(super) measured: Measured,
    /// Cost of the water; `None` outside of the family `water`.
    pub(super) cost: Option<Cost>,
}

impl Outcome {
    /// Renders a frame and its reference; `None` if that fails.
    pub(super) fn measure(origin: &Origin, studio: &mut Studio) -> Option<Self> {
        let (origin, case, frame) = origin.resolve(studio)?;
        let Fidelity::Tolerance(tolerance) = frame.fidelity else {
            return None;
        };
        let measured = Measured::measure(studio, &frame, &case)?;
        let cost = match (origin.kind(), &case.picture) {
            ("water", Some(picture)) => Cost::measure(&frame, picture),
            _ => None,
        };
        Some(Self {
            about: case.about(),
            origin,
            tolerance,
            measured,
            cost,
        })
    }

    /// The error over the bound; 0 without an error, even if the bound is 0 too.
    pub(super) fn ratio(&self) -> f64 {
        let Measured { error, promise, .. } = self.measured;
        if error == 0.0 { 0.0 } else { error / promise.bound }
    }

    /// Whether the error is above the bound, or one of them is NaN.
    pub(super) fn is_broken(&self) -> bool {
        let Measured { error, promise, .. } = self.measured;
        let is_within = error <= promise.bound;
        !promise.is_open && !is_within
    }

    /// Whether the bound exceeds the tolerance without a reason in the plan.
    pub(super) fn is_silent(&self) -> bool {
        let promise = self.measured.promise;
        !promise.is_open && !promise.exceeds && promise.bound > self.tolerance * (1.0 + 1e-9)
    }

    /// Family, seed and parts of the frame, its error and its bound.
    pub(super) fn describe(&self) -> String {
        let Measured {
            error,
            promise,
            place: [x, y, channel],
            ..
        } = self.measured;
        let Source {
            family, seed, turned, ..
        } = &self.origin.source;
        format!(
            "{family} {seed}, {} turned ({}): error {error:.2e} in channel {channel} at ({x}, {y}), bound {:.2e}, tolerance {:.2e}",
            turned.len(),
            self.about,
            promise.bound,
            self.tolerance
        )
    }
}
