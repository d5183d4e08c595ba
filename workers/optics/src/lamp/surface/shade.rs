//! Shadows of a lamp on surfaces: in its direct light, and in its scattered light by discs.

use imaging::geometry::Intrinsics;
use imaging::rays::{OFFSET, Rays};
use imaging::{Plane, vectorized};

use super::Row;
use super::discs::{Discs, LitSurfaces};
use super::row::{lens, places_of};
use crate::elementary::{HALVINGS, fade};
use crate::lamp::beam::Profile;
use crate::lamp::shadow::Shadow;
use crate::lamp::sight::{Disc, Radius, Sight, Starts};
use crate::lamp::{Lamp, Lighting};
use crate::view::lattice::trace_changes;

/// Orientation of a surface to a lamp: turned away or a hole; lit by at most the unseen light; outside the beam, with scattered
/// light only; in the beam.
pub(super) const AWAY: f32 = 0.0;
const DIM: f32 = 1.0;
pub(super) const LIT: f32 = 2.0;
pub(super) const IN_BEAM: f32 = 3.0;

/// The shadows of one lamp.
pub(super) struct Shade {
    /// Of the pixels of the frame, how much of the lamp is seen.
    seen: Vec<f32>,
    /// `None` if multiple scattering is not modeled.
    discs: Option<Discs>,
    width: usize,
}

/// Range of a lamp.
#[derive(Clone, Copy)]
struct Reach {
    place: [f32; 3],
    profile: Profile,
    /// Ratio of the lamp's light at 1 m to the unseen light, and its least attenuation in halvings per meter.
    strength: f32,
    fading: f32,
}

/// Shadows of a lamp in a row.
#[derive(Clone, Copy, Default)]
pub(super) struct RowShade<'a> {
    pub(super) direct: &'a [f32],
    pub(super) spread: [&'a [f32]; 3],
}

impl Shade {
    /// `None` for a lamp without shadows.
    pub(super) fn new(
        lamp: &Lamp,
        lighting: &Lighting,
        (range, normals): (&Plane<f32>, &[Plane<f32>; 3]),
        (rays, unseen): (&dyn Rays, f64),
    ) -> Option<Self> {
        if lamp.shadow == Shadow::None {
            return None;
        }
        let reach = Reach {
            place: lamp.position_m.map(|v| v as f32),
            profile: lamp.beam.single(),
            strength: (lamp.intensity.into_iter().fold(0.0, f64::max) / unseen.max(1e-30)) as f32,
            fading: fading(lighting) * HALVINGS,
        };
        let surfaces = Surfaces {
            camera: &lighting.camera,
            range,
            normals,
        };
        let facing = surfaces.orient(reach);
        let seen = surfaces.see_lamp(lamp, rays, &facing);
        let lit = LitSurfaces {
            surfaces,
            facing: &facing,
            seen: &seen,
        };
        let is_joined = lighting.absorption.is_some();
        let discs = is_joined.then(|| Discs::new(lighting, reach.place, rays, lit));
        Some(Self {
            seen,
            discs,
            width: range.width(),
        })
    }

    /// Shadows in row `y`.
    pub(super) fn of_row(&self, y: usize) -> RowShade<'_> {
        RowShade {
            direct: &self.seen[y * self.width..(y + 1) * self.width],
            spread: self
                .discs
                .as_ref()
                .map(|discs| discs.of_row(y))
                .unwrap_or_default(),
        }
    }
}

/// Visible surfaces of a camera.
#[derive(Clone, Copy)]
pub(super) struct Surfaces<'a> {
    pub(super) camera: &'a Intrinsics,
    pub(super) range: &'a Plane<f32>,
    pub(super) normals: &'a [Plane<f32>; 3],
}

impl Surfaces<'_> {
    /// Orientation of each pixel's surface to a lamp.
    fn orient(self, reach: Reach) -> Vec<f32> {
        let (width, height) = self.range.size();
        let mut places = [(); 5].map(|()| vec![0.0f32; width]);
        let mut facing = vec![AWAY; width * height];
        for (y, facing) in facing.chunks_mut(width).enumerate() {
            let mut to = places.each_mut().map(Vec::as_mut_slice);
            vectorized!(places_of(lens(self.camera), y as f32, self.range.row(y), &mut to));
            // Attenuation is not needed here.
            let row = Row::new((&places, 0..width), (self.normals, y * width), ([0.0; 3], 0.0));
            vectorized!(find_orientations(row, reach, facing));
        }
        facing
    }

    /// Visible share of a lamp from the surfaces in its beam; 1 elsewhere, where it does not matter.
    fn see_lamp(self, lamp: &Lamp, rays: &dyn Rays, facing: &[f32]) -> Vec<f32> {
        let (radius_m, count) = lamp.shadow.disc();
        let place = lamp.position_m.map(|v| v as f32);
        let (disc, mut sight, mut starts) = (Disc::new(count), Sight::new(rays), Starts::default());
        trace_changes(
            (self.range, self.camera.focal_px),
            |at| facing[at] == IN_BEAM,
            1.0,
            |pixels, shares| {
                starts.clear();
                pixels.iter().for_each(|&at| starts.push(self.start(at)));
                let disc = (&disc, Radius::Same(radius_m as f32));
                sight.shares(&starts, place, disc, shares);
            },
        )
    }

    /// Where shadow rays of a pixel start: above its surface, as [`imaging::rays::leaving`].
    pub(super) fn start(self, at: usize) -> [f32; 3] {
        let (x, y) = (at % self.range.width(), at / self.range.width());
        let ray = self.camera.ray(x as f64, y as f64);
        let meters = f64::from(self.range.data()[at]) / ray.length();
        let [x, y, z] = <[f64; 3]>::from(ray).map(|v| (v * meters) as f32);
        let off = (x * x + y * y + z * z).sqrt().max(1.0) * OFFSET as f32;
        let normal = self.normals.each_ref().map(|axis| axis.data()[at]);
        [x + off * normal[0], y + off * normal[1], z + off * normal[2]]
    }
}

/// Orientation of the surfaces of a row to a lamp.
#[inline(always)]
fn find_orientations(
    Row {
        places: [x, y, z, _, shown],
        normals: [nx, ny, nz],
        ..
    }: Row<'_>,
    reach: Reach,
    orientations: &mut [f32],
) {
    let count = x.len();
    let (y, z, shown) = (&y[..count], &z[..count], &shown[..count]);
    let (nx, ny, nz) = (&nx[..count], &ny[..count], &nz[..count]);
    let orientations = &mut orientations[..count];
    let (
        [px, py, pz],
        Profile {
            axis, slope, offset, ..
        },
    ) = (reach.place, reach.profile);
    for i in 0..count {
        let (wx, wy, wz) = (px - x[i], py - y[i], pz - z[i]);
        let meters = (wx * wx + wy * wy + wz * wz).sqrt();
        let facing = nx[i] * wx + ny[i] * wy + nz[i] * wz;
        let along = axis[0] * wx + axis[1] * wy + axis[2] * wz;
        let light = reach.strength * facing / (meters * meters * meters) * fade(reach.fading, meters);
        let in_beam = offset * meters - slope * along > 0.0;
        let lit = if in_beam { IN_BEAM } else { LIT };
        let lit = if light > 1.0 { lit } else { DIM };
        let faces = (shown[i] != 0.0) & (facing > 0.0);
        orientations[i] = if faces { lit } else { AWAY };
    }
}

/// Light of any lamp falls by this per meter at least; patches may be clearer than the mean.
fn fading(lighting: &Lighting) -> f32 {
    let clearest = lighting.patches.as_ref().map_or(1.0, |field| field.extremes().0);
    let all = lighting.absorption.unwrap_or(lighting.attenuation);
    (clearest * all.into_iter().fold(f64::INFINITY, f64::min)) as f32
}

#[cfg(test)]
mod tests;
