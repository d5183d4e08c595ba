//! One frame of a campaign: its source, and its comparison with its bound.

use spec::{Fidelity, Frame};

use super::case::Case;
use super::family::Family;
use super::knobs::{Knobs, Source};
use super::measured::Measured;
use crate::studio::Studio;

/// Maximum draws of a seed. Contradictory descriptions are drawn again.
const MOST_ATTEMPTS: u64 = 40;

/// The source of a frame.
#[derive(Debug, Clone)]
pub(super) struct Origin {
    draw: fn(&mut Knobs) -> Case,
    pub(super) source: Source,
}

impl Origin {
    /// The sources of this many frames, family by family.
    pub(super) fn list(seed: u64, count: usize, families: &[Family]) -> Vec<Self> {
        let families = families.iter().cycle().take(count);
        let origins = (seed..).zip(families).map(|(seed, &(family, draw))| Self {
            draw,
            source: Source::new(family, seed),
        });
        origins.collect()
    }

    fn is_climbed(&self) -> bool {
        !self.source.turned.is_empty()
    }

    /// Its kind in reports: the family, or `climbs` if a search changed it.
    pub(super) fn kind(&self) -> &'static str {
        if self.is_climbed() {
            "climbs"
        } else {
            self.source.family
        }
    }

    /// The description and picture of the frame.
    pub(super) fn case(&self) -> Case {
        (self.draw)(&mut Knobs::new(&self.source))
    }

    /// Names of the random numbers used by the frame.
    pub(super) fn names(&self) -> Vec<String> {
        let mut knobs = Knobs::new(&self.source);
        (self.draw)(&mut knobs);
        knobs.names()
    }

    /// The first draw with a valid description, and its frame. A search has only one draw.
    pub(super) fn resolve(&self, studio: &Studio) -> Option<(Self, Case, Frame)> {
        let attempts = if self.is_climbed() { 1 } else { MOST_ATTEMPTS };
        let mut origin = self.clone();
        (0..attempts).find_map(|attempt| {
            origin.source.attempt = self.source.attempt + attempt;
            let case = origin.case();
            let frame = studio.frame(&case.job, 0).ok()?;
            Some((origin.clone(), case, frame))
        })
    }
}

/// A frame compared with its bound.
#[derive(Debug, Clone)]
pub(super) struct Outcome {
    /// Source of the frame.
    pub(super) origin: Origin,
    /// Tolerance of the frame.
    tolerance: f64,
    /// Bound and error.
    pub(super) measured: Measured,
}

impl Outcome {
    /// Renders a frame and its reference; `None` if that fails.
    pub(super) fn measure(origin: &Origin, studio: &mut Studio) -> Option<Self> {
        let (origin, case, frame) = origin.resolve(studio)?;
        let Fidelity::Tolerance(tolerance) = frame.fidelity else {
            return None;
        };
        let measured = Measured::measure(studio, &frame, &case)?;
        Some(Self {
            origin,
            tolerance,
            measured,
        })
    }

    /// The error over the bound; 0 without an error, even if the bound is 0 too.
    pub(super) fn ratio(&self) -> f64 {
        let Measured { error, promise, .. } = self.measured;
        if error == 0.0 { 0.0 } else { error / promise.bound }
    }

    /// Whether the error is above the bound, or one of them is NaN, with the fidelity of the frame or with `picture`.
    pub(super) fn is_broken(&self) -> bool {
        let Measured {
            error,
            promise,
            picture,
            ..
        } = self.measured;
        let is_within = error <= promise.bound && picture.is_none_or(|picture| picture.ratio <= 1.0);
        !promise.is_open && !is_within
    }

    /// Whether the bound exceeds the tolerance without a reason in the plan.
    pub(super) fn is_silent(&self) -> bool {
        let promise = self.measured.promise;
        !promise.is_open && !promise.exceeds && promise.bound > self.tolerance * (1.0 + 1e-9)
    }

    /// Family and seed of the frame, its error and its bound.
    pub(super) fn describe(&self) -> String {
        let (source, measured) = (&self.origin.source, &self.measured);
        let (error, bound, [x, y, channel]) = (measured.error, measured.promise.bound, measured.place);
        format!(
            "{} {}, {} turned: error {error:.2e} in channel {channel} at ({x}, {y}), bound {bound:.2e}, tolerance {:.2e}",
            source.family,
            source.seed,
            source.turned.len(),
            self.tolerance
        )
    }
}
