//! What things leave of the light of a lamp on surfaces: of the lamp itself row by row, and of the discs that light scattered on its
//! way comes from.

use imaging::Plane;
use imaging::rays::{OFFSET, Rays};

use super::Row;
use crate::lamp::beam::Profile;
use crate::lamp::coarse;
use crate::lamp::multiple::surface_scale;
use crate::lamp::shadow::{SPREAD_PLACES, Shadow};
use crate::lamp::sight::{Disc, Sight};
use crate::lamp::{Lamp, Lighting};
use crate::range::is_hole;

/// The discs are looked for from every so many columns and rows.
const STEP: usize = 4;
/// Between places that see shares of a disc which differ by no more, they are read.
const READ_UP_TO: f32 = 0.125;

/// The shadows of one lamp.
pub(super) struct Shade<'a> {
    sight: Sight<'a>,
    place: [f32; 3],
    profile: Profile,
    disc: Disc,
    radius_m: f32,
    /// What the lamp gives at 1 m over what is not seen, and its least attenuation.
    strength: f32,
    fading: f32,
    /// Of the pixels of the row: how much of the lamp is seen.
    seen: Vec<f32>,
    starts: Vec<[f32; 3]>,
    pixels: Vec<usize>,
    shares: Vec<f32>,
    /// Of the pixels of the frame and each channel: how much of the disc is seen that spread light comes from. Empty where such
    /// light is not followed.
    spread: [Vec<f32>; 3],
    width: usize,
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
            place: lamp.position_m.map(|v| v as f32),
            profile: lamp.beam.single(),
            disc: Disc::new(count),
            radius_m: radius_m as f32,
            strength: (lamp.intensity.into_iter().fold(0.0, f64::max) / unseen.max(1e-30)) as f32,
            fading: fading(lighting),
            seen: vec![1.0; range.width()],
            starts: Vec::new(),
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

    /// Looks for the lamp from the surfaces of a row that it may light.
    pub(super) fn look(&mut self, row: Row<'_>) {
        let [x, y_m, z, _, shown] = row.places;
        self.starts.clear();
        self.pixels.clear();
        for i in 0..self.width {
            let place = [x[i], y_m[i], z[i]];
            let normal = [0, 1, 2].map(|axis| row.normals[axis][i]);
            if shown[i] != 0.0 && self.may_light(place, normal) {
                self.starts.push(off(place, normal));
                self.pixels.push(i);
            }
        }
        let radius_m = self.radius_m;
        self.sight.shares(
            &self.starts,
            self.place,
            (&self.disc, |_| radius_m),
            &mut self.shares,
        );
        // Elsewhere it does not matter.
        self.seen.fill(1.0);
        for (&i, &share) in self.pixels.iter().zip(&self.shares) {
            self.seen[i] = share;
        }
    }

    /// How much of the lamp is seen in the row that was looked from last.
    pub(super) fn seen(&self) -> &[f32] {
        &self.seen
    }

    /// What is left in the row that was looked from last.
    pub(super) fn of_row(&self, y: usize) -> RowShade<'_> {
        let row = y * self.width..(y + 1) * self.width;
        RowShade {
            direct: &self.seen,
            spread: self
                .spread
                .each_ref()
                .map(|lane| lane.get(row.clone()).unwrap_or_default()),
        }
    }

    /// Whether a surface faces the lamp, stands in its beam and is lit by more than what is not seen.
    fn may_light(&self, place: [f32; 3], normal: [f32; 3]) -> bool {
        let way = [0, 1, 2].map(|i| self.place[i] - place[i]);
        let along = |a: [f32; 3]| a[0] * way[0] + a[1] * way[1] + a[2] * way[2];
        let meters = along(way).sqrt();
        let Profile {
            axis, slope, offset, ..
        } = self.profile;
        let facing = along(normal);
        let light = self.strength * facing / (meters * meters * meters) * (-self.fading * meters).exp();
        facing > 0.0 && light > 1.0 && offset * meters - slope * along(axis) > 0.0
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
        let lamp = self.place;
        let faces = |at: usize| {
            let (place, normal) = start_of(at);
            let facing: f32 = (0..3).map(|i| normal[i] * (lamp[i] - place[i])).sum();
            !is_hole(range.data()[at]) && facing > 0.0
        };
        let disc = Disc::new(SPREAD_PLACES);
        let sight = &mut self.sight;
        let (mut starts, mut shares) = (Vec::new(), Vec::new());
        let all = coarse::fill(
            range,
            STEP,
            faces,
            |_, around| (0..3).all(|c| difference(around.map(|values| values[c])) <= READ_UP_TO),
            |pixels, values| {
                starts.clear();
                starts.extend(pixels.iter().map(|&at| {
                    let (place, normal) = start_of(at);
                    // The sight of a hole is never read.
                    if is_hole(range.data()[at]) {
                        lamp
                    } else {
                        off(place, normal)
                    }
                }));
                values.clear();
                values.resize(pixels.len(), [1.0; 3]);
                for channel in 0..3 {
                    let b = lighting.scattering[channel];
                    let radius_m = |i: usize| {
                        let meters = distance(starts[i], lamp);
                        meters * surface_scale(b * f64::from(meters)) as f32
                    };
                    sight.shares(&starts, lamp, (&disc, radius_m), &mut shares);
                    for (value, &share) in values.iter_mut().zip(&shares) {
                        value[channel] = share;
                    }
                }
            },
        );
        [0, 1, 2].map(|channel| all.iter().map(|values| values[channel]).collect())
    }
}

/// Light of any lamp falls by this per meter at least; patches may be clearer than the mean.
fn fading(lighting: &Lighting) -> f32 {
    let clearest = lighting.patches.as_ref().map_or(1.0, |field| field.extremes().0);
    let all = lighting.absorption.unwrap_or(lighting.attenuation);
    (clearest * all.into_iter().fold(f64::INFINITY, f64::min)) as f32
}

/// As [`imaging::rays::leaving`].
fn off(place: [f32; 3], normal: [f32; 3]) -> [f32; 3] {
    let meters = distance(place, [0.0; 3]).max(1.0) * OFFSET as f32;
    [0, 1, 2].map(|i| place[i] + meters * normal[i])
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
