//! Rasters of picture files: interleaved integer samples, 8 or 16 bit, gray or color, with or without alpha.

use crate::plane::{Plane, SizeError};
use crate::vectorized;

/// Integer samples of one depth, interleaved.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Samples {
    /// Codes 0..=255.
    U8(Vec<u8>),
    /// Codes 0..=65535.
    U16(Vec<u16>),
}

impl Samples {
    /// Number of samples.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::U8(codes) => codes.len(),
            Self::U16(codes) => codes.len(),
        }
    }

    /// Whether it is empty.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The samples at 8 bit; 16 bit is reduced by `(v * 255 + 32767) / 65535`, which rounds to nearest.
    #[must_use]
    pub fn to_u8(&self) -> Vec<u8> {
        match self {
            Self::U8(codes) => codes.clone(),
            Self::U16(codes) => codes
                .iter()
                .map(|&v| ((u32::from(v) * 255 + 32767) / 65535) as u8)
                .collect(),
        }
    }
}

/// Color channels of a raster, without alpha.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Channels {
    /// One luminance channel, equivalent to R = G = B.
    Gray,
    /// Red, green, blue, interleaved in this order.
    Rgb,
}

impl Channels {
    /// Samples of one pixel.
    #[must_use]
    pub fn count(self) -> usize {
        match self {
            Self::Gray => 1,
            Self::Rgb => 3,
        }
    }
}

/// A decoded picture file: interleaved integer samples, and the separate, unprocessed alpha channel.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Raster {
    width: usize,
    height: usize,
    channels: Channels,
    samples: Samples,
    alpha: Option<Samples>,
}

impl Raster {
    /// Combines samples and sides.
    ///
    /// # Errors
    /// [`SizeError::Length`] if samples or alpha do not fit the sides.
    pub fn new(
        width: usize,
        height: usize,
        channels: Channels,
        samples: Samples,
        alpha: Option<Samples>,
    ) -> Result<Self, SizeError> {
        let pixels = width.saturating_mul(height);
        SizeError::check(
            width,
            height,
            pixels.saturating_mul(channels.count()),
            samples.len(),
        )?;
        if let Some(alpha) = &alpha {
            SizeError::check(width, height, pixels, alpha.len())?;
        }
        Ok(Self {
            width,
            height,
            channels,
            samples,
            alpha,
        })
    }

    fn opaque((width, height): (usize, usize), channels: Channels, samples: Samples) -> Self {
        Self {
            width,
            height,
            channels,
            samples,
            alpha: None,
        }
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

    /// Gray or color.
    #[must_use]
    pub fn channels(&self) -> Channels {
        self.channels
    }

    /// Interleaved samples without alpha.
    #[must_use]
    pub fn samples(&self) -> &Samples {
        &self.samples
    }

    /// The samples.
    #[must_use]
    pub fn into_samples(self) -> Samples {
        self.samples
    }

    /// The alpha channel, if the file had one.
    #[must_use]
    pub fn alpha(&self) -> Option<&Samples> {
        self.alpha.as_ref()
    }

    /// 8-bit color: 16 bit reduced (see [`Samples::to_u8`]), gray repeated, alpha dropped.
    #[must_use]
    pub fn to_rgb8(&self) -> Rgb8 {
        let codes = self.samples.to_u8();
        let data = match self.channels {
            Channels::Rgb => codes,
            Channels::Gray => codes.into_iter().flat_map(|v| [v; 3]).collect(),
        };
        Rgb8 {
            width: self.width,
            height: self.height,
            data,
        }
    }
}

impl From<Rgb8> for Raster {
    fn from(picture: Rgb8) -> Self {
        let Rgb8 { width, height, data } = picture;
        Self::opaque((width, height), Channels::Rgb, Samples::U8(data))
    }
}

impl From<Plane<u8>> for Raster {
    fn from(plane: Plane<u8>) -> Self {
        Self::opaque(plane.size(), Channels::Gray, Samples::U8(plane.into_data()))
    }
}

impl From<Plane<u16>> for Raster {
    fn from(plane: Plane<u16>) -> Self {
        Self::opaque(plane.size(), Channels::Gray, Samples::U16(plane.into_data()))
    }
}

/// An 8-bit color picture, interleaved R, G, B: the input of metrics, enhancers and codecs.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Rgb8 {
    width: usize,
    height: usize,
    data: Vec<u8>,
}

impl Rgb8 {
    /// Wraps `3 * width * height` codes.
    ///
    /// # Errors
    /// [`SizeError::Length`] if the buffer is shorter or longer.
    pub fn new(width: usize, height: usize, data: Vec<u8>) -> Result<Self, SizeError> {
        let expected = width.saturating_mul(height).saturating_mul(3);
        SizeError::check(width, height, expected, data.len())?;
        Ok(Self { width, height, data })
    }

    /// Fills a picture from a function of (x, y), row by row.
    pub fn from_fn(width: usize, height: usize, mut pixel: impl FnMut(usize, usize) -> [u8; 3]) -> Self {
        let mut data = Vec::with_capacity(width * height * 3);
        for y in 0..height {
            for x in 0..width {
                data.extend(pixel(x, y));
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

    /// Interleaved codes.
    #[must_use]
    pub fn data(&self) -> &[u8] {
        &self.data
    }

    /// Interleaved codes.
    pub fn data_mut(&mut self) -> &mut [u8] {
        &mut self.data
    }

    /// The pixels in row-major order.
    pub fn pixels(&self) -> impl ExactSizeIterator<Item = [u8; 3]> + '_ {
        self.data.chunks_exact(3).map(|p| [p[0], p[1], p[2]])
    }

    /// The pixel at (x, y).
    ///
    /// # Panics
    /// If (x, y) is outside.
    #[must_use]
    pub fn pixel(&self, x: usize, y: usize) -> [u8; 3] {
        assert!(x < self.width, "column {x} of a picture {} wide", self.width);
        let i = 3 * (y * self.width + x);
        [self.data[i], self.data[i + 1], self.data[i + 2]]
    }

    /// `gray8 = (299 R + 587 G + 114 B + 500) div 1000`, the integer luma rounded to nearest.
    #[must_use]
    pub fn to_gray8(&self) -> Plane<u8> {
        let mut gray = Plane::filled(self.width, self.height, 0);
        vectorized!(gray_codes(&self.data, gray.data_mut()));
        gray
    }

    /// Planes of red, green and blue.
    #[must_use]
    pub fn to_planes(&self) -> [Plane<u8>; 3] {
        let mut planes = [0; 3].map(|_| Plane::filled(self.width, self.height, 0));
        let [r, g, b] = planes.each_mut().map(Plane::data_mut);
        vectorized!(split(&self.data, r, g, b));
        planes
    }
}

#[inline(always)]
fn gray_codes(codes: &[u8], gray: &mut [u8]) {
    for (gray, p) in gray.iter_mut().zip(codes.chunks_exact(3)) {
        *gray = ((luma1000([p[0], p[1], p[2]]) + 500) / 1000) as u8;
    }
}

#[inline(always)]
fn split(codes: &[u8], r: &mut [u8], g: &mut [u8], b: &mut [u8]) {
    for (((r, g), b), p) in r.iter_mut().zip(g).zip(b).zip(codes.chunks_exact(3)) {
        (*r, *g, *b) = (p[0], p[1], p[2]);
    }
}

/// `299 R + 587 G + 114 B`, 0..=255000: thousandths of the luma (ITU-R BT.601 weights), exact in integers.
#[must_use]
#[inline(always)]
pub fn luma1000([r, g, b]: [u8; 3]) -> u32 {
    299 * u32::from(r) + 587 * u32::from(g) + 114 * u32::from(b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sixteen_bit_codes_round_to_the_nearest_eight_bit_code() {
        assert_eq!(Samples::U16(vec![0, 128, 129, 65535]).to_u8(), [0, 0, 1, 255]);
    }

    #[test]
    fn gray_as_color_repeats_its_channel() {
        let raster = Raster::from(Plane::new(2, 1, vec![7u8, 9]).unwrap());
        assert_eq!(raster.to_rgb8().data(), &[7, 7, 7, 9, 9, 9]);
    }

    #[test]
    fn luma_of_white_is_exact() {
        assert_eq!(luma1000([255; 3]), 255_000);
        assert_eq!(Rgb8::from_fn(1, 1, |_, _| [255; 3]).to_gray8().data(), &[255]);
    }
}
