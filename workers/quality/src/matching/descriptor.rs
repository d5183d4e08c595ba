//! Steered BRIEF descriptors (Calonder et al. 2010; Rublee et al. 2011): 256 comparisons of smoothed codes within a disc
//! of radius 15, rotated by the orientation of the feature.
//!
//! The pairs are drawn once from a fixed address of the random stream, each coordinate as the sum of four uniform values
//! with standard deviation 6.2 px (a fifth of the patch, as in the article). The smoothing is Gaussian, σ = 2 px, over
//! 7 × 7 pixels.

use std::sync::LazyLock;

use imaging::random::Stream;
use imaging::{Plane, vectorized};

use super::orientation::{Direction, RADIUS};

/// The 256 bits, the first comparison in the lowest bit of the first word.
pub(crate) type Descriptor = [u64; 4];

const PAIRS: usize = 256;
/// Standard deviation of a coordinate, px.
const SPREAD_PX: f64 = 6.2;
/// Weights in 1/256 by the distance from the center.
const WEIGHTS: [u16; 4] = [56, 49, 33, 18];
/// Radius of the smoothing.
const SMOOTH_PX: usize = 3;

/// Coordinates of the compared points, by pair.
struct Pattern {
    first_x: [f32; PAIRS],
    first_y: [f32; PAIRS],
    second_x: [f32; PAIRS],
    second_y: [f32; PAIRS],
}

static PATTERN: LazyLock<Pattern> = LazyLock::new(draw_pattern);

fn draw_pattern() -> Pattern {
    let stream = Stream::stage(0, "brief-pattern");
    let mut pattern = Pattern {
        first_x: [0.0; PAIRS],
        first_y: [0.0; PAIRS],
        second_x: [0.0; PAIRS],
        second_y: [0.0; PAIRS],
    };
    // The points are drawn in order; those outside the disc are skipped.
    let mut points = (0..).map(|point| draw_point(&stream, point)).filter(|(x, y)| {
        let most = RADIUS as f32;
        x * x + y * y <= most * most
    });
    for i in 0..PAIRS {
        (pattern.first_x[i], pattern.first_y[i]) = points.next().unwrap_or_default();
        (pattern.second_x[i], pattern.second_y[i]) = points.next().unwrap_or_default();
    }
    pattern
}

fn draw_point(stream: &Stream, point: u64) -> (f32, f32) {
    // The sum of four uniform values has the variance 4/12.
    let scale = SPREAD_PX * 3f64.sqrt();
    let coordinate = |axis: u64| {
        let sum: f64 = (0..4).map(|k| stream.unit(point, 4 * axis + k)).sum();
        ((sum - 2.0) * scale) as f32
    };
    (coordinate(0), coordinate(1))
}

/// Smooths all pixels at least three pixels from the border and leaves the others.
pub(crate) fn smooth(gray: &Plane<u8>) -> Plane<u8> {
    let (width, height) = gray.size();
    let mut smoothed = gray.clone();
    let mut column_sums = vec![0u16; width];
    for y in SMOOTH_PX..height.saturating_sub(SMOOTH_PX) {
        let rows = std::array::from_fn(|i| gray.row(y + i - SMOOTH_PX));
        vectorized!(smooth_row(rows, &mut column_sums, smoothed.row_mut(y)));
    }
    smoothed
}

#[inline(always)]
fn smooth_row(rows: [&[u8]; 7], column_sums: &mut [u16], smoothed: &mut [u8]) {
    let width = smoothed.len();
    let rows = rows.map(|row| &row[..width]);
    let column_sums = &mut column_sums[..width];
    for x in 0..width {
        // At most 255 · 256: 16 bits hold it.
        let mut sum = WEIGHTS[0] * u16::from(rows[3][x]);
        for (distance, &weight) in WEIGHTS.iter().enumerate().skip(1) {
            sum += weight * (u16::from(rows[3 - distance][x]) + u16::from(rows[3 + distance][x]));
        }
        column_sums[x] = sum;
    }
    let inner = width.saturating_sub(2 * SMOOTH_PX);
    let sums: [&[u16]; 7] = std::array::from_fn(|i| &column_sums[i.min(width - inner)..][..inner]);
    for (x, smoothed) in smoothed[SMOOTH_PX.min(width)..][..inner].iter_mut().enumerate() {
        let mut sum = u32::from(WEIGHTS[0]) * u32::from(sums[3][x]);
        for (distance, &weight) in WEIGHTS.iter().enumerate().skip(1) {
            sum += u32::from(weight) * (u32::from(sums[3 - distance][x]) + u32::from(sums[3 + distance][x]));
        }
        *smoothed = ((sum + (1 << 15)) >> 16) as u8;
    }
}

/// The descriptor of a feature at (x, y), at least 18 pixels from the border, from smoothed codes.
#[inline(always)]
pub(crate) fn describe(smoothed: &Plane<u8>, x: usize, y: usize, direction: Direction) -> Descriptor {
    let pattern: &Pattern = &PATTERN;
    let corner = (y - RADIUS) * smoothed.width() + x - RADIUS;
    let codes = &smoothed.data()[corner..];
    let first = offsets(&pattern.first_x, &pattern.first_y, direction, smoothed.width());
    let second = offsets(&pattern.second_x, &pattern.second_y, direction, smoothed.width());
    let mut descriptor = [0; 4];
    for (word, (first, second)) in descriptor
        .iter_mut()
        .zip(first.chunks_exact(64).zip(second.chunks_exact(64)))
    {
        for (bit, (&first, &second)) in first.iter().zip(second).enumerate() {
            *word |= u64::from(codes[first as usize] < codes[second as usize]) << bit;
        }
    }
    descriptor
}

/// Positions of the rotated points after the top left corner of the patch, row-major.
#[inline(always)]
fn offsets(x: &[f32; PAIRS], y: &[f32; PAIRS], direction: Direction, width: usize) -> [u32; PAIRS] {
    let mut offsets = [0; PAIRS];
    for i in 0..PAIRS {
        let across = direction.x * x[i] - direction.y * y[i];
        let down = direction.y * x[i] + direction.x * y[i];
        // Rounds to nearest: the sum is not negative.
        let [column, row] = [across, down].map(|offset| (offset + (RADIUS as f32 + 0.5)) as i32 as u32);
        offsets[i] = row * width as u32 + column;
    }
    offsets
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(x: usize, y: usize) -> u8 {
        let hash = (x as u32).wrapping_mul(0x9e37_79b1) ^ (y as u32).wrapping_mul(0x85eb_ca77);
        ((hash ^ (hash >> 15)).wrapping_mul(0x2c1b_3c6d) >> 24) as u8
    }

    fn distance(a: Descriptor, b: Descriptor) -> u32 {
        a.iter().zip(b).map(|(a, b)| (a ^ b).count_ones()).sum()
    }

    /// Half a code of rounding after each pass, and weights rounded to 1/256.
    const TOLERANCE: f64 = 1.5;

    #[test]
    fn smoothing_agrees_with_the_gaussian() {
        let gray = Plane::from_fn(40, 31, noise);
        let smoothed = smooth(&gray);
        let weights: [f64; 7] = std::array::from_fn(|i| (-0.5 * ((i as f64 - 3.0) / 2.0).powi(2)).exp());
        let total: f64 = weights.iter().sum();
        for y in 3..28 {
            for x in 3..37 {
                let mut sum = 0.0;
                for (j, down) in weights.iter().enumerate() {
                    for (i, across) in weights.iter().enumerate() {
                        sum += down * across * f64::from(gray.pixel(x + i - 3, y + j - 3));
                    }
                }
                let difference = f64::from(smoothed.pixel(x, y)) - sum / (total * total);
                assert!(difference.abs() <= TOLERANCE, "{x} {y}: {difference}");
            }
        }
        assert_eq!(smooth(&Plane::filled(3, 2, 7u8)), Plane::filled(3, 2, 7u8));
    }

    #[test]
    fn points_are_spread_as_stated() {
        let pattern = draw_pattern();
        let squares = [
            &pattern.first_x,
            &pattern.first_y,
            &pattern.second_x,
            &pattern.second_y,
        ]
        .map(|axis| axis.iter().map(|x| x * x).sum::<f32>() / PAIRS as f32);
        // Points beyond the disc are missing, so the spread is slightly smaller.
        assert!(
            squares.iter().all(|square| (4.8..6.5).contains(&square.sqrt())),
            "{squares:?}"
        );
    }

    #[test]
    fn a_descriptor_ignores_gain_offset_and_rotation_and_differs_elsewhere() {
        let gray = Plane::from_fn(61, 61, |x, y| noise(x / 4, y / 4) / 2);
        // A quarter turn about the center: (x, y) shows (y, 60 - x).
        let turned = Plane::from_fn(61, 61, |x, y| gray.pixel(y, 60 - x));
        let brighter = gray.map(|code| 2 * code + 1);
        let right = Direction { x: 1.0, y: 0.0 };
        let describe_center = |plane: &Plane<u8>, direction| describe(&smooth(plane), 30, 30, direction);
        let own = describe_center(&gray, right);
        // Codes that differ by less than one are equal in the darker picture.
        assert!(distance(own, describe_center(&brighter, right)) < 8);
        assert!(distance(own, describe_center(&turned, Direction { x: 0.0, y: 1.0 })) < 8);
        assert!(distance(own, describe_center(&turned, right)) > 64);
        assert!(distance(own, describe(&smooth(&gray), 24, 35, right)) > 64);
    }
}
