//! Decoding of pictures, range files and float radiance.

use super::DecodeError;
use super::npy::{self, NpyArray, NpyValues};
use super::openexr;
use super::picture::FileFormat;
use crate::{Channels, Plane, Raster, Rgb, Samples};

const PICTURE_FORMATS: &[&str] = &["PNG", "JPEG", "WebP"];
const RADIANCE_FORMATS: &[&str] = &["PNG", "JPEG", "WebP", "NPY", "EXR"];
const PLANE_FORMATS: &[&str] = &["PNG", "NPY", "EXR"];

/// A plane from a file.
#[derive(Debug, Clone, PartialEq)]
pub enum FilePlane {
    /// Integer codes; the file does not define their unit.
    Codes(Plane<u16>),
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

/// Decodes a PNG, JPEG or WebP picture: 8 or 16 bit, gray or color, palettes and fewer bits expanded, alpha separate.
/// An animation yields its first picture. Color profiles and orientation tags are not applied.
///
/// # Errors
/// [`DecodeError`]: unknown format, sides beyond the limits (from the header), damaged or truncated data.
pub fn decode_picture(bytes: &[u8]) -> Result<Raster, DecodeError> {
    decode_or(bytes, PICTURE_FORMATS)
}

/// Decodes a picture. The error for an unknown format lists `expected`.
fn decode_or(bytes: &[u8], expected: &'static [&'static str]) -> Result<Raster, DecodeError> {
    let format = FileFormat::detect(bytes).ok_or(DecodeError::UnknownFormat { expected })?;
    format.decode(bytes)
}

/// Decodes a range file: an 8- or 16-bit gray PNG yields codes, a two-dimensional NPY array codes or floats, an EXR
/// file the floats of its channel Z.
///
/// # Errors
/// [`DecodeError`], also for a picture with color, alpha or fewer bits, or an array of another shape.
pub fn decode_plane(bytes: &[u8]) -> Result<FilePlane, DecodeError> {
    if npy::is_npy(bytes) {
        return array_plane(npy::decode_sheet(bytes)?);
    }
    if openexr::is_exr(bytes) {
        return openexr::decode_distances(bytes).map(FilePlane::Floats);
    }
    if FileFormat::detect(bytes) != Some(FileFormat::Png) {
        return Err(DecodeError::UnknownFormat {
            expected: PLANE_FORMATS,
        });
    }
    let raster = decode_picture(bytes)?;
    let found = match (raster.channels(), raster.alpha(), png_depth(bytes)) {
        (Channels::Gray, None, Some(8 | 16)) => None,
        // Fewer bits were expanded to 8, so the codes would differ from those of the file.
        (Channels::Gray, None, _) => Some("a picture of less than 8 bits"),
        (Channels::Gray, Some(_), _) => Some("a picture with alpha"),
        (Channels::Rgb, ..) => Some("a color picture"),
    };
    if let Some(found) = found {
        return Err(DecodeError::Unsuitable {
            found: found.to_owned(),
            wanted: "one gray channel of 8 or 16 bits",
        });
    }
    let codes = match raster.samples() {
        Samples::U8(codes) => widened(codes),
        Samples::U16(codes) => codes.clone(),
    };
    Ok(FilePlane::Codes(plane(raster.width(), raster.height(), codes)?))
}

/// Bits per sample in the header of a PNG file.
fn png_depth(bytes: &[u8]) -> Option<u8> {
    const PLACE: usize = 24;
    bytes.get(PLACE).copied()
}

fn array_plane(array: NpyArray) -> Result<FilePlane, DecodeError> {
    let [height, width] = array.shape[..] else {
        return Err(DecodeError::Unsuitable {
            found: format!("an array of shape {:?}", array.shape),
            wanted: "one of shape [height, width]",
        });
    };
    Ok(match array.values {
        NpyValues::F32(data) => FilePlane::Floats(plane(width, height, data)?),
        NpyValues::F64(data) => FilePlane::Floats(plane(width, height, narrowed(&data))?),
        NpyValues::U8(data) => FilePlane::Codes(plane(width, height, widened(&data))?),
        NpyValues::U16(data) => FilePlane::Codes(plane(width, height, data)?),
    })
}

fn narrowed(values: &[f64]) -> Vec<f32> {
    values.iter().map(|&value| value as f32).collect()
}

fn widened(codes: &[u8]) -> Vec<u16> {
    codes.iter().copied().map(u16::from).collect()
}

/// Decodes a color picture: PNG, JPEG or WebP as codes; an NPY float array of shape [height, width, 3] and the channels
/// R, G and B of an EXR file as linear light.
///
/// # Errors
/// [`DecodeError`]: also for arrays of another shape or of integers.
pub fn decode_radiance(bytes: &[u8]) -> Result<Radiance, DecodeError> {
    if openexr::is_exr(bytes) {
        return openexr::decode_rgb(bytes).map(Radiance::Linear);
    }
    if !npy::is_npy(bytes) {
        let picture = decode_or(bytes, RADIANCE_FORMATS)?;
        return Ok(Radiance::Encoded(picture));
    }
    let NpyArray { shape, values } = npy::decode_sheet(bytes)?;
    let unsuitable = |found: String| DecodeError::Unsuitable {
        found,
        wanted: "an array of floats of shape [height, width, 3]",
    };
    let data = match (&shape[..], values) {
        ([_, _, 3], NpyValues::F32(data)) => data,
        ([_, _, 3], NpyValues::F64(data)) => narrowed(&data),
        ([_, _, 3], NpyValues::U8(_) | NpyValues::U16(_)) => {
            return Err(unsuitable("an array of integers".to_owned()));
        }
        _ => return Err(unsuitable(format!("an array of shape {shape:?}"))),
    };
    let [red, green, blue] = [0, 1, 2].map(|band| {
        plane(
            shape[1],
            shape[0],
            data.iter().skip(band).step_by(3).copied().collect(),
        )
    });
    Rgb::new([red?, green?, blue?])
        .map(Radiance::Linear)
        .map_err(|error| DecodeError::Damaged {
            format: "NPY",
            reason: error.to_string(),
        })
}

fn plane<T>(width: usize, height: usize, data: Vec<T>) -> Result<Plane<T>, DecodeError> {
    Plane::new(width, height, data).map_err(|error| DecodeError::Damaged {
        format: "picture",
        reason: error.to_string(),
    })
}
