//! Shadows of a lamp on surfaces: of the lamp row by row, and of the discs of scattered lamp light.

use imaging::rays::{OFFSET, Rays};
use imaging::{Plane, vectorized};

use super::Row;
use super::discs::{Discs, Surfaces};
use super::row::{lens, places_of};
use crate::elementary::{HALVINGS, fade};
use crate::lamp::beam::Profile;
use crate::lamp::shadow::Shadow;
use crate::lamp::sight::{Disc, Radius, Sight, Starts};
use crate::lamp::tiles::{TILE, in_tiles};
use crate::lamp::{Lamp, Lighting};

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
        let mut look = Look::new(lamp, (rays, reach), range.size());
        for top in (0..range.height()).step_by(TILE) {
            look.at_rows(lighting, range, normals, top);
        }
        let Look { seen, facing, .. } = look;
        let surfaces = Surfaces {
            range,
            normals,
            facing: &facing,
            seen: &seen,
        };
        let is_joined = lighting.absorption.is_some();
        let discs = is_joined.then(|| Discs::new(lighting, reach.place, rays, surfaces));
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

/// Traces rays to the lamp, a few rows in one batch.
struct Look<'a> {
    sight: Sight<'a>,
    reach: Reach,
    disc: Disc,
    radius_m: f32,
    /// For traced pixels of the frame: visible share of the lamp, and orientation to it.
    seen: Vec<f32>,
    facing: Vec<f32>,
    /// For the rows: surface points, ray origins, and orientation to the lamp.
    places: [Vec<f32>; 5],
    lanes: [Vec<f32>; 4],
    starts: Starts,
    pixels: Vec<usize>,
    shares: Vec<f32>,
    width: usize,
}

impl<'a> Look<'a> {
    fn new(lamp: &Lamp, (rays, reach): (&'a dyn Rays, Reach), (width, height): (usize, usize)) -> Self {
        let (radius_m, count) = lamp.shadow.disc();
        Self {
            sight: Sight::new(rays),
            reach,
            disc: Disc::new(count),
            radius_m: radius_m as f32,
            // The value does not matter for untraced pixels.
            seen: vec![1.0; width * height],
            facing: Vec::with_capacity(width * height),
            places: [const { Vec::new() }; 5],
            lanes: [const { Vec::new() }; 4],
            starts: Starts::default(),
            pixels: Vec::new(),
            shares: Vec::new(),
            width,
        }
    }

    fn at_rows(&mut self, lighting: &Lighting, range: &Plane<f32>, normals: &[Plane<f32>; 3], top: usize) {
        let (width, reach) = (self.width, self.reach);
        let rows = TILE.min(range.height() - top);
        let (count, first) = (rows * width, top * width);
        self.places.iter_mut().for_each(|lane| lane.resize(count, 0.0));
        self.lanes.iter_mut().for_each(|lane| lane.resize(count, 0.0));
        for row in 0..rows {
            let own = row * width..(row + 1) * width;
            let mut to = self.places.each_mut().map(|lane| &mut lane[own.clone()]);
            let y = top + row;
            vectorized!(places_of(lens(&lighting.camera), y as f32, range.row(y), &mut to));
        }
        // Attenuation is not needed here.
        let all = Row::new((&self.places, 0..count), (normals, first), ([0.0; 3], 0.0));
        vectorized!(starts_in(
            all,
            reach,
            self.lanes.each_mut().map(Vec::as_mut_slice)
        ));
        self.facing.extend_from_slice(&self.lanes[3]);
        self.gather(count);
        let disc = (&self.disc, Radius::Same(self.radius_m));
        self.sight
            .shares(&self.starts, reach.place, disc, &mut self.shares);
        for (&i, &share) in self.pixels.iter().zip(&self.shares) {
            self.seen[first + i] = share;
        }
    }

    /// Lists the traced pixels of the rows, tile by tile. Each is written to the next slot of the list, which advances only after
    /// traced pixels: this avoids an unpredictable branch.
    fn gather(&mut self, count: usize) {
        let [x_m, y_m, z_m, facing] = self.lanes.each_ref().map(|lane| &lane[..count]);
        self.pixels.resize(count, 0);
        let [to_x, to_y, to_z] = self.starts.sized(count);
        let pixels = &mut self.pixels[..count];
        let mut next = 0;
        in_tiles(self.width, count / self.width).for_each(|(x, y)| {
            let i = y * self.width + x;
            (to_x[next], to_y[next], to_z[next], pixels[next]) = (x_m[i], y_m[i], z_m[i], i);
            next += usize::from(facing[i] == IN_BEAM);
        });
        self.starts.truncate(next);
        self.pixels.truncate(next);
    }
}

/// Ray origins toward a lamp, and orientation of surfaces to it.
#[inline(always)]
fn starts_in(
    Row {
        places: [x, y, z, _, shown],
        normals: [nx, ny, nz],
        ..
    }: Row<'_>,
    reach: Reach,
    [to_x, to_y, to_z, stand]: [&mut [f32]; 4],
) {
    let count = x.len();
    let (y, z, shown) = (&y[..count], &z[..count], &shown[..count]);
    let (nx, ny, nz) = (&nx[..count], &ny[..count], &nz[..count]);
    let (to_x, to_y, to_z) = (&mut to_x[..count], &mut to_y[..count], &mut to_z[..count]);
    let stand = &mut stand[..count];
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
        stand[i] = if faces { lit } else { AWAY };
        [to_x[i], to_y[i], to_z[i]] = off([x[i], y[i], z[i]], [nx[i], ny[i], nz[i]]);
    }
}

/// Light of any lamp falls by this per meter at least; patches may be clearer than the mean.
fn fading(lighting: &Lighting) -> f32 {
    let clearest = lighting.patches.as_ref().map_or(1.0, |field| field.extremes().0);
    let all = lighting.absorption.unwrap_or(lighting.attenuation);
    (clearest * all.into_iter().fold(f64::INFINITY, f64::min)) as f32
}

/// As [`imaging::rays::leaving`].
#[inline(always)]
pub(super) fn off([x, y, z]: [f32; 3], normal: [f32; 3]) -> [f32; 3] {
    let meters = (x * x + y * y + z * z).sqrt().max(1.0) * OFFSET as f32;
    [
        x + meters * normal[0],
        y + meters * normal[1],
        z + meters * normal[2],
    ]
}
