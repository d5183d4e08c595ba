//! What things leave of the light of a lamp on surfaces: of the lamp itself row by row, and of the discs that light scattered on its
//! way comes from.

use imaging::rays::{OFFSET, Rays};
use imaging::{Plane, vectorized};

use super::Row;
use crate::elementary::{HALVINGS, fade};
use crate::lamp::beam::Profile;
use crate::lamp::coarse;
use crate::lamp::multiple::surface_scale;
use crate::lamp::shadow::{SPREAD_PLACES, Shadow};
use crate::lamp::sight::{Disc, Radius, Sight, Starts};
use crate::lamp::tiles::in_tiles;
use crate::lamp::{Lamp, Lighting};
use crate::range::is_hole;

/// The discs are looked for from every so many columns and rows.
const STEP: usize = 4;
/// Between places that see shares of a disc which differ by no more, they are read.
const READ_UP_TO: f32 = 0.125;

/// The shadows of one lamp.
pub(super) struct Shade<'a> {
    sight: Sight<'a>,
    reach: Reach,
    disc: Disc,
    radius_m: f32,
    /// Of the pixels of the rows: how much of the lamp is seen.
    seen: Vec<f32>,
    /// Of the pixels of the rows: where ways to the lamp begin, and 1 where one is looked along.
    lanes: [Vec<f32>; 4],
    starts: Starts,
    pixels: Vec<usize>,
    shares: Vec<f32>,
    /// Of the pixels of the frame and each channel: how much of the disc is seen that spread light comes from. Empty where such
    /// light is not followed.
    spread: [Vec<f32>; 3],
    width: usize,
}

/// What a lamp may light.
#[derive(Clone, Copy)]
struct Reach {
    place: [f32; 3],
    profile: Profile,
    /// What the lamp gives at 1 m over what is not seen, and its least attenuation in halvings per meter.
    strength: f32,
    fading: f32,
}

/// What things leave of the light of a lamp in a row.
#[derive(Clone, Copy, Default)]
pub(super) struct RowShade<'a> {
    pub(super) direct: &'a [f32],
    pub(super) spread: [&'a [f32]; 3],
}

impl<'a> Shade<'a> {
    /// None of a lamp whose light nothing cuts off.
    pub(super) fn new(
        lamp: &Lamp,
        lighting: &Lighting,
        (range, normals): (&Plane<f32>, &[Plane<f32>; 3]),
        (rays, unseen): (&'a dyn Rays, f64),
    ) -> Option<Self> {
        if lamp.shadow == Shadow::None {
            return None;
        }
        let (radius_m, count) = lamp.shadow.disc();
        let mut shade = Self {
            sight: Sight::new(rays),
            reach: Reach {
                place: lamp.position_m.map(|v| v as f32),
                profile: lamp.beam.single(),
                strength: (lamp.intensity.into_iter().fold(0.0, f64::max) / unseen.max(1e-30)) as f32,
                fading: fading(lighting) * HALVINGS,
            },
            disc: Disc::new(count),
            radius_m: radius_m as f32,
            seen: Vec::new(),
            lanes: [const { Vec::new() }; 4],
            starts: Starts::default(),
            pixels: Vec::new(),
            shares: Vec::new(),
            spread: [const { Vec::new() }; 3],
            width: range.width(),
        };
        if lighting.absorption.is_some() {
            shade.spread = shade.look_for_discs(lighting, range, normals);
        }
        Some(shade)
    }

    /// Looks for the lamp from the surfaces of a few rows that it may light.
    pub(super) fn look(&mut self, rows: Row<'_>) {
        let (count, reach) = (rows.places[0].len(), self.reach);
        self.lanes.iter_mut().for_each(|lane| lane.resize(count, 0.0));
        vectorized!(starts_in(
            rows,
            reach,
            self.lanes.each_mut().map(Vec::as_mut_slice)
        ));
        self.gather(count);
        let disc = (&self.disc, Radius::Same(self.radius_m));
        self.sight
            .shares(&self.starts, reach.place, disc, &mut self.shares);
        // Elsewhere it does not matter.
        self.seen.clear();
        self.seen.resize(count, 1.0);
        for (&i, &share) in self.pixels.iter().zip(&self.shares) {
            self.seen[i] = share;
        }
    }

    /// Lists the pixels of the rows that are looked from, tile by tile. Each is written where the next one of the list stands, which
    /// moves on only behind those that are looked from: without a branch that cannot be foreseen.
    fn gather(&mut self, count: usize) {
        let [x_m, y_m, z_m, lit] = self.lanes.each_ref().map(|lane| &lane[..count]);
        self.pixels.resize(count, 0);
        let [to_x, to_y, to_z] = self.starts.sized(count);
        let pixels = &mut self.pixels[..count];
        let mut next = 0;
        in_tiles(self.width, count / self.width).for_each(|(x, y)| {
            let i = y * self.width + x;
            (to_x[next], to_y[next], to_z[next], pixels[next]) = (x_m[i], y_m[i], z_m[i], i);
            next += usize::from(lit[i] != 0.0);
        });
        self.starts.truncate(next);
        self.pixels.truncate(next);
    }

    /// What is left in row `y` of the frame, which is number `row` of those that were looked from last.
    pub(super) fn of_row(&self, y: usize, row: usize) -> RowShade<'_> {
        let of_frame = y * self.width..(y + 1) * self.width;
        RowShade {
            direct: &self.seen[row * self.width..(row + 1) * self.width],
            spread: self
                .spread
                .each_ref()
                .map(|lane| lane.get(of_frame.clone()).unwrap_or_default()),
        }
    }

    fn look_for_discs(
        &mut self,
        lighting: &Lighting,
        range: &Plane<f32>,
        normals: &[Plane<f32>; 3],
    ) -> [Vec<f32>; 3] {
        let camera = &lighting.camera;
        let width = self.width;
        let start_of = |at: usize| {
            let (x, y) = (at % width, at / width);
            let ray = camera.ray(x as f64, y as f64);
            let meters = f64::from(range.data()[at]) / ray.length();
            let place = <[f64; 3]>::from(ray).map(|v| (v * meters) as f32);
            (place, [0, 1, 2].map(|axis| normals[axis].data()[at]))
        };
        let lamp = self.reach.place;
        let faces = |at: usize| {
            let (place, normal) = start_of(at);
            let facing: f32 = (0..3).map(|i| normal[i] * (lamp[i] - place[i])).sum();
            !is_hole(range.data()[at]) && facing > 0.0
        };
        let disc = Disc::new(SPREAD_PLACES);
        let sight = &mut self.sight;
        let (mut starts, mut radii, mut shares) = (Starts::default(), Vec::new(), Vec::new());
        let all = coarse::fill(
            range,
            STEP,
            faces,
            |_, around| (0..3).all(|c| difference(around.map(|values| values[c])) <= READ_UP_TO),
            |pixels, values| {
                starts.clear();
                for &at in pixels {
                    let (place, normal) = start_of(at);
                    // The sight of a hole is never read.
                    let is_hole = is_hole(range.data()[at]);
                    starts.push(if is_hole { lamp } else { off(place, normal) });
                }
                values.clear();
                values.resize(pixels.len(), [1.0; 3]);
                for channel in 0..3 {
                    let b = lighting.scattering[channel];
                    radii.clear();
                    radii.extend((0..starts.len()).map(|i| {
                        let meters = distance(starts.place(i), lamp);
                        meters * surface_scale(b * f64::from(meters)) as f32
                    }));
                    sight.shares(&starts, lamp, (&disc, Radius::Of(&radii)), &mut shares);
                    for (value, &share) in values.iter_mut().zip(&shares) {
                        value[channel] = share;
                    }
                }
            },
        );
        [0, 1, 2].map(|channel| all.iter().map(|values| values[channel]).collect())
    }
}

/// Where ways to a lamp begin, and 1 on surfaces that face it, stand in its beam and are lit by more than what is not seen.
#[inline(always)]
fn starts_in(
    Row {
        places: [x, y, z, _, shown],
        normals: [nx, ny, nz],
        ..
    }: Row<'_>,
    reach: Reach,
    [to_x, to_y, to_z, lit]: [&mut [f32]; 4],
) {
    let count = x.len();
    let (y, z, shown) = (&y[..count], &z[..count], &shown[..count]);
    let (nx, ny, nz) = (&nx[..count], &ny[..count], &nz[..count]);
    let (to_x, to_y, to_z) = (&mut to_x[..count], &mut to_y[..count], &mut to_z[..count]);
    let lit = &mut lit[..count];
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
        let is_lit =
            (shown[i] != 0.0) & (facing > 0.0) & (light > 1.0) & (offset * meters - slope * along > 0.0);
        lit[i] = if is_lit { 1.0 } else { 0.0 };
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
fn off([x, y, z]: [f32; 3], normal: [f32; 3]) -> [f32; 3] {
    let meters = (x * x + y * y + z * z).sqrt().max(1.0) * OFFSET as f32;
    [
        x + meters * normal[0],
        y + meters * normal[1],
        z + meters * normal[2],
    ]
}

fn distance(a: [f32; 3], b: [f32; 3]) -> f32 {
    (0..3).map(|i| (a[i] - b[i]) * (a[i] - b[i])).sum::<f32>().sqrt()
}

/// By how much values differ at most.
fn difference(values: [f32; 4]) -> f32 {
    let (least, most) = values
        .into_iter()
        .fold((f32::INFINITY, f32::NEG_INFINITY), |(least, most), v| {
            (least.min(v), most.max(v))
        });
    most - least
}
