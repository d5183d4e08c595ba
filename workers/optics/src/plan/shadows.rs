//! Shadows of lamps in a plan.

use spec::RaySource;

use super::Casting;
use crate::lamp::{Lamp, Lighting, Shadow};

/// Where light of lamps casts shadows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Use {
    /// On surfaces.
    Surfaces,
    /// In the airlight.
    Airlight,
}

/// Lamps with the shadows that a frame needs of them.
#[derive(Debug, Clone, PartialEq)]
pub struct Shadows {
    /// The lamps as they cast shadows.
    pub lighting: Lighting,
    /// Lamps that cast one.
    pub lamps: usize,
    /// Lamps described with a shadow but without a possible occluder.
    pub spared: usize,
    /// Soft lamps whose penumbras are narrower than a pixel.
    pub hardened: usize,
    /// The most light samples of a lamp; 1 of points.
    pub samples: usize,
    /// The largest number that the frame allows.
    pub most_samples: usize,
    /// The source of occluders.
    pub rays: RaySource,
}

impl Shadows {
    /// The shadows of these lamps: as described, or as `casting` needs them. `None` if no lamp casts one.
    #[must_use]
    pub fn find(lighting: &Lighting, casting: Option<&Casting>, place: Use, rays: RaySource) -> Option<Self> {
        let needed = match (casting, place) {
            (None, _) => lighting,
            (Some(casting), Use::Surfaces) => &casting.on_surfaces,
            (Some(casting), Use::Airlight) => &casting.in_glow,
        };
        let mut all = Self {
            lighting: needed.clone(),
            lamps: 0,
            spared: 0,
            hardened: 0,
            samples: 0,
            most_samples: 0,
            rays,
        };
        let pairs = lighting.lamps.iter().zip(&needed.lamps);
        for (asked, needed) in pairs.filter(|(asked, _)| casts(asked, place)) {
            let (asked, needed) = (asked.shadow(), needed.shadow());
            let [most, count] = [asked, needed].map(|shadow| shadow.disc().1);
            all.most_samples = all.most_samples.max(most);
            if needed == Shadow::None {
                all.spared += 1;
                continue;
            }
            all.lamps += 1;
            all.hardened += usize::from(asked != needed && needed == Shadow::Hard);
            all.samples = all.samples.max(count);
        }
        (all.most_samples > 0).then_some(all)
    }

    pub(super) fn variant(&self) -> &'static str {
        match self {
            Self { lamps: 0, .. } => "skip",
            Self { samples: 0 | 1, .. } => "hard",
            _ => "soft",
        }
    }

    /// The note in the plan.
    #[must_use]
    pub fn note(&self) -> String {
        if self.lamps == 0 {
            return "nothing can occlude them".to_owned();
        }
        let edges = "edges fall where rays meet them, which no bound counts";
        let mut note = match self.rays {
            RaySource::Screen => format!("{edges}; from the range image: what it does not show casts none"),
            RaySource::Scene => format!("{edges}; from the solids of the scene"),
        };
        if self.spared > 0 {
            note += &format!("; nothing can occlude {} more", self.spared);
        }
        if self.hardened > 0 {
            note += &format!("; penumbras of {} are narrower than a pixel", self.hardened);
        }
        if self.samples < self.most_samples && self.hardened < self.lamps {
            note += &format!(
                "; {} of {} light samples suffice for the tolerance",
                self.samples, self.most_samples
            );
        }
        note
    }
}

fn casts(lamp: &Lamp, place: Use) -> bool {
    lamp.shadow() != Shadow::None && (place == Use::Surfaces || lamp.casts_into_water())
}
