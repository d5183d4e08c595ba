//! Filling the holes of a plane.

use std::cmp::{Ordering, Reverse};
use std::collections::BinaryHeap;

use imaging::{Plane, cancel};

use crate::variant::Variant;

/// The plane with its holes filled: the largest `u` that equals `z` on the border and is `max(z, least u of the 3 × 3
/// neighborhood)` inside, so that basins which no path of neighbors leads out of rise to their rim (Soille 1999, morphological
/// reconstruction by erosion).
#[must_use]
pub fn filled(plane: &Plane<f64>, variant: Variant) -> Plane<f64> {
    match variant {
        Variant::Fast => flooded(plane),
        Variant::Reference => lowered(plane),
    }
}

/// A pixel that the water has reached, ordered by its level.
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

/// The pixels of a 3 × 3 neighborhood inside of the plane.
fn around((x, y): (usize, usize), (width, height): (usize, usize)) -> impl Iterator<Item = (usize, usize)> {
    let rows = y.saturating_sub(1)..(y + 2).min(height);
    rows.flat_map(move |y| (x.saturating_sub(1)..(x + 2).min(width)).map(move |x| (x, y)))
}

/// Water rises from the border inwards, always over the lowest rim first (Barnes, Lehman and Mulla 2014, "Priority-flood").
fn flooded(plane: &Plane<f64>) -> Plane<f64> {
    let size = plane.size();
    let mut filled = plane.clone();
    let mut known = vec![false; plane.data().len()];
    let mut front = BinaryHeap::new();
    for position in 0..known.len() {
        if is_border((position % size.0, position / size.0), size) {
            known[position] = true;
            let level = plane.data()[position];
            front.push(Reverse(Reached { level, position }));
        }
    }
    while let Some(Reverse(Reached { level, position })) = front.pop() {
        if position % size.0 == 0 {
            cancel::check();
        }
        for (x, y) in around((position % size.0, position / size.0), size) {
            let position = y * size.0 + x;
            if std::mem::replace(&mut known[position], true) {
                continue;
            }
            let level = level.max(plane.data()[position]);
            filled.data_mut()[position] = level;
            front.push(Reverse(Reached { level, position }));
        }
    }
    filled
}

/// From the highest level everywhere inside down to the fixed point.
fn lowered(plane: &Plane<f64>) -> Plane<f64> {
    let size = plane.size();
    let highest = plane.data().iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let mut filled = Plane::from_fn(size.0, size.1, |x, y| match is_border((x, y), size) {
        true => plane.pixel(x, y),
        false => highest,
    });
    loop {
        let next = Plane::from_fn(size.0, size.1, |x, y| {
            let least = around((x, y), size)
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
    fn planes_without_an_inside_stay() {
        for (width, height) in [(1, 1), (2, 5), (7, 1)] {
            let plane = Plane::from_fn(width, height, |x, y| (x * 3 + y) as f64);
            for variant in [Variant::Fast, Variant::Reference] {
                assert_eq!(filled(&plane, variant), plane);
            }
        }
    }
}
