//! One band of a picture, row-major: sample (x, y) is at `y * width + x`, x to the right and y down.

use crate::cancel;

/// A buffer length that is not `width * height`, or planes of different size.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum SizeError {
    /// The buffer's length is not the product of the sides.
    #[error("{width}×{height} needs {expected} samples but the buffer holds {actual}")]
    Length {
        /// Requested columns.
        width: usize,
        /// Requested rows.
        height: usize,
        /// `width * height * channels`.
        expected: usize,
        /// The buffer's length.
        actual: usize,
    },
    /// Two planes of one picture have different sizes.
    #[error("planes must have one size but are {width}×{height} and {other_width}×{other_height}")]
    Mismatch {
        /// Columns of the first plane.
        width: usize,
        /// Rows of the first plane.
        height: usize,
        /// Columns of the other plane.
        other_width: usize,
        /// Rows of the other plane.
        other_height: usize,
    },
}

impl SizeError {
    /// Checks the length of a buffer for a picture of this size.
    pub(crate) fn check(width: usize, height: usize, expected: usize, actual: usize) -> Result<(), Self> {
        if actual == expected {
            return Ok(());
        }
        Err(Self::Length {
            width,
            height,
            expected,
            actual,
        })
    }
}

/// One band of a picture. It may be empty; every consumer documents its treatment of empty planes.
#[derive(Debug, Clone, PartialEq)]
pub struct Plane<T> {
    width: usize,
    height: usize,
    data: Vec<T>,
}

impl<T> Plane<T> {
    /// Wraps a row-major buffer of `width * height` samples.
    ///
    /// # Errors
    /// [`SizeError::Length`] if the buffer is shorter or longer.
    pub fn new(width: usize, height: usize, data: Vec<T>) -> Result<Self, SizeError> {
        SizeError::check(width, height, width.saturating_mul(height), data.len())?;
        Ok(Self { width, height, data })
    }

    /// Fills a plane from a function of (x, y), row by row.
    pub fn from_fn(width: usize, height: usize, mut sample: impl FnMut(usize, usize) -> T) -> Self {
        let mut data = Vec::with_capacity(width * height);
        for y in 0..height {
            cancel::check();
            for x in 0..width {
                data.push(sample(x, y));
            }
        }
        Self { width, height, data }
    }

    /// Columns.
    #[must_use]
    pub fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    #[must_use]
    pub fn height(&self) -> usize {
        self.height
    }

    /// Columns and rows.
    #[must_use]
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// All samples, row-major.
    #[must_use]
    pub fn data(&self) -> &[T] {
        &self.data
    }

    /// All samples, row-major.
    pub fn data_mut(&mut self) -> &mut [T] {
        &mut self.data
    }

    /// The buffer.
    #[must_use]
    pub fn into_data(self) -> Vec<T> {
        self.data
    }

    /// Row `y`.
    ///
    /// # Panics
    /// If `y` is not below the height.
    #[must_use]
    pub fn row(&self, y: usize) -> &[T] {
        &self.data[y * self.width..(y + 1) * self.width]
    }

    /// Row `y`.
    ///
    /// # Panics
    /// If `y` is not below the height.
    pub fn row_mut(&mut self, y: usize) -> &mut [T] {
        &mut self.data[y * self.width..(y + 1) * self.width]
    }

    /// A plane of the same size with every sample mapped.
    pub fn map<U>(&self, sample: impl FnMut(&T) -> U) -> Plane<U> {
        Plane {
            width: self.width,
            height: self.height,
            data: self.data.iter().map(sample).collect(),
        }
    }
}

impl<T: Clone> Plane<T> {
    /// A plane of one value.
    #[must_use]
    pub fn filled(width: usize, height: usize, value: T) -> Self {
        Self {
            width,
            height,
            data: vec![value; width * height],
        }
    }
}

impl<T: Copy> Plane<T> {
    /// The sample at (x, y).
    ///
    /// # Panics
    /// If (x, y) is outside.
    #[must_use]
    pub fn pixel(&self, x: usize, y: usize) -> T {
        assert!(x < self.width, "column {x} of a plane {} wide", self.width);
        self.data[y * self.width + x]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_buffer_of_the_wrong_length_is_refused_with_both_lengths() {
        let error = Plane::new(3, 2, vec![0u8; 5]).unwrap_err();
        assert_eq!(error.to_string(), "3×2 needs 6 samples but the buffer holds 5");
    }

    #[test]
    fn rows_are_contiguous_and_x_runs_fastest() {
        let plane = Plane::from_fn(3, 2, |x, y| 10 * y + x);
        assert_eq!(plane.row(1), &[10, 11, 12]);
        assert_eq!(plane.pixel(2, 0), 2);
    }
}
