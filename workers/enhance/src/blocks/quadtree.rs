//! Quadtree search for a region of a picture.

use std::ops::Range;

use imaging::{Plane, Rgb8, luma1000};

/// The search ends at a region of at most the picture's pixels divided by this.
const PARTS: usize = 1024;

/// Scores within this distance are ties: regions with the same content must tie regardless of rounding.
const EQUAL: f64 = 1e-9;

/// A rectangle of pixels.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct QuadRegion {
    /// Columns.
    pub columns: Range<usize>,
    /// Rows.
    pub rows: Range<usize>,
}

impl QuadRegion {
    /// The region as a slice of every row.
    fn slices<'a, T>(&'a self, data: &'a [T], width: usize, samples: usize) -> impl Iterator<Item = &'a [T]> {
        let columns = samples * self.columns.start..samples * self.columns.end;
        let rows = self.rows.clone();
        rows.map(move |y| &data[y * width * samples..][columns.clone()])
    }

    fn area(&self) -> usize {
        self.columns.len() * self.rows.len()
    }

    /// Top left, top right, bottom left, bottom right, without empty ones; the first half of a side is the larger one.
    fn quarters(&self) -> Vec<Self> {
        let [columns, rows] = [&self.columns, &self.rows].map(|side| {
            let middle = (side.start + side.len() / 2 + 1).min(side.end);
            [side.start..middle, middle..side.end]
        });
        let quarters = rows.iter().flat_map(|rows| {
            columns.iter().map(|columns| Self {
                columns: columns.clone(),
                rows: rows.clone(),
            })
        });
        quarters.filter(|quarter| quarter.area() > 0).collect()
    }

    /// The product of the distances between its outer pixels.
    fn span(&self) -> usize {
        (self.columns.len() - 1) * (self.rows.len() - 1)
    }

    /// The mean color, 0..=1.
    #[must_use]
    pub fn mean_color(&self, picture: &Rgb8) -> [f64; 3] {
        let mut sums = [0u64; 3];
        for row in self.slices(picture.data(), picture.width(), 3) {
            for pixel in row.chunks_exact(3) {
                for (sum, &code) in sums.iter_mut().zip(pixel) {
                    *sum += u64::from(code);
                }
            }
        }
        sums.map(|sum| sum as f64 / (255 * self.area()) as f64)
    }
}

/// Starting from the whole picture, keeps the quarter with the lowest score, the first of ties, until it spans at most
/// one of [`PARTS`] parts of the picture's pixels or cannot be divided. The cost is 4/3 scores per pixel at any depth.
fn search((width, height): (usize, usize), score: impl Fn(&QuadRegion) -> f64) -> QuadRegion {
    let mut region = QuadRegion {
        columns: 0..width,
        rows: 0..height,
    };
    let end = width * height / PARTS;
    while region.span() > end {
        let quarters = region.quarters();
        if quarters.len() < 2 {
            break;
        }
        let mut quarters = quarters.into_iter().map(|quarter| (score(&quarter), quarter));
        let Some(mut best) = quarters.next() else { break };
        for quarter in quarters {
            if quarter.0 < best.0 - EQUAL {
                best = quarter;
            }
        }
        region = best.1;
    }
    region
}

/// The region with the lowest variance of luma. Sums are integers, so that ties are exact.
#[must_use]
pub fn calmest(picture: &Rgb8) -> QuadRegion {
    search((picture.width(), picture.height()), |region| {
        let (mut sum, mut squares) = (0u64, 0u128);
        for row in region.slices(picture.data(), picture.width(), 3) {
            let mut row_squares = 0u64;
            for pixel in row.chunks_exact(3) {
                let luma = u64::from(luma1000([pixel[0], pixel[1], pixel[2]]));
                sum += luma;
                row_squares += luma * luma;
            }
            squares += u128::from(row_squares);
        }
        let count = region.area() as u128;
        let spread = count * squares - u128::from(sum) * u128::from(sum);
        spread as f64 / (count * count) as f64
    })
}

/// The region with the smallest mean of a plane.
#[must_use]
pub fn lowest(plane: &Plane<f64>) -> QuadRegion {
    search(plane.size(), |region| {
        let rows = region.slices(plane.data(), plane.width(), 1);
        rows.map(|row| row.iter().sum::<f64>()).sum::<f64>() / region.area() as f64
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_calmest_quarter_is_kept_until_it_is_small() {
        // A checker that fades towards the bottom right.
        let picture = Rgb8::from_fn(64, 64, |x, y| {
            let contrast = 63 - x.min(y) as u8;
            [if (x + y) % 2 == 0 {
                128 + contrast
            } else {
                128 - contrast
            }; 3]
        });
        let region = calmest(&picture);
        // The first halves are the larger ones: 33 of 64, 16 of 31, 8 of 15, 4 of 7; 3 × 3 span 4 = 64 · 64 / 1024.
        assert_eq!(
            region,
            QuadRegion {
                columns: 61..64,
                rows: 61..64
            }
        );
        // 130 126 130, 126 129 127, 130 127 128.
        assert_eq!(region.mean_color(&picture), [1153.0 / (255.0 * 9.0); 3]);
    }

    #[test]
    fn of_equals_the_first_wins_and_the_first_half_is_the_larger_one() {
        let whole = QuadRegion {
            columns: 0..9,
            rows: 0..7,
        };
        let sides: Vec<_> = whole
            .quarters()
            .into_iter()
            .map(|quarter| (quarter.columns, quarter.rows))
            .collect();
        assert_eq!(sides, [(0..5, 0..4), (5..9, 0..4), (0..5, 4..7), (5..9, 4..7)]);
        let plane = Plane::filled(9, 7, 1.0);
        assert_eq!(
            lowest(&plane),
            QuadRegion {
                columns: 0..2,
                rows: 0..2
            }
        );
        let line = QuadRegion {
            columns: 0..2,
            rows: 3..4,
        };
        assert_eq!(line.quarters(), [line]);
    }

    #[test]
    fn the_lowest_mean_is_found() {
        let plane = Plane::from_fn(
            40,
            40,
            |x, y| if (30..33).contains(&x) && y < 3 { -1.0 } else { 0.0 },
        );
        let region = lowest(&plane);
        assert!(region.columns.start >= 28 && region.rows.start == 0, "{region:?}");
    }
}
