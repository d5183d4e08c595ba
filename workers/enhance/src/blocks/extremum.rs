//! Maximum and minimum in a square window clipped to the picture.

use imaging::simd::{larger, smaller};
use imaging::{Plane, vectorized};

use crate::blocks::sums::inside;
use crate::variant::Variant;

/// The largest sample within `radius` columns and rows of each sample.
#[must_use]
pub fn window_max<T: Copy + PartialOrd>(plane: &Plane<T>, radius: usize, variant: Variant) -> Plane<T> {
    extremes(plane, radius, variant, larger)
}

/// The smallest sample within `radius` columns and rows of each sample.
#[must_use]
pub fn window_min<T: Copy + PartialOrd>(plane: &Plane<T>, radius: usize, variant: Variant) -> Plane<T> {
    extremes(plane, radius, variant, smaller)
}

#[inline(always)]
fn extremes<T: Copy + PartialOrd>(
    plane: &Plane<T>,
    radius: usize,
    variant: Variant,
    pick: impl Fn(T, T) -> T + Copy,
) -> Plane<T> {
    if plane.data().is_empty() || radius == 0 {
        return plane.clone();
    }
    match variant {
        Variant::Fast => vectorized!(doubled(plane, radius, pick)),
        Variant::Reference => reference(plane, radius, pick),
    }
}

fn reference<T: Copy>(plane: &Plane<T>, radius: usize, pick: impl Fn(T, T) -> T) -> Plane<T> {
    let (width, height) = plane.size();
    Plane::from_fn(width, height, |x, y| {
        let (rows, columns) = (inside(y, radius, height), inside(x, radius, width));
        let window = rows.flat_map(|j| columns.clone().map(move |i| plane.pixel(i, j)));
        window.fold(plane.pixel(x, y), &pick)
    })
}

/// Maxima of runs of two, four, eight… samples, and finally of two runs that cover the window. Up to a radius of 31
/// that is a few vector steps per sample, faster than scalar methods with a constant count. Replicating the border
/// equals clipping the window, since the edge sample is inside the window anyway.
#[inline(always)]
fn doubled<T: Copy>(plane: &Plane<T>, radius: usize, pick: impl Fn(T, T) -> T + Copy) -> Plane<T> {
    let (width, height) = plane.size();
    let window = 2 * radius + 1;
    // The longest power-of-two run inside the window.
    let longest = 1 << window.ilog2();

    // Along the rows; row `y` of `runs` starts `radius` above row `y` of the result.
    let mut line = Vec::with_capacity(width + 2 * radius);
    let mut longer = line.clone();
    let mut runs: Vec<Vec<T>> = Vec::with_capacity(height + 2 * radius);
    for y in 0..height {
        let row = plane.row(y);
        line.clear();
        line.resize(radius, row[0]);
        line.extend_from_slice(row);
        line.resize(width + 2 * radius, row[width - 1]);
        let mut run = 1;
        while run < longest {
            let count = line.len() - run;
            longer.clone_from(&line);
            line.truncate(count);
            for (to, &next) in line.iter_mut().zip(&longer[run..]) {
                *to = pick(*to, next);
            }
            run *= 2;
        }
        let ends = line.iter().zip(&line[window - longest..]);
        let along: Vec<T> = ends.take(width).map(|(&a, &b)| pick(a, b)).collect();
        let repeats = 1 + if y == 0 { radius } else { 0 } + if y == height - 1 { radius } else { 0 };
        runs.extend(std::iter::repeat_n(along, repeats));
    }

    // Down the columns, a whole row at a time.
    let mut run = 1;
    while run < longest {
        for y in 0..runs.len() - run {
            let (upper, lower) = runs.split_at_mut(y + run);
            for (a, &b) in upper[y].iter_mut().zip(&lower[0]) {
                *a = pick(*a, b);
            }
        }
        run *= 2;
    }
    let mut result = plane.clone();
    for y in 0..height {
        let ends = runs[y].iter().zip(&runs[y + window - longest]);
        for (to, (&a, &b)) in result.row_mut(y).iter_mut().zip(ends) {
            *to = pick(a, b);
        }
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_window_ends_at_the_border() {
        let plane = Plane::new(5, 1, vec![3u8, 9, 1, 2, 4]).unwrap();
        for variant in [Variant::Fast, Variant::Reference] {
            assert_eq!(window_max(&plane, 1, variant).data(), &[9, 9, 9, 4, 4]);
            assert_eq!(window_min(&plane, 1, variant).data(), &[3, 1, 1, 1, 2]);
            assert_eq!(window_max(&plane, 40, variant).data(), &[9; 5]);
        }
    }
}
