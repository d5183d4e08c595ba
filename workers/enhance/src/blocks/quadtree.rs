//! Searching a region of the picture by taking a quarter of a quarter of a quarter.

use std::ops::Range;

use imaging::{Plane, Rgb8, luma1000};

/// Part of the picture that the search ends at.
const AREA_MIN: f64 = 1.0 / 1024.0;

/// Scores closer together than this are equal: regions with the same content must tie, whatever rounding their sums saw.
const EQUAL: f64 = 1e-9;

/// A rectangle of pixels.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Region {
    /// Columns.
    pub columns: Range<usize>,
    /// Rows.
    pub rows: Range<usize>,
}

impl Region {
    /// The region as a slice of every row.
    fn slices<'a, T>(&'a self, data: &'a [T], width: usize, samples: usize) -> impl Iterator<Item = &'a [T]> {
        let columns = samples * self.columns.start..samples * self.columns.end;
        let rows = self.rows.clone();
        rows.map(move |y| &data[y * width * samples..][columns.clone()])
    }

    fn area(&self) -> usize {
        self.columns.len() * self.rows.len()
    }

    /// Top left, top right, bottom left, bottom right; of an odd side the first half is the smaller one. `None` when
    /// a side would fall below 2.
    fn quarters(&self) -> Option<[Self; 4]> {
        let (half_width, half_height) = (self.columns.len() / 2, self.rows.len() / 2);
        if half_width < 2 || half_height < 2 {
            return None;
        }
        let middle = (self.columns.start + half_width, self.rows.start + half_height);
        let (left, right) = (self.columns.start..middle.0, middle.0..self.columns.end);
        let (top, bottom) = (self.rows.start..middle.1, middle.1..self.rows.end);
        let corners = [(&left, &top), (&right, &top), (&left, &bottom), (&right, &bottom)];
        Some(corners.map(|(columns, rows)| Self {
            columns: columns.clone(),
            rows: rows.clone(),
        }))
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

/// Starting from the whole picture, keeps the quarter with the highest score, the first of equals, until its area is
/// below 1/1024 of the picture's or a side would fall below 2 pixels. Each pixel is scored a third more than once on
/// the whole, whatever the depth.
fn search((width, height): (usize, usize), score: impl Fn(&Region) -> f64) -> Region {
    let mut region = Region {
        columns: 0..width,
        rows: 0..height,
    };
    let area_min = AREA_MIN * (width * height) as f64;
    while region.area() as f64 >= area_min {
        let Some(quarters) = region.quarters() else { break };
        let mut best = f64::NEG_INFINITY;
        for quarter in quarters {
            let score = score(&quarter);
            if score > best + EQUAL {
                best = score;
                region = quarter;
            }
        }
    }
    region
}

/// The region with the lowest variance of luma. Sums are whole numbers, so that equal variances are equal.
#[must_use]
pub fn calmest(picture: &Rgb8) -> Region {
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
        -(spread as f64 / (count * count) as f64)
    })
}

/// The region with the largest mean of a plane.
#[must_use]
pub fn highest(plane: &Plane<f64>) -> Region {
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
        // 1/1024 of 4096 pixels is 4: a region of 2 × 2 still counts 4 pixels, but its quarters would have sides of 1.
        assert_eq!(
            region,
            Region {
                columns: 62..64,
                rows: 62..64
            }
        );
        // 129, 127, 127 and 128.
        assert_eq!(region.mean_color(&picture), [511.0 / (255.0 * 4.0); 3]);
    }

    #[test]
    fn of_equals_the_first_wins_and_odd_sides_leave_the_larger_half_behind() {
        let plane = Plane::filled(9, 7, 1.0);
        assert_eq!(
            highest(&plane),
            Region {
                columns: 0..4,
                rows: 0..3
            }
        );
        let small = Plane::filled(3, 3, 1.0);
        assert_eq!(
            highest(&small),
            Region {
                columns: 0..3,
                rows: 0..3
            }
        );
    }

    #[test]
    fn the_highest_mean_is_found() {
        let plane = Plane::from_fn(
            40,
            40,
            |x, y| if (30..33).contains(&x) && y < 3 { 1.0 } else { 0.0 },
        );
        let region = highest(&plane);
        assert!(region.columns.start >= 28 && region.rows.start == 0, "{region:?}");
    }
}
