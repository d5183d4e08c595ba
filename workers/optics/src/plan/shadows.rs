//! Shadows of lamps in a plan.

use spec::{Frame, RaySource};

use super::{Given, Stage, glow_share};
use crate::lamp::{Lamp, Lighting, Shadow};

/// Share of the tolerance that light may have which nothing is looked for to cut off.
const UNSEEN: f64 = 1.0 / 16.0;

/// Shadows of the lamps of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shadows {
    /// Lamps that cast one.
    pub lamps: usize,
    /// Lamps that are to, and before which nothing can be in the way.
    pub spared: usize,
    /// Soft lamps whose penumbras are narrower than a pixel.
    pub hardened: usize,
    /// The most places of a lamp that are looked for; 1 of points.
    pub places: usize,
    /// The most that the frame asks for.
    pub most_places: usize,
    /// What is asked whether something is in the way.
    pub rays: RaySource,
}

impl Shadows {
    /// Of lamps as they are described, and as the frame needs them.
    fn of(lamps: impl Iterator<Item = [Shadow; 2]>, frame: &Frame) -> Option<Self> {
        let mut all = Self {
            lamps: 0,
            spared: 0,
            hardened: 0,
            places: 0,
            most_places: 0,
            rays: frame.ray_source(),
        };
        for [asked, needed] in lamps {
            let [most, count] = [asked, needed].map(|shadow| shadow.disc().1);
            all.most_places = all.most_places.max(most);
            if needed == Shadow::None {
                all.spared += 1;
                continue;
            }
            all.lamps += 1;
            all.hardened += usize::from(asked != needed && needed == Shadow::Hard);
            all.places = all.places.max(count);
        }
        (all.most_places > 0).then_some(all)
    }

    pub(super) fn variant(&self) -> &'static str {
        match self {
            Self { lamps: 0, .. } => "skip",
            Self { places: 0 | 1, .. } => "hard",
            _ => "soft",
        }
    }

    pub(super) fn note(&self) -> String {
        if self.lamps == 0 {
            return "nothing can be in the way of their light".to_owned();
        }
        let edges = "edges lie where rays meet them, which no bound counts";
        let mut note = match self.rays {
            RaySource::Screen => format!("{edges}; by the range image: what it does not show casts none"),
            RaySource::Auto | RaySource::Scene => format!("{edges}; by the solids of the scene"),
        };
        if self.spared > 0 {
            note += &format!("; nothing can be in the way of {} more", self.spared);
        }
        if self.hardened > 0 {
            note += &format!("; penumbras of {} are narrower than a pixel", self.hardened);
        }
        if self.places < self.most_places && self.hardened < self.lamps {
            note += &format!(
                "; {} of {} places do for the tolerance",
                self.places, self.most_places
            );
        }
        note
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
    let lighting = given.setting.lighting.as_ref()?;
    let needed = given.casting.map_or(lighting, |casting| &casting.on_surfaces);
    let form = Shadows::of(casters(lighting, needed, |_| true), given.frame)?;
    let is_cast = form.lamps > 0;
    Some(Stage {
        form,
        share: Some(shadow_share(given.frame)),
        bound: is_cast.then_some(given.lamps.shadows_left),
    })
}

/// Shadows in the glow.
pub(super) fn in_water(given: &Given<'_>) -> Option<Stage<Shadows>> {
    let lighting = given.setting.lighting.as_ref()?;
    let needed = given.casting.map_or(lighting, |casting| &casting.in_glow);
    let glows = lighting.scattering != [0.0; 3];
    let into_water = |lamp: &Lamp| glows && lamp.casts_into_water();
    Shadows::of(casters(lighting, needed, into_water), given.frame).map(Stage::exact)
}

/// The shadows of those lamps that are to cast one: as they are described, and as the frame needs them.
fn casters(
    asked: &Lighting,
    needed: &Lighting,
    is_meant: impl Fn(&Lamp) -> bool,
) -> impl Iterator<Item = [Shadow; 2]> {
    let lamps = asked.lamps.iter().zip(&needed.lamps);
    let meant = lamps.filter(move |(asked, _)| asked.shadow() != Shadow::None && is_meant(asked));
    meant.map(|(asked, needed)| [asked.shadow(), needed.shadow()])
}
