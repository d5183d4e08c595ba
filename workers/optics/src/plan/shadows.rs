//! Shadows of lamps in a plan.

use spec::{Frame, RaySource};

use super::{Given, Stage, glow_share};
use crate::lamp::{Lamp, Shadow};

/// Share of the tolerance that light may have which nothing is looked for to cut off.
const UNSEEN: f64 = 1.0 / 16.0;

/// Shadows of the lamps of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shadows {
    /// Lamps that cast one.
    pub lamps: usize,
    /// The most places of a lamp that are looked for; 1 of points.
    pub places: usize,
    /// What is asked whether something is in the way.
    pub rays: RaySource,
}

impl Shadows {
    fn of<'a>(lamps: impl Iterator<Item = &'a Lamp>, frame: &Frame) -> Option<Self> {
        let (mut count, mut places) = (0, 0);
        for lamp in lamps {
            count += 1;
            places = places.max(match lamp.shadow() {
                Shadow::Soft { samples, .. } => samples,
                Shadow::None | Shadow::Hard => 1,
            });
        }
        (count > 0).then(|| Self {
            lamps: count,
            places,
            rays: frame.ray_source(),
        })
    }

    pub(super) fn variant(&self) -> &'static str {
        if self.places > 1 { "soft" } else { "hard" }
    }

    pub(super) fn note(&self) -> String {
        let edges = "edges lie where rays meet them, which no bound counts";
        match self.rays {
            RaySource::Screen => format!("{edges}; by the range image: what it does not show casts none"),
            RaySource::Auto | RaySource::Scene => format!("{edges}; by the solids of the scene"),
        }
    }
}

/// Light on surfaces up to this need not be cut off, in linear light.
#[must_use]
pub fn shadow_share(frame: &Frame) -> f64 {
    // A quarter of the tolerance is the glow's.
    4.0 * UNSEEN * glow_share(frame)
}

/// Shadows on surfaces.
pub(super) fn on_surfaces(given: &Given<'_>) -> Option<Stage<Shadows>> {
    let lamps = given.setting.lighting.iter().flat_map(|lighting| &lighting.lamps);
    let casting = lamps.filter(|lamp| lamp.shadow() != Shadow::None);
    let form = Shadows::of(casting, given.frame)?;
    Some(Stage {
        form,
        share: Some(shadow_share(given.frame)),
        bound: Some(given.lamps.shadows_left),
    })
}

/// Shadows in the glow.
pub(super) fn in_water(given: &Given<'_>) -> Option<Stage<Shadows>> {
    let lighting = given.setting.lighting.as_ref()?;
    let glows = lighting.scattering != [0.0; 3];
    let casting = lighting
        .lamps
        .iter()
        .filter(|lamp| glows && lamp.casts_into_water());
    Shadows::of(casting, given.frame).map(Stage::exact)
}
