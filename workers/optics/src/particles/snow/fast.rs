//! Snow in f32: each particle on the pixels that it changes by more than its share of the tolerance.

use std::ops::Range;

use imaging::{Plane, Rgb, cancel, vectorized};

use super::{Flake, LitFlake, Spot};
use crate::extremes::brightest;
use crate::range::is_hole;

/// [`snow_reference`](super::snow_reference) in place with an error below `tolerance` in linear light, rounding of f32 apart;
/// `range` in meters along the ray to the surface, which occludes farther particles; infinite at a hole.
/// Compositing never enlarges an error below it, so the errors of the particles add at most: each may omit
/// changes below tolerance / number of particles.
#[must_use]
pub fn snow(image: &mut Rgb<f32>, flakes: &[LitFlake], range: &Plane<f32>, tolerance: f64) -> Plane<f32> {
    let (width, height) = image.size();
    // Both grow from 0, so that many faint particles keep their digits.
    let mut change = Rgb::from_fn(width, height, |_, _| [0.0f32; 3]);
    let mut mask = Plane::filled(width, height, 0.0f32);
    let share = tolerance / flakes.len().max(1) as f64;
    let mut brightest = brightest(image).map(f64::from);
    let mut weights = Vec::new();
    for LitFlake {
        flake,
        opacity,
        color,
    } in flakes
    {
        cancel::check();
        let most = (0..3).fold(0.0f64, |most, i| {
            brightest[i] = brightest[i].max(color[i]);
            most.max(opacity[i] * brightest[i])
        });
        if most <= share {
            continue;
        }
        let [columns, rows] = pixels_of(flake, (width, height));
        if columns.is_empty() {
            continue;
        }
        let color = color.map(|v| v as f32);
        let mut profile = Profile::new(&flake.spot, flake.center, columns.clone(), &mut weights);
        for row in rows {
            profile.fill_row(row);
            let weights = &*profile.weights;
            let opacity = opacity.map(|v| v as f32);
            let at = row * width + columns.start..row * width + columns.end;
            let behind = &range.data()[at.clone()];
            let base = image.planes().each_ref().map(|plane| &plane.data()[at.clone()]);
            let [red, green, blue] = change.planes_mut().map(|plane| &mut plane[at.clone()]);
            let mask = &mut mask.data_mut()[at];
            for i in 0..weights.len() {
                let hidden = !is_hole(behind[i]) && f64::from(behind[i]) <= flake.range_m;
                let weight = if hidden { 0.0 } else { weights[i] };
                red[i] += (color[0] - (base[0][i] + red[i])) * (opacity[0] * weight);
                green[i] += (color[1] - (base[1][i] + green[i])) * (opacity[1] * weight);
                blue[i] += (color[2] - (base[2][i] + blue[i])) * (opacity[2] * weight);
                mask[i] += (1.0 - mask[i]) * (opacity[1] * weight);
            }
        }
    }
    for (plane, change) in image.planes_mut().into_iter().zip(change.planes()) {
        plane
            .iter_mut()
            .zip(change.data())
            .for_each(|(light, change)| *light += change);
    }
    mask
}

/// Columns and rows that a particle reaches.
fn pixels_of(flake: &Flake, (width, height): (usize, usize)) -> [Range<usize>; 2] {
    let span = |center: f64, reach: f64, side: usize| {
        let first = (center - reach).ceil().max(0.0) as usize;
        first..((center + reach).floor() + 1.0).clamp(0.0, side as f64) as usize
    };
    let reach = flake.spot.reach();
    [
        span(flake.center[0], reach[0], width),
        span(flake.center[1], reach[1], height),
    ]
}

/// Whether a pixel that a particle reaches shows something behind it.
#[must_use]
pub fn is_in_front(flake: &Flake, range: &Plane<f32>) -> bool {
    let [columns, mut rows] = pixels_of(flake, range.size());
    let is_farther = |&z: &f32| is_hole(z) || f64::from(z) > flake.range_m;
    !columns.is_empty() && rows.any(|row| range.row(row)[columns.clone()].iter().any(is_farther))
}

/// The weights of a spot along the columns that it reaches.
struct Profile<'a> {
    spot: Spot,
    center: [f64; 2],
    first: usize,
    weights: &'a mut Vec<f32>,
}

impl<'a> Profile<'a> {
    fn new(spot: &Spot, center: [f64; 2], columns: Range<usize>, weights: &'a mut Vec<f32>) -> Self {
        weights.clear();
        weights.resize(columns.len(), 0.0);
        Self {
            spot: *spot,
            center,
            first: columns.start,
            weights,
        }
    }

    /// Computes the weights of a row.
    fn fill_row(&mut self, row: usize) {
        let away = (row as f64 - self.center[1]) as f32;
        let start = (self.first as f64 - self.center[0]) as f32;
        let Spot { radius, edge, streak } = self.spot;
        let disc = [radius, edge].map(|v| v as f32);
        let streak = streak.map(|v| v as f32);
        vectorized!(across(self.weights, (start, away), disc, streak));
    }
}

/// [`Spot::at`] of a disc along a row in f32.
#[inline(always)]
fn across(weights: &mut [f32], (start, dy): (f32, f32), [radius, edge]: [f32; 2], [sx, sy]: [f32; 2]) {
    let square = sx * sx + sy * sy;
    let inverse = if square > 0.0 { 1.0 / square } else { 0.0 };
    let (outer, steep) = (radius + edge, 0.5 / edge);
    for (i, weight) in weights.iter_mut().enumerate() {
        let dx = start + i as i32 as f32;
        let along = ((dx * sx + dy * sy) * inverse).max(-0.5).min(0.5);
        let (ax, ay) = (dx - along * sx, dy - along * sy);
        let away = (ax * ax + ay * ay).sqrt();
        *weight = ((outer - away) * steep).max(0.0).min(1.0);
    }
}
