//! Monte Carlo scene, and the ends of its segments.

use imaging::rays::{Hit, Rays};
use imaging::vector::DVec3;

use crate::lamp::SphereLamp;
use crate::phase::Phase;
use crate::sea::Sea;
use crate::surface::{Lambertian, SurfaceMaterials};
use crate::water::{TurbidityField, WaterCoefficients};

/// A complete scene. Positions are in camera axes, the camera at the origin.
pub struct TracedScene<'a> {
    /// Geometry.
    pub rays: &'a (dyn Rays + Sync),
    /// Materials.
    pub surfaces: SurfaceMaterials<'a>,
    /// The lamps.
    pub lamps: Vec<SphereLamp>,
    /// The sea surface; `None` in unbounded water.
    pub sea: Option<Sea>,
    /// The water of each channel.
    pub water: [WaterCoefficients; 3],
    /// Phase function.
    pub phase: Phase,
    /// Turbidity over space.
    pub turbidity: TurbidityField,
}

/// A ray of the camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Along {
    /// Origin.
    pub origin: DVec3,
    /// Unit vector.
    pub direction: DVec3,
}

/// Kind of a segment's end.
pub(crate) enum SegmentEnd {
    /// Unbounded.
    Nothing,
    /// A surface.
    Surface { hit: Hit, material: Lambertian },
    /// The sea surface, at a cosine from the vertical.
    Sea { cosine: f64 },
}

/// The end of a segment.
pub(crate) struct End {
    /// Along the segment, m; infinite if unbounded.
    pub(crate) distance: f64,
    pub(crate) met: SegmentEnd,
}

/// Channels with attenuations within this factor share their paths.
const SIMILAR: f64 = 3.0;

impl TracedScene<'_> {
    /// Whether a path for all channels has about the errors of a path for each.
    pub(crate) fn has_similar_channels(&self) -> bool {
        let attenuations = self.water.map(|water| water.attenuation());
        let most = attenuations.into_iter().fold(0.0, f64::max);
        attenuations
            .into_iter()
            .all(|attenuation| most <= SIMILAR * attenuation)
    }

    /// Finds the end of a segment.
    pub(crate) fn end(&self, along: Along, from: f64) -> End {
        let Along { origin, direction } = along;
        let sea = self.sea.as_ref().and_then(|sea| sea.distance(origin, direction));
        let reach = sea.unwrap_or(f64::INFINITY);
        if let Some(hit) = self.rays.hit(origin.into(), direction.into(), from, reach) {
            let place = origin + direction * hit.distance;
            return End {
                distance: hit.distance,
                met: SegmentEnd::Surface {
                    hit,
                    material: self.surfaces.material(&hit, place),
                },
            };
        }
        match (sea, &self.sea) {
            (Some(distance), Some(sea)) => End {
                distance,
                met: SegmentEnd::Sea {
                    cosine: sea.up.dot(direction).min(1.0),
                },
            },
            _ => End {
                distance: f64::INFINITY,
                met: SegmentEnd::Nothing,
            },
        }
    }

    /// Whether anything blocks the segment of this length.
    pub(crate) fn is_blocked(&self, origin: DVec3, direction: DVec3, from: f64, distance: f64) -> bool {
        self.rays
            .occluded(origin.into(), direction.into(), from, distance)
    }
}
