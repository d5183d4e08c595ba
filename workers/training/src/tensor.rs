//! Channels of one size.

use imaging::{Plane, Rgb};

use crate::real::Real;

/// Samples `[channel][row][column]`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Tensor<T> {
    /// Number of channels.
    pub channels: usize,
    /// Rows of a channel.
    pub height: usize,
    /// Columns of a channel.
    pub width: usize,
    /// All samples.
    pub data: Vec<T>,
}

impl<T: Real> Tensor<T> {
    /// Zeros.
    #[must_use]
    pub fn zeros(channels: usize, height: usize, width: usize) -> Self {
        Self {
            channels,
            height,
            width,
            data: vec![T::default(); channels * height * width],
        }
    }

    /// Zeros of the same size.
    #[must_use]
    pub fn like(&self) -> Self {
        Self::zeros(self.channels, self.height, self.width)
    }

    /// One channel.
    #[inline(always)]
    #[must_use]
    pub fn plane(&self, channel: usize) -> &[T] {
        let area = self.height * self.width;
        &self.data[channel * area..(channel + 1) * area]
    }

    /// One channel.
    #[inline(always)]
    pub fn plane_mut(&mut self, channel: usize) -> &mut [T] {
        let area = self.height * self.width;
        &mut self.data[channel * area..(channel + 1) * area]
    }

    /// One row of a channel.
    #[inline(always)]
    #[must_use]
    pub fn row(&self, channel: usize, y: usize) -> &[T] {
        let start = (channel * self.height + y) * self.width;
        &self.data[start..start + self.width]
    }

    /// One row of a channel.
    #[inline(always)]
    pub fn row_mut(&mut self, channel: usize, y: usize) -> &mut [T] {
        let start = (channel * self.height + y) * self.width;
        &mut self.data[start..start + self.width]
    }

    /// A square crop, mirrored or not.
    #[must_use]
    pub fn cropped(&self, (left, top): (usize, usize), side: usize, mirrored: bool) -> Self {
        let mut crop = Self::zeros(self.channels, side, side);
        for channel in 0..self.channels {
            for y in 0..side {
                let row = crop.row_mut(channel, y);
                row.copy_from_slice(&self.row(channel, top + y)[left..left + side]);
                if mirrored {
                    row.reverse();
                }
            }
        }
        crop
    }

    /// Adds another tensor of the same size.
    pub fn add(&mut self, other: &Self) {
        for (sum, &value) in self.data.iter_mut().zip(&other.data) {
            *sum += value;
        }
    }

    /// Adds a border of one sample around every channel, a copy of the edge.
    #[must_use]
    pub fn padded(&self) -> Self {
        let (width, height) = (self.width, self.height);
        let mut out = Self::zeros(self.channels, height + 2, width + 2);
        for channel in 0..self.channels {
            for y in 0..height + 2 {
                let source = self.row(channel, y.saturating_sub(1).min(height - 1));
                let target = out.row_mut(channel, y);
                target[1..=width].copy_from_slice(source);
                (target[0], target[width + 1]) = (source[0], source[width - 1]);
            }
        }
        out
    }

    /// The gradient before [`Tensor::padded`] from the one after it: border gradients are added to the edge.
    #[must_use]
    pub fn unpadded(&self) -> Self {
        let (width, height) = (self.width - 2, self.height - 2);
        let mut out = Self::zeros(self.channels, height, width);
        for channel in 0..self.channels {
            for y in 0..height + 2 {
                let source = self.row(channel, y);
                let target = out.row_mut(channel, y.saturating_sub(1).min(height - 1));
                for (target, &source) in target.iter_mut().zip(&source[1..=width]) {
                    *target += source;
                }
                target[0] += source[0];
                target[width - 1] += source[width + 1];
            }
        }
        out
    }

    /// Replaces negative samples by zero.
    #[must_use]
    pub fn relu(mut self) -> Self {
        for value in &mut self.data {
            *value = if *value > T::default() {
                *value
            } else {
                T::default()
            };
        }
        self
    }

    /// The gradient before a ReLU from the one after it and the ReLU's output.
    pub fn unrelu(&mut self, made: &Self) {
        for (gradient, &made) in self.data.iter_mut().zip(&made.data) {
            *gradient = if made > T::default() {
                *gradient
            } else {
                T::default()
            };
        }
    }
}

impl From<&Rgb<f32>> for Tensor<f32> {
    fn from(picture: &Rgb<f32>) -> Self {
        let planes = picture.planes().iter();
        Self {
            channels: 3,
            height: picture.height(),
            width: picture.width(),
            data: planes.flat_map(Plane::data).copied().collect(),
        }
    }
}

impl Tensor<f32> {
    /// Three channels as a picture.
    #[must_use]
    pub fn to_rgb(&self) -> Rgb<f32> {
        let planes = [0, 1, 2].map(|channel| {
            let samples = self.plane(channel).to_vec();
            Plane::new(self.width, self.height, samples).expect("a channel of this size")
        });
        Rgb::new(planes).expect("three planes of one size")
    }
}
