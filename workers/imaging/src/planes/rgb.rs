//! Three planes of one size, in the order red, green, blue.

use crate::cancel;
use crate::plane::{Plane, SizeError};

/// A planar color picture; the user defines the meaning of samples (linear radiance, encoded values).
#[derive(Debug, Clone, PartialEq)]
pub struct Rgb<T> {
    planes: [Plane<T>; 3],
}

impl<T> Rgb<T> {
    /// Combines a red, a green and a blue plane.
    ///
    /// # Errors
    /// [`SizeError::Mismatch`] if the three differ in size.
    pub fn new(planes: [Plane<T>; 3]) -> Result<Self, SizeError> {
        let (width, height) = planes[0].size();
        for plane in &planes[1..] {
            let (other_width, other_height) = plane.size();
            if (other_width, other_height) != (width, height) {
                return Err(SizeError::Mismatch {
                    width,
                    height,
                    other_width,
                    other_height,
                });
            }
        }
        Ok(Self { planes })
    }

    /// Fills the three planes from a function of (x, y), row by row.
    pub fn from_fn(width: usize, height: usize, mut pixel: impl FnMut(usize, usize) -> [T; 3]) -> Self {
        let mut bands = [const { Vec::new() }; 3];
        for band in &mut bands {
            band.reserve_exact(width * height);
        }
        for y in 0..height {
            cancel::check();
            for x in 0..width {
                for (band, sample) in bands.iter_mut().zip(pixel(x, y)) {
                    band.push(sample);
                }
            }
        }
        let planes =
            bands.map(|band| Plane::new(width, height, band).expect("width × height pixels were pushed"));
        Self { planes }
    }

    /// Columns.
    #[must_use]
    pub fn width(&self) -> usize {
        self.planes[0].width()
    }

    /// Rows.
    #[must_use]
    pub fn height(&self) -> usize {
        self.planes[0].height()
    }

    /// Columns and rows.
    #[must_use]
    pub fn size(&self) -> (usize, usize) {
        self.planes[0].size()
    }

    /// Red, green, blue.
    #[must_use]
    pub fn planes(&self) -> &[Plane<T>; 3] {
        &self.planes
    }

    /// Mutable samples of red, green, blue.
    pub fn planes_mut(&mut self) -> [&mut [T]; 3] {
        self.planes.each_mut().map(Plane::data_mut)
    }

    /// The three planes.
    #[must_use]
    pub fn into_planes(self) -> [Plane<T>; 3] {
        self.planes
    }

    /// A picture of the same size with every sample mapped.
    pub fn map<U>(&self, mut sample: impl FnMut(&T) -> U) -> Rgb<U> {
        Rgb {
            planes: self.planes.each_ref().map(|plane| plane.map(&mut sample)),
        }
    }
}

impl<T: Copy> Rgb<T> {
    /// The pixel at (x, y).
    ///
    /// # Panics
    /// If (x, y) is outside.
    #[must_use]
    pub fn pixel(&self, x: usize, y: usize) -> [T; 3] {
        self.planes.each_ref().map(|plane| plane.pixel(x, y))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn planes_of_different_sizes_are_refused() {
        let small = Plane::filled(2, 2, 0.0f32);
        let large = Plane::filled(3, 2, 0.0f32);
        let error = Rgb::new([small.clone(), small, large]).unwrap_err();
        assert_eq!(error.to_string(), "planes must have one size but are 2×2 and 3×2");
    }

    #[test]
    fn pixels_keep_their_channel_order() {
        let picture = Rgb::from_fn(2, 1, |x, _| [x as u8, 10 + x as u8, 20 + x as u8]);
        assert_eq!(picture.pixel(1, 0), [1, 11, 21]);
        assert_eq!(picture.planes()[2].data(), &[20, 21]);
    }
}
