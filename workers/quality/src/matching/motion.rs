//! True motion between two frames, and the matches that follow it.

use imaging::{Plane, Rgb};

use super::features::{Features, Keypoint};
use super::nearest::Match;

/// Largest distance of a correct match from the true position, px of the picture.
pub const CORRECT_PX: f64 = 3.0;

/// For each pixel of a frame, the position of its surface point in the previous frame.
///
/// A position (x, y) is in pixels of the picture, the center of the first pixel is (0.5, 0.5). It is NaN if the point is
/// outside or occluded in the previous frame, or if the pixel shows no surface. Only pixels of keypoints are read.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// One position per pixel of the current frame.
    pub positions: Plane<[f32; 2]>,
}

impl Motion {
    /// From displacements in x and y, px, and a third plane that is above 0 where the point is visible.
    #[must_use]
    pub fn from_displacements(displacements: &Rgb<f32>) -> Self {
        let (width, height) = displacements.planes()[0].size();
        let mut motion = Self::unknown(width, height);
        for y in 0..height {
            for x in 0..width {
                let moved = displacements.planes().each_ref().map(|plane| plane.pixel(x, y));
                motion.put([x, y], moved);
            }
        }
        motion
    }

    /// Without any position.
    #[must_use]
    pub fn unknown(width: usize, height: usize) -> Self {
        Self {
            positions: Plane::filled(width, height, [f32::NAN; 2]),
        }
    }

    /// Sets the position of the point at a pixel from its displacement in x and y, px, and a number above 0 if it is visible.
    pub fn put(&mut self, [x, y]: [usize; 2], [across, down, visible]: [f32; 3]) {
        if visible > 0.0 {
            self.positions.row_mut(y)[x] = [x as f32 + 0.5 + across, y as f32 + 0.5 + down];
        }
    }

    /// The position of a keypoint in the previous frame: that of its pixel, shifted by the keypoint's distance from the
    /// pixel's center. `None` outside of the plane and where the position is NaN.
    #[must_use]
    pub fn position_before(&self, keypoint: &Keypoint) -> Option<[f64; 2]> {
        let (x, y) = (f64::from(keypoint.x), f64::from(keypoint.y));
        let (column, row) = (x.floor(), y.floor());
        let (width, height) = self.positions.size();
        let is_inside = (0.0..width as f64).contains(&column) && (0.0..height as f64).contains(&row);
        let [before_x, before_y] = is_inside.then(|| self.positions.pixel(column as usize, row as usize))?;
        let position = [
            f64::from(before_x) + x - column - 0.5,
            f64::from(before_y) + y - row - 0.5,
        ];
        position.iter().all(|value| value.is_finite()).then_some(position)
    }

    /// The matches within [`CORRECT_PX`] of the true position. A match without a true position is not correct.
    #[must_use]
    pub fn correct_matches(&self, current: &Features, previous: &Features, matches: &[Match]) -> Vec<Match> {
        let is_correct = |pair: &&Match| {
            let seen = &previous.keypoints[pair.previous as usize];
            self.position_before(&current.keypoints[pair.current as usize])
                .is_some_and(|[x, y]| {
                    let (across, down) = (f64::from(seen.x) - x, f64::from(seen.y) - y);
                    across * across + down * down <= CORRECT_PX * CORRECT_PX
                })
        };
        matches.iter().filter(is_correct).copied().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn displacements_start_at_the_center_of_their_pixel() {
        let planes = [[3.0, 9.0], [-1.0, 9.0], [1.0, 0.0]];
        let planes = planes.map(|values| Plane::new(2, 1, values.to_vec()).unwrap());
        let motion = Motion::from_displacements(&Rgb::new(planes).unwrap());
        assert_eq!(motion.positions.pixel(0, 0), [3.5, -0.5]);
        assert!(motion.positions.pixel(1, 0)[0].is_nan());
    }

    fn keypoint(x: f32, y: f32) -> Keypoint {
        Keypoint {
            x,
            y,
            level: 0,
            response: 1.0,
        }
    }

    fn shifted() -> Motion {
        Motion {
            positions: Plane::from_fn(20, 10, |x, y| match x {
                0..15 => [x as f32 + 4.5, y as f32 - 0.5],
                _ => [f32::NAN; 2],
            }),
        }
    }

    #[test]
    fn the_position_keeps_the_fraction_of_a_pixel() {
        let motion = shifted();
        assert_eq!(motion.position_before(&keypoint(3.25, 5.5)), Some([7.25, 4.5]));
        assert_eq!(motion.position_before(&keypoint(16.0, 5.0)), None);
        assert_eq!(motion.position_before(&keypoint(3.0, 10.0)), None);
        assert_eq!(motion.position_before(&keypoint(-0.1, 3.0)), None);
    }

    #[test]
    fn a_match_is_correct_up_to_three_pixels_and_only_with_a_true_position() {
        let current = Features {
            keypoints: vec![keypoint(3.5, 5.5), keypoint(3.5, 5.5), keypoint(16.5, 5.5)],
            descriptors: vec![[0; 4]; 3],
        };
        let previous = Features {
            keypoints: vec![keypoint(7.5, 7.5), keypoint(7.5, 7.6), keypoint(20.5, 4.5)],
            descriptors: vec![[0; 4]; 3],
        };
        let matches: Vec<Match> = (0..3)
            .map(|i| Match {
                current: i,
                previous: i,
            })
            .collect();
        assert_eq!(
            shifted().correct_matches(&current, &previous, &matches),
            matches[..1]
        );
    }
}
