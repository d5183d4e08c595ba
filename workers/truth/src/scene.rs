//! A scene for the truth, and what lies at the end of a segment.

use imaging::rays::{Hit, Rays};
use imaging::vector::DVec3;

use crate::lamp::Lamp;
use crate::phase::Phase;
use crate::sea::Sea;
use crate::surface::{Material, Surfaces};
use crate::water::{Coefficients, Murk};

/// All that light meets. Places are in the axes of the camera, which is at the origin.
pub struct Scene<'a> {
    /// Where surfaces are.
    pub rays: &'a (dyn Rays + Sync),
    /// What they do to light.
    pub surfaces: Surfaces<'a>,
    /// The lamps.
    pub lamps: Vec<Lamp>,
    /// The sea surface; none in water without end.
    pub sea: Option<Sea>,
    /// The water of each channel.
    pub water: [Coefficients; 3],
    /// How it scatters.
    pub phase: Phase,
    /// Where it is murkier.
    pub murk: Murk,
}

/// A ray of the camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Along {
    /// Where it begins.
    pub origin: DVec3,
    /// Unit vector.
    pub direction: DVec3,
}

/// What a segment ends at.
pub(crate) enum Met {
    /// It goes on without end.
    Nothing,
    /// A surface.
    Surface { hit: Hit, material: Material },
    /// The sea surface, at a cosine from the vertical.
    Sea { cosine: f64 },
}

/// The end of a segment.
pub(crate) struct End {
    /// Along the segment, m; infinite where there is none.
    pub(crate) distance: f64,
    pub(crate) met: Met,
}

impl Scene<'_> {
    /// What a segment ends at.
    pub(crate) fn end(&self, along: Along, from: f64) -> End {
        let Along { origin, direction } = along;
        let sea = self.sea.as_ref().and_then(|sea| sea.distance(origin, direction));
        let reach = sea.unwrap_or(f64::INFINITY);
        if let Some(hit) = self.rays.hit(origin.into(), direction.into(), from, reach) {
            let place = origin + direction * hit.distance;
            return End {
                distance: hit.distance,
                met: Met::Surface {
                    hit,
                    material: self.surfaces.at(&hit, place),
                },
            };
        }
        match (sea, &self.sea) {
            (Some(distance), Some(sea)) => End {
                distance,
                met: Met::Sea {
                    cosine: sea.up.dot(direction).min(1.0),
                },
            },
            _ => End {
                distance: f64::INFINITY,
                met: Met::Nothing,
            },
        }
    }

    /// Whether anything stands between a place and one that is `distance` away.
    pub(crate) fn is_blocked(&self, origin: DVec3, direction: DVec3, from: f64, distance: f64) -> bool {
        self.rays
            .occluded(origin.into(), direction.into(), from, distance)
    }
}
