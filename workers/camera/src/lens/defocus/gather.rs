//! Defocus in f32 with a disc per pixel, computed in blocks of a row.
//!
//! All pixels of a block read the same samples. A sample has one weight if the discs of the block agree, and a weight
//! per disc otherwise. The cost follows the largest radius and depends little on the variation of radii.

use imaging::{Plane, Rgb, vectorized};

use super::counts::{DiscCounts, ring};
use super::{SHARP_PX, mirrored};
use crate::rounding;

/// Pixels of a block. Shorter loops would be unrolled to scalars instead of vectorized.
const LANES: usize = 64;

/// Blurs every pixel by its radius in pixels.
///
/// The discs are those of [`super::blur_reference`]; the error is at most [`rounding_bound`].
///
/// # Panics
/// If picture and radii differ in size.
#[must_use]
pub fn blur(picture: &Rgb<f32>, radii: &Plane<f64>) -> Rgb<f32> {
    let (width, height) = picture.size();
    assert_eq!(radii.size(), (width, height), "a radius for each pixel");
    let largest = radii.data().iter().copied().fold(0.0, f64::max);
    let mut blurred = picture.clone();
    if largest < SHARP_PX {
        return blurred;
    }
    let counts = DiscCounts::up_to(largest);
    let planes = picture.planes().each_ref();
    let padded = planes.map(|plane| pad(plane, counts.reach()));
    let mut block = DiscBlock::new(&counts);
    for y in 0..height {
        let [r, g, b] = blurred
            .planes_mut()
            .map(|samples| &mut samples[y * width..][..width]);
        let radii = radii.row(y);
        vectorized!(blur_row(
            &counts,
            &mut block,
            &padded,
            y,
            radii,
            [&mut *r, &mut *g, &mut *b]
        ));
    }
    blurred
}

/// Largest error of [`blur`] for radii up to `radius_px` and samples up to `peak` in magnitude.
#[must_use]
pub fn rounding_bound(radius_px: f64, peak: f64) -> f64 {
    if radius_px < SHARP_PX {
        return 0.0;
    }
    // One rounding each for the sum of two rows, that of two columns, the weight, the number of points and the division
    // by it; one for each column and each row but the first.
    let reach = (radius_px + 0.5).floor();
    rounding::absolute(5.0 + 2.0 * reach, peak)
}

/// The plane with mirrored borders of this width; the right one is widened to whole blocks.
fn pad(plane: &Plane<f32>, margin: usize) -> Plane<f32> {
    let (width, height) = plane.size();
    let padded = width.next_multiple_of(LANES) + 2 * margin;
    let columns: Vec<usize> = (0..padded).map(|x| source_of(x, margin, width)).collect();
    let (left, right) = (&columns[..margin], &columns[margin + width..]);
    let mut data = Vec::with_capacity(padded * (height + 2 * margin));
    for y in 0..height + 2 * margin {
        let row = plane.row(source_of(y, margin, height));
        data.extend(left.iter().map(|&x| row[x]));
        data.extend_from_slice(row);
        data.extend(right.iter().map(|&x| row[x]));
    }
    Plane::new(padded, height + 2 * margin, data).expect("a margin on all sides")
}

fn source_of(padded: usize, margin: usize, side: usize) -> usize {
    mirrored(padded as isize - margin as isize, side)
}

/// The discs of a block of pixels. Weights are numbers of points.
struct DiscBlock {
    /// The smallest and the largest disc.
    ends: Option<(i32, i32)>,
    rows: Vec<DiscRow>,
    /// Weights common to all discs, row after row.
    common: Vec<f32>,
    /// The weight in each disc, by [`DiscCounts::pixel`].
    lanes: Vec<[f32; LANES]>,
    /// One over the sum of weights of each disc.
    norms: [f32; LANES],
    /// The sum of the rows above and below.
    pair: Vec<f32>,
}

/// A row of the discs from the middle outwards; left and right are equal.
#[derive(Clone, Copy)]
struct DiscRow {
    /// Number of pixels from the middle with equal weights in all discs.
    common: usize,
    /// Half width of the largest disc.
    pixels: usize,
}

impl DiscBlock {
    fn new(counts: &DiscCounts) -> Self {
        Self {
            ends: None,
            rows: Vec::new(),
            common: Vec::new(),
            lanes: vec![[0.0; LANES]; counts.pixels()],
            norms: [0.0; LANES],
            pair: vec![0.0; LANES + 2 * counts.reach()],
        }
    }

    #[inline(always)]
    fn set(&mut self, counts: &DiscCounts, rings: &[i32; LANES]) {
        let least = rings.iter().copied().fold(i32::MAX, i32::min);
        let largest = rings.iter().copied().fold(0, i32::max);
        let ends = Some((least, largest));
        if self.ends == ends && least == largest {
            return;
        }
        self.ends = ends;
        for (norm, &ring) in self.norms.iter_mut().zip(rings) {
            *norm = counts.norm(ring);
        }
        self.rows.clear();
        self.common.clear();
        for dy in 0..=counts.reach() {
            let mut row = DiscRow { common: 0, pixels: 0 };
            for dx in 0..=counts.reach() {
                let pixel = DiscCounts::pixel(dx, dy);
                let count = counts.count(pixel, largest);
                if count == 0 {
                    break;
                }
                if row.common == row.pixels && counts.count(pixel, least) == count {
                    self.common.push(f32::from(count));
                    row.common += 1;
                }
                if least != largest && dx >= dy {
                    counts.fill(pixel, rings, &mut self.lanes[pixel]);
                }
                row.pixels += 1;
            }
            if row.pixels == 0 {
                break;
            }
            self.rows.push(row);
        }
    }

    /// The blurred block whose first pixel is at (x, y) of the plane without its margin.
    #[inline(always)]
    fn gather(&mut self, padded: &Plane<f32>, margin: usize, x: usize, y: usize) -> [f32; LANES] {
        let mut sums = [0.0; LANES];
        let mut weights = self.common.as_slice();
        for (dy, row) in self.rows.iter().enumerate() {
            let reach = row.pixels - 1;
            let columns = x + margin - reach..x + margin + reach + LANES;
            let above = &padded.row(y + margin - dy)[columns.clone()];
            let below = &padded.row(y + margin + dy)[columns];
            let pair = &mut self.pair[..above.len()];
            join(pair, above, below, dy == 0);
            let (common, others) = weights.split_at(row.common);
            weights = others;
            // Summed row by row: rounding grows with the side of the disc instead of its area.
            let mut row_sums = [0.0; LANES];
            add_common(&mut row_sums, pair, reach, common);
            for dx in row.common..row.pixels {
                add_lanes(
                    &mut row_sums,
                    pair,
                    reach,
                    dx,
                    &self.lanes[DiscCounts::pixel(dx, dy)],
                );
            }
            for lane in 0..LANES {
                sums[lane] += row_sums[lane];
            }
        }
        for lane in 0..LANES {
            sums[lane] *= self.norms[lane];
        }
        sums
    }
}

#[inline(always)]
fn blur_row(
    counts: &DiscCounts,
    block: &mut DiscBlock,
    padded: &[Plane<f32>; 3],
    y: usize,
    radii: &[f64],
    blurred: [&mut [f32]; 3],
) {
    let [r, g, b] = blurred;
    for (number, radii) in radii.chunks(LANES).enumerate() {
        let x = number * LANES;
        let last = radii.len() - 1;
        let rings: [i32; LANES] = std::array::from_fn(|lane| ring(radii[lane.min(last)]));
        block.set(counts, &rings);
        for (blurred, padded) in [&mut *r, &mut *g, &mut *b].into_iter().zip(padded) {
            let sums = block.gather(padded, counts.reach(), x, y);
            blurred[x..x + radii.len()].copy_from_slice(&sums[..radii.len()]);
        }
    }
}

#[inline(always)]
fn join(pair: &mut [f32], above: &[f32], below: &[f32], is_middle: bool) {
    if is_middle {
        pair.copy_from_slice(above);
        return;
    }
    for ((pair, above), below) in pair.iter_mut().zip(above).zip(below) {
        *pair = above + below;
    }
}

/// Adds pixels on both sides of a block, which begins at `middle` of the row, with common weights.
#[inline(always)]
fn add_common(sums: &mut [f32; LANES], row: &[f32], middle: usize, weights: &[f32]) {
    let Some((&first, weights)) = weights.split_first() else {
        return;
    };
    let center = samples(row, middle);
    for lane in 0..LANES {
        sums[lane] = first * center[lane];
    }
    for (dx, &weight) in weights.iter().enumerate() {
        let left = samples(row, middle - 1 - dx);
        let right = samples(row, middle + 1 + dx);
        for lane in 0..LANES {
            sums[lane] += weight * (left[lane] + right[lane]);
        }
    }
}

/// Adds the pixels at a distance on both sides of a block with a weight per disc.
#[inline(always)]
fn add_lanes(sums: &mut [f32; LANES], row: &[f32], middle: usize, dx: usize, weights: &[f32; LANES]) {
    let left = samples(row, middle - dx);
    if dx == 0 {
        for lane in 0..LANES {
            sums[lane] += weights[lane] * left[lane];
        }
        return;
    }
    let right = samples(row, middle + dx);
    for lane in 0..LANES {
        sums[lane] += weights[lane] * (left[lane] + right[lane]);
    }
}

#[inline(always)]
fn samples(row: &[f32], start: usize) -> &[f32; LANES] {
    row[start..].first_chunk().expect("a whole block")
}

#[cfg(test)]
mod tests {
    use super::super::blur_reference;
    use super::*;

    #[test]
    fn below_the_limit_the_reference_changes_nothing() {
        let picture = Rgb::from_fn(9, 7, |x, y| [x as f64, (x * y) as f64, 1.0 / (1 + y) as f64]);
        for radius in [0.0, 0.088, 0.089, 0.3, SHARP_PX.next_down()] {
            let blurred = blur_reference(&picture, &Plane::filled(9, 7, radius));
            assert_eq!(blurred, picture, "{radius}");
        }
        let next = blur_reference(&picture, &Plane::filled(9, 7, 0.57));
        assert_ne!(next, picture);
    }
}
