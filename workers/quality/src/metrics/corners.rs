//! Corner repeatability: the share of the clean picture's corners present at the same position (Schmid, Mohr and
//! Bauckhage 2000, "Evaluation of interest point detectors"), as a feature tracker requires.
//!
//! Corners are the local maxima (3 × 3) of Harris and Stephens' response (1988), `det M - 0.04 (trace M)²` above 0,
//! with M the products of Sobel derivatives of the gray codes summed over 5 × 5 pixels; the n strongest count, one per
//! 1024 pixels, at least 16 and at most 512. Both pictures use the same n: strength is relative, and a merely paler
//! picture loses nothing. A corner is repeated if the other picture has one at most one pixel away in each direction;
//! by chance that happens to one in a hundred.
//!
//! `repeatability = repeated / corners of the clean picture`, 0..=1; 1 if the clean picture has none. Corners closer
//! than 4 pixels to the border are ignored, since their windows would cross it.

use imaging::simd::larger;
use imaging::{Plane, vectorized};

use crate::sobel::{Border, Sobel};
use crate::work::{Gray, MetricInput};

/// Pixels per corner, and the bounds of their number.
const PIXELS_PER_CORNER: usize = 1024;
const CORNERS: (usize, usize) = (16, 512);
/// Weight of the squared trace.
const HARRIS_K: f64 = 0.04;
/// Radius of the sums, and largest distance of a repeated corner.
const SUM_PX: usize = 2;
const NEAR_PX: usize = 1;
/// Corners closer to the border are ignored: sums, derivatives and comparison stay inside.
const MARGIN_PX: usize = SUM_PX + 2;

/// Share of the clean picture's corners present at the same position.
pub(crate) fn repeatability(work: &MetricInput) -> f64 {
    let clean = corners(&work.clean().to_gray8());
    if clean.is_empty() {
        return 1.0;
    }
    let gray = &work.part::<Gray>().0;
    let (width, height) = gray.size();
    let mut near = Plane::filled(width, height, false);
    for (x, y) in corners(gray) {
        for j in y - NEAR_PX..=y + NEAR_PX {
            near.row_mut(j)[x - NEAR_PX..=x + NEAR_PX].fill(true);
        }
    }
    let found = clean.iter().filter(|&&(x, y)| near.pixel(x, y)).count();
    found as f64 / clean.len() as f64
}

/// The strongest corners (x, y) of a plane; ties go to the first.
fn corners(gray: &Plane<u8>) -> Vec<(usize, usize)> {
    let (width, height) = gray.size();
    if width.min(height) <= 2 * MARGIN_PX {
        return Vec::new();
    }
    let mut response = Plane::filled(width, height, 0.0f64);
    vectorized!(harris(gray, &mut response));
    let mut found = Vec::new();
    let mut highest = vec![false; width];
    for y in MARGIN_PX..height - MARGIN_PX {
        let rows = [y - 1, y, y + 1].map(|row| response.row(row));
        vectorized!(mark_highest(rows, &mut highest));
        for x in MARGIN_PX..width - MARGIN_PX {
            if highest[x] && is_peak(rows, x) {
                found.push((rows[1][x], y * width + x));
            }
        }
    }
    let wanted = (width * height / PIXELS_PER_CORNER).clamp(CORNERS.0, CORNERS.1);
    if found.len() > wanted {
        found.select_nth_unstable_by(wanted, |a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        found.truncate(wanted);
    }
    found
        .into_iter()
        .map(|(_, position)| (position % width, position / width))
        .collect()
}

/// Marks positive values not below any neighbor.
#[inline(always)]
fn mark_highest([above, here, below]: [&[f64]; 3], highest: &mut [bool]) {
    let inner = here.len() - 2;
    let [above, here, below] = [&above[..inner + 2], &here[..inner + 2], &below[..inner + 2]];
    for (x, highest) in highest[1..=inner].iter_mut().enumerate() {
        let most = larger(
            larger(largest_of_three(above, x), largest_of_three(below, x)),
            largest_of_three(here, x),
        );
        *highest = (here[x + 1] > 0.0) & (here[x + 1] >= most);
    }
}

/// Not below any neighbor, and above the preceding ones: a plateau has one peak.
fn is_peak(rows: [&[f64]; 3], x: usize) -> bool {
    let own = rows[1][x];
    let [above, here, below] = rows.map(|row| &row[x - 1..=x + 1]);
    above.iter().all(|&other| other < own)
        && here[0] < own
        && here[2] <= own
        && below.iter().all(|&other| other <= own)
}

/// Harris' response of every pixel with a complete window. All sums and the determinant are integers below 2^53.
#[inline(always)]
fn harris(gray: &Plane<u8>, response: &mut Plane<f64>) {
    let (width, height) = gray.size();
    let window = 2 * SUM_PX + 1;
    let mut sobel = Sobel::new(gray, Border::Replicate);
    let (mut gx, mut gy) = (vec![0i16; width], vec![0i16; width]);
    // Column sums of the products in the window, and a ring of their rows.
    let mut sums = [0; 3].map(|_| vec![0i32; width]);
    let mut ring = vec![[0; 3].map(|_| vec![0i32; width]); window];
    for y in 0..height {
        sobel.row(y, &mut gx, &mut gy);
        let [xx, xy, yy] = &mut ring[y % window];
        exchange(&mut sums[0], xx, &gx, &gx);
        exchange(&mut sums[1], xy, &gx, &gy);
        exchange(&mut sums[2], yy, &gy, &gy);
        if y + 1 >= window {
            respond(&sums, response.row_mut(y - SUM_PX));
        }
    }
}

/// Replaces the oldest row in the sums by the products of a new one.
#[inline(always)]
fn exchange(sums: &mut [i32], row: &mut [i32], a: &[i16], b: &[i16]) {
    for ((sum, old), (&a, &b)) in sums.iter_mut().zip(row).zip(a.iter().zip(b)) {
        let new = i32::from(a) * i32::from(b);
        *sum += new - *old;
        *old = new;
    }
}

#[inline(always)]
fn respond(sums: &[Vec<i32>; 3], response: &mut [f64]) {
    const WINDOW: usize = 2 * SUM_PX + 1;
    let inner = response.len() - 2 * SUM_PX;
    let [xx, xy, yy] = sums.each_ref().map(|sums| &sums[..inner + 2 * SUM_PX]);
    for (x, response) in response[SUM_PX..SUM_PX + inner].iter_mut().enumerate() {
        let [xx, xy, yy] = [xx, xy, yy].map(|sums| f64::from((0..WINDOW).map(|i| sums[x + i]).sum::<i32>()));
        *response = xx * yy - xy * xy - HARRIS_K * (xx + yy) * (xx + yy);
    }
}

#[inline(always)]
fn largest_of_three(row: &[f64], x: usize) -> f64 {
    larger(larger(row[x], row[x + 1]), row[x + 2])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn squares() -> Plane<u8> {
        Plane::from_fn(64, 48, |x, y| {
            if (10..30).contains(&x) && (12..32).contains(&y) {
                200
            } else {
                50
            }
        })
    }

    #[test]
    fn a_square_has_four_corners_where_they_are() {
        let found = corners(&squares());
        assert_eq!(found.len(), 4, "{found:?}");
        for (x, y) in [(10usize, 12usize), (29, 12), (10, 31), (29, 31)] {
            assert!(
                found
                    .iter()
                    .any(|&(a, b)| x.abs_diff(a) <= 2 && y.abs_diff(b) <= 2),
                "{x} {y} {found:?}"
            );
        }
    }

    #[test]
    fn edges_ramps_and_small_planes_have_none() {
        assert!(corners(&Plane::from_fn(64, 48, |x, _| if x < 30 { 0 } else { 255 })).is_empty());
        assert!(corners(&Plane::from_fn(64, 48, |x, y| (x + 2 * y) as u8)).is_empty());
        assert!(corners(&Plane::from_fn(8, 100, |x, y| (x * y) as u8)).is_empty());
    }

    #[test]
    fn a_paler_picture_has_the_same_corners() {
        let paler = squares().map(|&code| 90 + code / 5);
        assert_eq!(corners(&paler), corners(&squares()));
    }

    #[test]
    fn no_more_than_the_strongest_are_taken() {
        let noise = Plane::from_fn(128, 128, |x, y| {
            let hash = (x as u32).wrapping_mul(0x9e37_79b1) ^ (y as u32).wrapping_mul(0x85eb_ca77);
            (hash.wrapping_mul(0x2c1b_3c6d) >> 24) as u8
        });
        assert_eq!(corners(&noise).len(), 16);
    }
}
