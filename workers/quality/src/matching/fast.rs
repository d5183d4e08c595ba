//! FAST corners (Rosten and Drummond 2006): a pixel is a corner at threshold t if 9 contiguous pixels of the 16 on a
//! circle of radius 3 are all brighter, or all darker, by more than t codes.
//!
//! The score of a pixel is the smallest difference of the best arc, so it is a corner at every threshold below its
//! score. Only the score's local maxima in 3 × 3 pixels count; of equal neighbors the first.

use imaging::simd::{larger, smaller};
use imaging::{Plane, cancel, vectorized};

/// Offsets (right, down) around the circle.
const CIRCLE: [(isize, isize); 16] = [
    (0, -3),
    (1, -3),
    (2, -2),
    (3, -1),
    (3, 0),
    (3, 1),
    (2, 2),
    (1, 3),
    (0, 3),
    (-1, 3),
    (-2, 2),
    (-3, 1),
    (-3, 0),
    (-3, -1),
    (-2, -2),
    (-1, -3),
];
const RADIUS_PX: usize = 3;

/// A local maximum of the score.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Corner {
    pub(crate) x: u32,
    pub(crate) y: u32,
    /// Above 0.
    pub(crate) score: u8,
}

/// Corners of a plane at threshold 0, row by row, at least `margin` pixels from each border.
///
/// # Panics
/// If the margin is below 4: a corner's neighbors need complete circles.
pub(crate) fn find_corners(gray: &Plane<u8>, margin: usize) -> Vec<Corner> {
    assert!(margin > RADIUS_PX, "circles of neighbors stay inside the plane");
    let (width, height) = gray.size();
    let mut corners = Vec::new();
    if width <= 2 * margin || height <= 2 * margin {
        return corners;
    }
    // A ring of three rows of scores.
    let mut scores = [0; 3].map(|_| vec![0u8; width]);
    let mut peaks = vec![0u8; width];
    for y in margin - 1..=height - margin {
        cancel::check();
        let rows = std::array::from_fn(|i| gray.row(y + i - RADIUS_PX));
        vectorized!(score_row(rows, &mut scores[y % 3]));
        if y <= margin {
            continue;
        }
        let rows = [y + 1, y + 2, y].map(|row| scores[row % 3].as_slice());
        vectorized!(keep_peaks(rows, &mut peaks));
        let inner = peaks[margin..width - margin].iter().enumerate();
        corners.extend(inner.filter(|(_, score)| **score > 0).map(|(x, &score)| Corner {
            x: (x + margin) as u32,
            y: (y - 1) as u32,
            score,
        }));
    }
    corners
}

/// Scores of the pixels of the middle of seven rows that have a complete circle.
#[inline(always)]
fn score_row(rows: [&[u8]; 7], scores: &mut [u8]) {
    let end = scores.len() - RADIUS_PX;
    let mut x = RADIUS_PX;
    while x < end {
        // The last block starts early enough to be complete, unless the row is shorter than a block.
        let start = x.min(end.saturating_sub(LANES).max(RADIUS_PX));
        let count = LANES.min(end - start);
        let mut circle = [[0; LANES]; 16];
        for (samples, (right, down)) in circle.iter_mut().zip(CIRCLE) {
            let row = rows[(RADIUS_PX as isize + down) as usize];
            load(samples, &row[(start as isize + right) as usize..][..count]);
        }
        let mut centers = [0; LANES];
        load(&mut centers, &rows[RADIUS_PX][start..][..count]);
        let block = score_block(&circle, &centers);
        scores[start..start + count].copy_from_slice(&block[..count]);
        x += LANES;
    }
}

/// Pixels scored together.
const LANES: usize = 64;
type Lanes = [u8; LANES];

#[inline(always)]
fn load(lanes: &mut Lanes, codes: &[u8]) {
    if codes.len() == LANES {
        lanes.copy_from_slice(codes);
    } else {
        lanes[..codes.len()].copy_from_slice(codes);
    }
}

/// The smallest difference of the best arc: that of the largest minimum of an arc above the center, or of the smallest
/// maximum below it.
#[inline(always)]
fn score_block(circle: &[Lanes; 16], centers: &Lanes) -> Lanes {
    let brightest = best_arcs(circle, min_lanes, max_lanes);
    let darkest = best_arcs(circle, max_lanes, min_lanes);
    let mut scores = [0; LANES];
    for i in 0..LANES {
        scores[i] = larger(
            brightest[i].saturating_sub(centers[i]),
            centers[i].saturating_sub(darkest[i]),
        );
    }
    scores
}

/// The best, over all arcs of nine on the circle, of the worst value of the arc. The arcs from 2 i and from 2 i + 1 share
/// the eight values from 2 i + 1.
#[inline(always)]
fn best_arcs(
    circle: &[Lanes; 16],
    worse: impl Fn(&Lanes, &Lanes) -> Lanes + Copy,
    better: impl Fn(&Lanes, &Lanes) -> Lanes,
) -> Lanes {
    let mut pairs = [[0; LANES]; 8];
    for i in 0..8 {
        pairs[i] = worse(&circle[2 * i + 1], &circle[(2 * i + 2) % 16]);
    }
    let mut fours = [[0; LANES]; 8];
    for i in 0..8 {
        fours[i] = worse(&pairs[i], &pairs[(i + 1) % 8]);
    }
    let mut best = [0; LANES];
    for i in 0..8 {
        let eight = worse(&fours[i], &fours[(i + 2) % 8]);
        let ends = better(&circle[2 * i], &circle[(2 * i + 9) % 16]);
        let arc = worse(&eight, &ends);
        best = if i == 0 { arc } else { better(&best, &arc) };
    }
    best
}

#[inline(always)]
fn min_lanes(a: &Lanes, b: &Lanes) -> Lanes {
    let mut lanes = [0; LANES];
    for i in 0..LANES {
        lanes[i] = smaller(a[i], b[i]);
    }
    lanes
}

#[inline(always)]
fn max_lanes(a: &Lanes, b: &Lanes) -> Lanes {
    let mut lanes = [0; LANES];
    for i in 0..LANES {
        lanes[i] = larger(a[i], b[i]);
    }
    lanes
}

/// Scores of the middle row above all preceding neighbors and not below the following ones, else 0.
#[inline(always)]
fn keep_peaks([above, here, below]: [&[u8]; 3], peaks: &mut [u8]) {
    let inner = peaks.len() - 2;
    let [above, here, below] = [&above[..inner + 2], &here[..inner + 2], &below[..inner + 2]];
    for (x, peak) in peaks[1..=inner].iter_mut().enumerate() {
        let before = larger(larger(above[x], above[x + 1]), larger(above[x + 2], here[x]));
        let after = larger(larger(below[x], below[x + 1]), larger(below[x + 2], here[x + 2]));
        let score = here[x + 1];
        *peak = if (score > before) & (score >= after) {
            score
        } else {
            0
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The definition: the largest threshold below which some arc of nine is brighter or darker.
    fn score_by_definition(gray: &Plane<u8>, x: usize, y: usize) -> u8 {
        let center = i32::from(gray.pixel(x, y));
        let differences = CIRCLE.map(|(right, down)| {
            i32::from(gray.pixel((x as isize + right) as usize, (y as isize + down) as usize)) - center
        });
        let is_corner = |threshold: i32| {
            (0..16).any(|first| {
                let arc = (first..first + 9).map(|k| differences[k % 16]);
                arc.clone().all(|d| d > threshold) || arc.clone().all(|d| d < -threshold)
            })
        };
        (0..=255).find(|&threshold| !is_corner(threshold)).unwrap_or(255) as u8
    }

    fn corners_by_definition(gray: &Plane<u8>, margin: usize) -> Vec<Corner> {
        let (width, height) = gray.size();
        let mut corners = Vec::new();
        for y in margin..height.saturating_sub(margin) {
            for x in margin..width.saturating_sub(margin) {
                let score = score_by_definition(gray, x, y);
                let neighbors = (0..9)
                    .filter(|&k| k != 4)
                    .map(|k| (k, x + k % 3 - 1, y + k / 3 - 1));
                let is_peak = neighbors.into_iter().all(|(k, x, y)| {
                    let other = score_by_definition(gray, x, y);
                    if k < 4 { other < score } else { other <= score }
                });
                if score > 0 && is_peak {
                    corners.push(Corner {
                        x: x as u32,
                        y: y as u32,
                        score,
                    });
                }
            }
        }
        corners
    }

    #[test]
    fn corners_agree_with_the_definition() {
        let noise = |x: usize, y: usize| {
            let hash = (x as u32).wrapping_mul(0x9e37_79b1) ^ (y as u32).wrapping_mul(0x85eb_ca77);
            ((hash ^ (hash >> 15)).wrapping_mul(0x2c1b_3c6d) >> 24) as u8
        };
        let planes = [
            Plane::from_fn(70, 51, noise),
            Plane::from_fn(64, 48, |x, y| noise(x / 7, y / 5)),
            Plane::from_fn(64, 48, |x, y| 100 + noise(x / 7, y / 5) % 3),
            Plane::from_fn(9, 9, |x, y| if (x, y) == (4, 4) { 255 } else { 0 }),
        ];
        for gray in planes {
            let expected = corners_by_definition(&gray, 4);
            assert!(!expected.is_empty());
            assert_eq!(find_corners(&gray, 4), expected);
        }
    }

    #[test]
    fn a_bright_dot_has_the_score_of_its_contrast_and_edges_have_none() {
        let dot = Plane::from_fn(20, 20, |x, y| if (x, y) == (9, 11) { 90 } else { 60 });
        assert_eq!(
            find_corners(&dot, 4),
            [Corner {
                x: 9,
                y: 11,
                score: 30
            }]
        );
        assert!(find_corners(&Plane::from_fn(30, 30, |x, _| if x < 15 { 0 } else { 200 }), 4).is_empty());
        assert!(find_corners(&Plane::filled(30, 30, 70u8), 4).is_empty());
    }

    #[test]
    fn planes_without_room_have_none() {
        for (width, height) in [(0, 0), (1, 1), (2, 2), (7, 3), (8, 100)] {
            assert!(find_corners(&Plane::from_fn(width, height, |x, y| (x * y * 91) as u8), 4).is_empty());
        }
    }
}
