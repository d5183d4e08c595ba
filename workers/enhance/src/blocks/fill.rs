//! Fills the holes of a plane.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

use imaging::simd::{larger, smaller};
use imaging::{Plane, cancel, vectorized};

use crate::variant::Variant;

/// The plane with its holes filled: the largest `u` with `u = z` on the border and `u = max(z, min of u over the 3 × 3
/// neighborhood)` inside. Basins without a descending path to the border rise to their rim (Soille 1999, morphological
/// reconstruction by erosion).
#[must_use]
pub fn filled(plane: &Plane<f64>, variant: Variant) -> Plane<f64> {
    match variant {
        Variant::Fast => drained(plane),
        Variant::Reference => lowered(plane),
    }
}

/// A flooded pixel, ordered by its level.
#[derive(PartialEq)]
struct Reached {
    level: f64,
    position: usize,
}

impl Eq for Reached {}

impl Ord for Reached {
    fn cmp(&self, other: &Self) -> Ordering {
        self.level
            .total_cmp(&other.level)
            .then(self.position.cmp(&other.position))
    }
}

impl PartialOrd for Reached {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

fn is_border((x, y): (usize, usize), (width, height): (usize, usize)) -> bool {
    x == 0 || y == 0 || x + 1 == width || y + 1 == height
}

/// The pixels of a 3 × 3 neighborhood inside the plane.
fn neighborhood(
    (x, y): (usize, usize),
    (width, height): (usize, usize),
) -> impl Iterator<Item = (usize, usize)> {
    let rows = y.saturating_sub(1)..(y + 2).min(height);
    rows.flat_map(move |y| (x.saturating_sub(1)..(x + 2).min(width)).map(move |x| (x, y)))
}

/// Two sweeps lower nearly every pixel to its level (Vincent 1993, "Morphological grayscale reconstruction"). The rest
/// drains from the lowest level upwards, so that each pixel is visited once (Barnes, Lehman and Mulla 2014,
/// "Priority-flood"): winding basins cost a logarithmic factor.
fn drained(plane: &Plane<f64>) -> Plane<f64> {
    let size = plane.size();
    let mut filled = from_above(plane);
    if size.0 < 3 || size.1 < 3 {
        return filled;
    }
    vectorized!(sweep(plane, &mut filled));
    let mut front = leaks(plane, &mut filled);
    while let Some(Reverse(Reached { level, position })) = front.pop() {
        if position % size.0 == 0 {
            cancel::check();
        }
        if level > filled.data()[position] {
            continue;
        }
        for (x, y) in neighborhood((position % size.0, position / size.0), size) {
            let position = y * size.0 + x;
            let level = larger(level, plane.data()[position]);
            if level < filled.data()[position] {
                filled.data_mut()[position] = level;
                front.push(Reverse(Reached { level, position }));
            }
        }
    }
    filled
}

/// The border unchanged, and the highest level everywhere inside.
fn from_above(plane: &Plane<f64>) -> Plane<f64> {
    let size = plane.size();
    let highest = plane.data().iter().copied().fold(f64::NEG_INFINITY, f64::max);
    Plane::from_fn(size.0, size.1, |x, y| match is_border((x, y), size) {
        true => plane.pixel(x, y),
        false => highest,
    })
}

/// Sweeps forward, then backward: each pixel is lowered to the minimum of its visited neighbors.
#[inline(always)]
fn sweep(plane: &Plane<f64>, filled: &mut Plane<f64>) {
    let (width, height) = plane.size();
    let mut least = vec![0.0; width];
    for y in 1..height - 1 {
        lower_by_row(&mut least, filled.row(y - 1), filled.row(y));
        let (levels, row) = (plane.row(y), filled.row_mut(y));
        let mut level = row[0];
        for x in 1..width - 1 {
            level = larger(smaller(level, least[x]), levels[x]);
            row[x] = level;
        }
    }
    for y in (1..height - 1).rev() {
        lower_by_row(&mut least, filled.row(y + 1), filled.row(y));
        let (levels, row) = (plane.row(y), filled.row_mut(y));
        let mut level = row[width - 1];
        for x in (1..width - 1).rev() {
            level = larger(smaller(level, least[x]), levels[x]);
            row[x] = level;
        }
    }
}

/// Minimum of a pixel and its three neighbors in the previous row of the sweep.
#[inline(always)]
fn lower_by_row(least: &mut [f64], from: &[f64], own: &[f64]) {
    let inside = least.len() - 2;
    let (least, own) = (&mut least[1..=inside], &own[1..=inside]);
    let (left, middle, right) = (&from[..inside], &from[1..=inside], &from[2..inside + 2]);
    for x in 0..inside {
        least[x] = smaller(smaller(left[x], right[x]), smaller(middle[x], own[x]));
    }
}

/// Lowers the pixels with a lower neighbor, and queues them.
fn leaks(plane: &Plane<f64>, filled: &mut Plane<f64>) -> BinaryHeap<Reverse<Reached>> {
    let (width, height) = plane.size();
    let mut front = BinaryHeap::new();
    let mut lowest = vec![0.0; width];
    for y in 1..height - 1 {
        let rows = [y - 1, y, y + 1].map(|y| filled.row(y));
        vectorized!(least_around(&mut lowest, rows));
        let levels = plane.row(y);
        for (x, own) in filled.row_mut(y).iter_mut().enumerate().take(width - 1).skip(1) {
            let level = larger(lowest[x], levels[x]);
            if level < *own {
                *own = level;
                front.push(Reverse(Reached {
                    level,
                    position: y * width + x,
                }));
            }
        }
    }
    front
}

#[inline(always)]
fn least_around(lowest: &mut [f64], [before, own, after]: [&[f64]; 3]) {
    let width = lowest.len();
    let (before, own, after) = (&before[..width], &own[..width], &after[..width]);
    for x in 1..width - 1 {
        let columns = [x - 1, x, x + 1].map(|x| smaller(smaller(before[x], after[x]), own[x]));
        lowest[x] = smaller(smaller(columns[0], columns[1]), columns[2]);
    }
}

/// Reference: iterates from the highest level down to the fixed point.
fn lowered(plane: &Plane<f64>) -> Plane<f64> {
    let size = plane.size();
    let mut filled = from_above(plane);
    loop {
        let next = Plane::from_fn(size.0, size.1, |x, y| {
            let least = neighborhood((x, y), size)
                .map(|(x, y)| filled.pixel(x, y))
                .fold(f64::INFINITY, f64::min);
            match is_border((x, y), size) {
                true => plane.pixel(x, y),
                false => plane.pixel(x, y).max(least),
            }
        });
        if next == filled {
            return filled;
        }
        filled = next;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_basin_rises_to_its_rim_and_no_higher() {
        #[rustfmt::skip]
        let plane = Plane::new(5, 5, vec![
            9.0, 9.0, 9.0, 9.0, 9.0,
            9.0, 1.0, 7.0, 2.0, 9.0,
            9.0, 5.0, 8.0, 3.0, 4.0,
            9.0, 0.0, 8.0, 9.0, 9.0,
            9.0, 9.0, 9.0, 9.0, 9.0,
        ])
        .unwrap();
        #[rustfmt::skip]
        let expected = [
            9.0, 9.0, 9.0, 9.0, 9.0,
            9.0, 7.0, 7.0, 4.0, 9.0,
            9.0, 7.0, 8.0, 4.0, 4.0,
            9.0, 7.0, 8.0, 9.0, 9.0,
            9.0, 9.0, 9.0, 9.0, 9.0,
        ];
        for variant in [Variant::Fast, Variant::Reference] {
            assert_eq!(filled(&plane, variant).data(), expected, "{variant:?}");
        }
    }

    #[test]
    fn water_runs_out_of_a_spiral_whichever_way_it_winds() {
        // Walls of 9 around a path from the border to the middle that runs against both sweeps.
        let ring = |x: usize, y: usize| x.min(y).min(22 - x).min(22 - y);
        let is_wall =
            |x: usize, y: usize| ring(x, y) % 2 == 1 && (x, y) != (ring(x, y) * 3 / 2 + 3, 22 - ring(x, y));
        let spiral = Plane::from_fn(23, 23, |x, y| {
            if is_wall(x, y) {
                9.0
            } else {
                ring(x, y) as f64 / 23.0
            }
        });
        for turned in [
            spiral.clone(),
            Plane::from_fn(23, 23, |x, y| spiral.pixel(22 - y, x)),
        ] {
            assert_eq!(
                filled(&turned, Variant::Fast),
                filled(&turned, Variant::Reference)
            );
        }
    }

    #[test]
    fn planes_without_an_inside_stay() {
        for (width, height) in [(1, 1), (2, 5), (7, 1)] {
            let plane = Plane::from_fn(width, height, |x, y| (x * 3 + y) as f64);
            for variant in [Variant::Fast, Variant::Reference] {
                assert_eq!(filled(&plane, variant), plane);
            }
        }
    }
}
