//! Defocus in f64 with a disc per pixel.

use imaging::{Plane, Rgb};

use super::{POINTS, mirrored};

/// A quadrant of a disc's weights, row-major: `weights[dy][dx]`. The complete disc sums to 1.
struct DefocusDisc {
    weights: Vec<Vec<f64>>,
}

impl DefocusDisc {
    fn new(radius: f64) -> Self {
        let reach = (radius + 0.5).floor().max(0.0) as usize;
        let square = radius * radius;
        let mut weights: Vec<Vec<f64>> = (0..=reach)
            .map(|dy| (0..=reach).map(|dx| count_points(dx, dy, square)).collect())
            .collect();
        let copies = [1.0, 2.0];
        let rows = weights.iter().enumerate();
        let sum: f64 = rows
            .flat_map(|(dy, row)| {
                row.iter()
                    .enumerate()
                    .map(move |(dx, w)| w * copies[dx.min(1)] * copies[dy.min(1)])
            })
            .sum();
        if sum == 0.0 {
            // Smaller than the distance of two points: the pixel itself.
            return Self {
                weights: vec![vec![1.0]],
            };
        }
        for row in &mut weights {
            row.iter_mut().for_each(|weight| *weight /= sum);
            let used = row
                .iter()
                .rposition(|&weight| weight > 0.0)
                .map_or(0, |last| last + 1);
            row.truncate(used);
        }
        weights.retain(|row| !row.is_empty());
        Self { weights }
    }
}

/// Blurs every pixel by its disc, in f64.
#[must_use]
pub fn blur_reference(picture: &Rgb<f64>, radii: &Plane<f64>) -> Rgb<f64> {
    let (width, height) = picture.size();
    let mut known: Option<(f64, DefocusDisc)> = None;
    Rgb::from_fn(width, height, |x, y| {
        let radius = radii.pixel(x, y);
        let disc = match known.take() {
            Some((of, disc)) if of == radius => disc,
            _ => DefocusDisc::new(radius),
        };
        let pixel = picture.planes().each_ref().map(|plane| {
            let mut sum = 0.0;
            for (dy, row) in disc.weights.iter().enumerate() {
                for (dx, weight) in row.iter().enumerate() {
                    for (sy, sx) in signs(dx, dy) {
                        let x = mirrored(x as isize + sx * dx as isize, width);
                        let y = mirrored(y as isize + sy * dy as isize, height);
                        sum += weight * plane.pixel(x, y);
                    }
                }
            }
            sum
        });
        known = Some((radius, disc));
        pixel
    })
}

/// The signs of a first-quadrant offset in all quadrants.
fn signs(dx: usize, dy: usize) -> impl Iterator<Item = (isize, isize)> {
    let [columns, rows] = [dx, dy].map(|d| if d == 0 { &[1][..] } else { &[1, -1][..] });
    rows.iter()
        .flat_map(move |&sy| columns.iter().map(move |&sx| (sy, sx)))
}

/// Points of a pixel inside the squared radius.
fn count_points(dx: usize, dy: usize, square: f64) -> f64 {
    let [xs, ys] =
        [dx, dy].map(|pixel| (0..POINTS).map(move |k| pixel as f64 + (k as f64 + 0.5) / POINTS as f64 - 0.5));
    let inside = ys.map(|y| xs.clone().filter(|x| x * x + y * y <= square).count());
    inside.sum::<usize>() as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_disc_is_round_and_sums_to_one() {
        for radius in [0.0, 0.05, 0.25, 0.5, 1.0, 1.7, 4.2, 11.0] {
            let disc = DefocusDisc::new(radius);
            let times = |k: usize| if k == 0 { 1.0 } else { 2.0 };
            let rows = disc.weights.iter().enumerate();
            let sum: f64 = rows
                .flat_map(|(dy, row)| {
                    row.iter()
                        .enumerate()
                        .map(move |(dx, w)| w * times(dx) * times(dy))
                })
                .sum();
            assert!((sum - 1.0).abs() < 1e-12, "{radius}: {sum}");
            for (dy, row) in disc.weights.iter().enumerate() {
                for (dx, weight) in row.iter().enumerate() {
                    let mirrored = disc.weights.get(dx).and_then(|row| row.get(dy));
                    assert_eq!(mirrored, Some(weight), "{radius} at ({dx}, {dy})");
                }
            }
        }
    }
}
