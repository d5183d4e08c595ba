//! Families of frames.

use super::case::Case;
use super::knobs::Knobs;
use super::{directed, random};

/// A kind of frames.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Family {
    /// Random pictures in water, without other effects.
    Water,
    /// Random uploaded pictures.
    Pictures,
    /// Random procedural scenes.
    Procedural,
    /// Random frames on a path: movement, rolling shutters, lagging exposure.
    Sequences,
    /// Against the interpolation of forward scatter.
    Scatter,
    /// Against metering.
    Metering,
    /// Against transforms and exposure: single pixels and alternating signs.
    Points,
    /// Against defocus.
    Defocus,
    /// Against lamps next to surfaces.
    Lamps,
    /// Against lens, port and fall-off.
    Lens,
}

impl Family {
    /// Families of random frames; frequent ones are listed several times.
    pub(super) const RANDOM: [Self; 8] = [
        Self::Pictures,
        Self::Procedural,
        Self::Water,
        Self::Pictures,
        Self::Sequences,
        Self::Pictures,
        Self::Procedural,
        Self::Pictures,
    ];
    /// Families of directed frames.
    pub(super) const DIRECTED: [Self; 6] = [
        Self::Scatter,
        Self::Metering,
        Self::Points,
        Self::Defocus,
        Self::Lamps,
        Self::Lens,
    ];
    const NAMES: [&str; 10] = [
        "water",
        "pictures",
        "procedural",
        "sequences",
        "scatter",
        "metering",
        "points",
        "defocus",
        "lamps",
        "lens",
    ];

    /// Its name on the command line.
    pub(super) fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }

    /// The family of a name.
    pub(super) fn parse(name: &str) -> Option<Self> {
        let mut all = Self::RANDOM.into_iter().chain(Self::DIRECTED);
        all.find(|family| family.name() == name)
    }

    /// Draws a frame. The returned knobs contain the numbers it used.
    pub(super) fn draw(self, knobs: Knobs) -> (Case, Knobs) {
        match self {
            Self::Water => random::draw_water_alone(knobs),
            Self::Pictures => (random::draw_uploaded(&knobs), knobs),
            Self::Procedural => (random::draw_procedural(&knobs), knobs),
            Self::Sequences => (random::draw_sequence(&knobs), knobs),
            Self::Scatter => directed::draw_scattered(knobs),
            Self::Metering => directed::draw_metered(knobs),
            Self::Points => directed::draw_points(knobs),
            Self::Defocus => directed::draw_defocused(knobs),
            Self::Lamps => directed::draw_lit(knobs),
            Self::Lens => directed::draw_lens(knobs),
        }
    }
}
