//! A quadrature for multiple scattering, whose integrand has kinks: cells of two Gauss nodes each, finer toward the ends of the
//! ray, doubled until the sums agree.
//!
//! The error of a sum of n cells is estimated by its difference from the sum of n/2 cells, on the worst pixel of a run. With kinks
//! the error falls as 1/n² at least, so the difference is three times the error. Two sums may agree by chance, but hardly three: a
//! share of the previous difference is used if it is larger, and all of it if no sums agree within the tolerance. Differences count
//! beyond the tolerated share of the light.

use std::f32::consts::FRAC_PI_2;
use std::f64::consts::PI;
use std::sync::LazyLock;

use imaging::vectorized;

use super::integrand::{SpreadNode, scattered};
use super::intervals::{Intervals, extreme};
use super::{Glow, Lanes, RUN};
use crate::elementary::{angle, sin_cos};

/// Cells of the first sum, and how often they are halved.
const CELLS: usize = 4;
const HALVINGS: usize = 5;
/// Half the distance of the two Gauss–Legendre nodes of a cell, in cells.
const NODE: f64 = 0.288_675_134_594_812_9;

/// Of the difference before the last one.
const AGREED: f64 = 0.3;
/// Nodes are at most this many widths of the peak, (1 − g)/√g, apart.
const NODES_OF_PEAK: f64 = 1.0;
/// Light of less than this is lost in f32.
pub(super) const LEAST: f64 = 1e-30;

/// The nodes of each level: where in the interval, 0..=1, and the weight; all weights add up to 2.
static LEVELS: LazyLock<[Vec<[f32; 2]>; HALVINGS + 1]> =
    LazyLock::new(|| std::array::from_fn(|level| nodes(CELLS << level)));

/// Equal cells in u, with `(1 − cos π u)/2` the position in the interval.
fn nodes(cells: usize) -> Vec<[f32; 2]> {
    let node = |at: usize| {
        let side = if at.is_multiple_of(2) { -NODE } else { NODE };
        let u = (at as f64 / 2.0).floor() + 0.5 + side;
        let turn = PI * u / cells as f64;
        [0.5 * (1.0 - turn.cos()), 0.5 * PI * turn.sin() / cells as f64].map(|v| v as f32)
    };
    (0..2 * cells).map(node).collect()
}

/// The light of a lamp on a run of pixels, and the error bound of the quadrature beyond the tolerated share of the light.
pub(super) struct Sum {
    pub(super) light: [Lanes; 3],
    pub(super) left: f64,
}

/// Largest spacing of nodes in β that resolves the peak of the phase function.
pub(super) fn spacing(asymmetry: f64) -> f32 {
    let g = asymmetry.abs().max(1e-3);
    (NODES_OF_PEAK * (1.0 - g) / g.sqrt()) as f32
}

/// Integrates along the rays of a run. Nodes are at most `spacing` apart in β, so narrower features are missed.
pub(super) fn sum_up<const SPOT: bool>(lamp: &Glow, to: &Intervals, spacing: f32) -> Sum {
    let widest = 2.0 * extreme(&to.half, f32::max);
    let fits = |level: &usize| FRAC_PI_2.min(1.6 * widest) <= spacing * ((2 * CELLS) << level) as f32;
    let first = (0..HALVINGS).find(fits).unwrap_or(HALVINGS - 1);
    let mut sum = Sum {
        light: level::<SPOT>(lamp, to, first),
        left: f64::INFINITY,
    };
    let mut before = f64::INFINITY;
    let share = lamp.tolerated_share as f32;
    for next in first + 1..=HALVINGS {
        let finer = level::<SPOT>(lamp, to, next);
        let mut most = [0.0f32; RUN];
        for (coarse, fine) in sum.light.iter().zip(&finer) {
            for i in 0..RUN {
                most[i] = most[i].max((-share).mul_add(fine[i], (fine[i] - coarse[i]).abs()));
            }
        }
        let differs = f64::from(extreme(&most, f32::max));
        sum = Sum {
            light: finer,
            left: differs.max(AGREED * before).max(LEAST),
        };
        if sum.left <= lamp.source.tolerance {
            break;
        }
        if next == HALVINGS {
            sum.left = sum.left.max(before);
        }
        before = differs;
    }
    sum
}

/// The sum of one level, in linear light.
fn level<const SPOT: bool>(lamp: &Glow, to: &Intervals, level: usize) -> [Lanes; 3] {
    let mut light = [[0.0f32; RUN]; 3];
    if SPOT {
        spread_at_nodes(lamp, to, &LEVELS[level], &mut light);
    } else {
        vectorized!(at_nodes(lamp, to, &LEVELS[level], &mut light));
    }
    for (light, gain) in light.iter_mut().zip(lamp.gain) {
        for i in 0..RUN {
            light[i] *= gain * to.scale[i];
        }
    }
    light
}

fn spread_at_nodes(lamp: &Glow, to: &Intervals, nodes: &[[f32; 2]], light: &mut [Lanes; 3]) {
    let (mut spread, mut from, mut angles) = (SpreadNode::dark(), [0.0f32; RUN], [0.0f32; RUN]);
    vectorized!(starts_of(to, &mut from));
    for &[place, weight] in nodes {
        vectorized!(angles_of(to, (place, &from), &mut angles));
        spread.shine(lamp, to, &angles);
        vectorized!(add_weighted(weight, &spread.light, light));
    }
}

/// Adds `weight` times the light of a node.
#[inline(always)]
fn add_weighted(weight: f32, node: &[Lanes; 3], light: &mut [Lanes; 3]) {
    for (light, node) in light.iter_mut().zip(node) {
        for i in 0..RUN {
            light[i] = weight.mul_add(node[i], light[i]);
        }
    }
}

/// Where the intervals begin, in β.
#[inline(always)]
fn starts_of(to: &Intervals, from: &mut Lanes) {
    for i in 0..RUN {
        from[i] = angle(to.sin[i], to.cos[i]) - to.half[i];
    }
}

#[inline(always)]
fn angles_of(to: &Intervals, (place, from): (f32, &Lanes), angles: &mut Lanes) {
    for i in 0..RUN {
        angles[i] = (2.0 * place).mul_add(to.half[i], from[i]).max(0.0).min(FRAC_PI_2);
    }
}

#[inline(always)]
fn at_nodes(lamp: &Glow, to: &Intervals, nodes: &[[f32; 2]], light: &mut [Lanes; 3]) {
    let [mut from, mut angles] = [[0.0f32; RUN]; 2];
    starts_of(to, &mut from);
    let [red, green, blue] = light;
    for &[place, weight] in nodes {
        angles_of(to, (place, &from), &mut angles);
        for i in 0..RUN {
            let ray = [to.nearest[i], to.distance[i], to.across[i], to.along[i]];
            let [r, g, b] = scattered::<false, true, true>(lamp, ray, sin_cos(angles[i]));
            red[i] = weight.mul_add(r, red[i]);
            green[i] = weight.mul_add(g, green[i]);
            blue[i] = weight.mul_add(b, blue[i]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_level_integrates_smooth_and_kinked_functions() {
        for (level, nodes) in LEVELS.iter().enumerate() {
            let weights: f64 = nodes.iter().map(|[_, weight]| f64::from(*weight)).sum();
            assert!((weights - 2.0).abs() < 2e-3, "{level}: {weights}");
            let integral = |f: &dyn Fn(f64) -> f64| -> f64 {
                let terms = nodes.iter().map(|[x, w]| 0.5 * f64::from(*w) * f(f64::from(*x)));
                terms.sum()
            };
            let cells = (CELLS << level) as f64;
            let cubic = integral(&|x| x * x * x);
            assert!((cubic - 0.25).abs() < 0.5 / (cells * cells), "{level}: {cubic}");
            let kink = integral(&|x| (x - 0.37).abs());
            let exact = 0.5 * (0.37f64.powi(2) + 0.63f64.powi(2));
            assert!((kink - exact).abs() < 2.0 / (cells * cells), "{level}: {kink}");
        }
    }
}
