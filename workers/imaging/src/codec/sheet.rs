//! Samples of a file before they have a meaning, and the only rules by which they become masks, distances or pictures.
//! Every content with exactly one meaning is accepted.

use std::ops::Range;

use super::{DecodeError, new_plane};
use crate::{Channels, Plane, Raster, Rgb, Samples};

/// Interleaved samples of a file.
pub(super) struct Sheet {
    pub(super) width: usize,
    pub(super) height: usize,
    /// Samples per pixel, alpha included.
    pub(super) bands: usize,
    /// Whether the last band is alpha.
    pub(super) has_alpha: bool,
    pub(super) values: SheetValues,
    /// Colors of the values, if they are indices.
    pub(super) palette: Option<Vec<[u8; 3]>>,
}

/// The samples in the narrowest type that keeps them.
pub(super) enum SheetValues {
    U8(Vec<u8>),
    U16(Vec<u16>),
    /// Other integers and truth values.
    Wide(Vec<i64>),
    F32(Vec<f32>),
}

impl SheetValues {
    fn take_bands(&self, bands: usize, taken: Range<usize>) -> Self {
        match self {
            Self::U8(values) => Self::U8(take_bands(values, bands, taken)),
            Self::U16(values) => Self::U16(take_bands(values, bands, taken)),
            Self::Wide(values) => Self::Wide(take_bands(values, bands, taken)),
            Self::F32(values) => Self::F32(take_bands(values, bands, taken)),
        }
    }

    fn number(&self, index: usize) -> f64 {
        match self {
            Self::U8(values) => f64::from(values[index]),
            Self::U16(values) => f64::from(values[index]),
            Self::Wide(values) => values[index] as f64,
            Self::F32(values) => f64::from(values[index]),
        }
    }

    /// Value of opaque alpha.
    fn opaque(&self) -> f64 {
        match self {
            Self::U8(_) => 255.0,
            Self::U16(_) => 65535.0,
            Self::Wide(_) | Self::F32(_) => 1.0,
        }
    }
}

fn take_bands<T: Copy>(values: &[T], bands: usize, taken: Range<usize>) -> Vec<T> {
    let pixels = values.chunks_exact(bands);
    pixels
        .flat_map(|pixel| pixel[taken.clone()].iter().copied())
        .collect()
}

const MASK: &str = "one whole number of 0 to 65535 for each pixel (gray or palette PNG, BMP or TIFF, or NPY of shape \
                    [height, width])";
const DISTANCES: &str = "one distance for each pixel (gray PNG, BMP or TIFF, NPY of shape [height, width], or EXR with \
                         one channel)";
const PICTURE: &str = "1, 3 or 4 channels of uint8 or uint16 (sRGB codes) or of floats (linear light)";

fn unsuitable(found: String, wanted: &'static str) -> DecodeError {
    DecodeError::Unsuitable { found, wanted }
}

impl Sheet {
    /// The numbers of a mask. The index of a palette is the number.
    pub(super) fn into_mask(self) -> Result<Plane<u16>, DecodeError> {
        let sheet = self.into_single_band(MASK)?;
        let (width, height) = (sheet.width, sheet.height);
        let codes = match sheet.values {
            SheetValues::U8(codes) => codes.into_iter().map(u16::from).collect(),
            SheetValues::U16(codes) => codes,
            values => (0..width * height)
                .map(|index| match values.number(index) {
                    value if (0.0..=65535.0).contains(&value) && value.fract() == 0.0 => Ok(value as u16),
                    value => {
                        let (x, y) = (index % width, index / width);
                        Err(unsuitable(format!("{value} at pixel ({x}, {y})"), MASK))
                    }
                })
                .collect::<Result<_, _>>()?,
        };
        new_plane(width, height, codes)
    }

    /// Distances. A palette must be gray, each index its own shade.
    pub(super) fn into_distances(self) -> Result<FilePlane, DecodeError> {
        let mut colors = self.palette.iter().flatten().enumerate();
        if colors.any(|(index, color)| color.iter().any(|&shade| usize::from(shade) != index)) {
            return Err(unsuitable("a palette of colors".to_owned(), DISTANCES));
        }
        let sheet = self.into_single_band(DISTANCES)?;
        let (width, height) = (sheet.width, sheet.height);
        let values = match sheet.values {
            SheetValues::U8(codes) => {
                let codes = codes.into_iter().map(u16::from).collect();
                return new_plane(width, height, codes).map(FilePlane::Codes);
            }
            SheetValues::U16(codes) => return new_plane(width, height, codes).map(FilePlane::Codes),
            SheetValues::F32(values) => return new_plane(width, height, values).map(FilePlane::Floats),
            SheetValues::Wide(values) => values,
        };
        if let Ok(codes) = values.iter().map(|&value| u16::try_from(value)).collect() {
            return new_plane(width, height, codes).map(FilePlane::Codes);
        }
        let values = values.iter().enumerate().map(|(index, &value)| {
            i32::try_from(value).map_err(|_| {
                let (x, y) = (index % width, index / width);
                unsuitable(
                    format!("{value} at pixel ({x}, {y})"),
                    "integers of at most 32 bits",
                )
            })
        });
        new_plane(width, height, values.collect::<Result<_, _>>()?).map(FilePlane::Wide)
    }

    /// Drops opaque alpha and the repetitions of R = G = B.
    fn into_single_band(self, wanted: &'static str) -> Result<Self, DecodeError> {
        let (bands, colors) = (self.bands, self.colors());
        let locate = |pixel: usize| (pixel % self.width, pixel / self.width);
        let pixels = self.width * self.height;
        let number = |pixel: usize, band: usize| self.values.number(pixel * bands + band);
        if self.has_alpha {
            let opaque = self.values.opaque();
            if let Some(pixel) = (0..pixels).find(|&pixel| number(pixel, colors) != opaque) {
                let found = format!("a picture that is transparent at pixel {:?}", locate(pixel));
                return Err(unsuitable(found, wanted));
            }
        }
        if colors != 1 && colors != 3 {
            return Err(unsuitable(format!("{colors} channels"), wanted));
        }
        let differs = |pixel: usize, band: usize| number(pixel, band).to_bits() != number(pixel, 0).to_bits();
        if let Some(pixel) = (0..pixels).find(|&pixel| (1..colors).any(|band| differs(pixel, band))) {
            let found = format!(
                "a color picture, whose R, G and B differ at pixel {:?},",
                locate(pixel)
            );
            return Err(unsuitable(found, wanted));
        }
        if bands == 1 {
            return Ok(self);
        }
        Ok(Self {
            bands: 1,
            has_alpha: false,
            values: self.values.take_bands(bands, 0..1),
            ..self
        })
    }

    fn colors(&self) -> usize {
        self.bands - usize::from(self.has_alpha)
    }

    /// A picture: integers are sRGB codes, floats linear light.
    pub(super) fn into_radiance(mut self) -> Result<Radiance, DecodeError> {
        if let (Some(palette), SheetValues::U8(indices)) = (self.palette.take(), &self.values) {
            let color = |&index: &u8| palette.get(usize::from(index)).copied().unwrap_or_default();
            self.values = SheetValues::U8(indices.iter().flat_map(color).collect());
            self.bands = 3;
        }
        let colors = self.colors();
        let channels = match colors {
            1 => Channels::Gray,
            3 => Channels::Rgb,
            _ => return Err(unsuitable(format!("{} channels", self.bands), PICTURE)),
        };
        let light = self.values.take_bands(self.bands, 0..colors);
        let alpha = self
            .has_alpha
            .then(|| self.values.take_bands(self.bands, colors..self.bands));
        let (samples, alpha) = match (light, alpha) {
            (SheetValues::F32(light), _) => return linear(self.width, self.height, colors, &light),
            (SheetValues::Wide(_), _) => {
                return Err(unsuitable("integers of another type".to_owned(), PICTURE));
            }
            (SheetValues::U8(light), alpha) => (
                Samples::U8(light),
                alpha.and_then(|alpha| match alpha {
                    SheetValues::U8(alpha) => Some(Samples::U8(alpha)),
                    _ => None,
                }),
            ),
            (SheetValues::U16(light), alpha) => (
                Samples::U16(light),
                alpha.and_then(|alpha| match alpha {
                    SheetValues::U16(alpha) => Some(Samples::U16(alpha)),
                    _ => None,
                }),
            ),
        };
        Raster::new(self.width, self.height, channels, samples, alpha)
            .map(Radiance::Encoded)
            .map_err(|error| DecodeError::Damaged {
                format: "picture",
                reason: error.to_string(),
            })
    }

    /// A picture of codes.
    pub(super) fn into_raster(self) -> Result<Raster, DecodeError> {
        match self.into_radiance()? {
            Radiance::Encoded(raster) => Ok(raster),
            Radiance::Linear(_) => Err(unsuitable(
                "floats".to_owned(),
                "channels of uint8 or uint16 (sRGB codes)",
            )),
        }
    }
}

fn linear(width: usize, height: usize, colors: usize, light: &[f32]) -> Result<Radiance, DecodeError> {
    let [red, green, blue] = [0, 1, 2].map(|band: usize| {
        let band = band.min(colors - 1);
        new_plane(width, height, take_bands(light, colors, band..band + 1))
    });
    Rgb::new([red?, green?, blue?])
        .map(Radiance::Linear)
        .map_err(|error| DecodeError::Damaged {
            format: "picture",
            reason: error.to_string(),
        })
}

/// A plane from a file.
#[derive(Debug, Clone, PartialEq)]
pub enum FilePlane {
    /// Integer codes; the file does not define their unit.
    Codes(Plane<u16>),
    /// Integers beyond 16 bits, of which at least one is negative or above 65535.
    Wide(Plane<i32>),
    /// Floats.
    Floats(Plane<f32>),
}

/// A color picture from a file.
#[derive(Debug, Clone, PartialEq)]
pub enum Radiance {
    /// Integer codes, sRGB by default.
    Encoded(Raster),
    /// Linear light.
    Linear(Rgb<f32>),
}
