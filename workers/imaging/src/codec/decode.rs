//! Decoding of pictures, range files and float radiance.

use super::orientation::Orientation;
use super::picture::FileFormat;
use super::sheet::{FilePlane, Radiance, Sheet};
use super::{DecodeError, npy, openexr};
use crate::{Plane, Raster, Rgb, Samples};

const PICTURE_FORMATS: &[&str] = &["PNG", "JPEG", "WebP", "BMP", "TIFF"];
const RADIANCE_FORMATS: &[&str] = &["PNG", "JPEG", "WebP", "BMP", "TIFF", "NPY", "EXR"];
const PLANE_FORMATS: &[&str] = &["PNG", "BMP", "TIFF", "WebP", "NPY", "EXR"];

/// Decodes a PNG, JPEG, WebP, BMP or TIFF picture: 8 or 16 bit, gray or color, palettes and fewer bits expanded, alpha
/// separate. An animation yields its first picture. The orientation tag is applied; color profiles are not.
///
/// # Errors
/// [`DecodeError`]: unknown format, sides beyond the limits (from the header), damaged or truncated data.
pub fn decode_picture(bytes: &[u8]) -> Result<Raster, DecodeError> {
    decode_or(bytes, PICTURE_FORMATS)
}

/// Decodes a picture. The error for an unknown format lists `expected`.
fn decode_or(bytes: &[u8], expected: &'static [&'static str]) -> Result<Raster, DecodeError> {
    let format = FileFormat::detect(bytes).ok_or(DecodeError::UnknownFormat { expected })?;
    let raster = format.decode(bytes)?;
    Ok(Orientation::read(bytes).turn_raster(raster))
}

/// Decodes distances: gray PNG, BMP, TIFF or lossless WebP yields codes or floats, so do an NPY array of shape [height,
/// width] and the only fitting channel of an EXR file. R = G = B counts as gray. The orientation tag is applied.
///
/// # Errors
/// [`DecodeError`], also for a file with more than one channel of different content.
pub fn decode_plane(bytes: &[u8]) -> Result<FilePlane, DecodeError> {
    let sheet = match openexr::is_exr(bytes) {
        true => openexr::decode_distances(bytes)?,
        false => decode_sheet(bytes)?,
    };
    let orientation = Orientation::read(bytes);
    Ok(match sheet.into_distances()? {
        FilePlane::Codes(codes) => FilePlane::Codes(orientation.turn_plane(codes)),
        FilePlane::Wide(values) => FilePlane::Wide(orientation.turn_plane(values)),
        FilePlane::Floats(values) => FilePlane::Floats(orientation.turn_plane(values)),
    })
}

/// Decodes the object numbers of a mask from the formats of [`decode_plane`]: whole numbers of 0 to 65535 in any type.
/// The index of a palette is the number. The orientation tag is applied.
///
/// # Errors
/// [`DecodeError`], also for other numbers, with the first of them.
pub fn decode_mask(bytes: &[u8]) -> Result<Plane<u16>, DecodeError> {
    let sheet = match openexr::is_exr(bytes) {
        true => openexr::decode_numbers(bytes)?,
        false => decode_sheet(bytes)?,
    };
    Ok(Orientation::read(bytes).turn_plane(sheet.into_mask()?))
}

/// Samples as the file stores them.
fn decode_sheet(bytes: &[u8]) -> Result<Sheet, DecodeError> {
    if npy::is_npy(bytes) {
        return npy::decode_sheet(bytes);
    }
    let format = FileFormat::detect(bytes).ok_or(DecodeError::UnknownFormat {
        expected: PLANE_FORMATS,
    })?;
    format.decode_sheet(bytes)
}

/// Decodes a color picture: PNG, JPEG, WebP, BMP, TIFF and NPY arrays of uint8 or uint16 as codes; arrays and TIFF of
/// floats and the channels R, G and B of an EXR file as linear light. Arrays have the shape [height, width] or [height,
/// width, channels]. The orientation tag is applied.
///
/// # Errors
/// [`DecodeError`]: also for arrays of another shape or type.
pub fn decode_radiance(bytes: &[u8]) -> Result<Radiance, DecodeError> {
    if openexr::is_exr(bytes) {
        return openexr::decode_rgb(bytes).map(Radiance::Linear);
    }
    if npy::is_npy(bytes) {
        return npy::decode_sheet(bytes)?.into_radiance();
    }
    if FileFormat::detect(bytes) != Some(FileFormat::Tiff) {
        return decode_or(bytes, RADIANCE_FORMATS).map(Radiance::Encoded);
    }
    let orientation = Orientation::read(bytes);
    Ok(match FileFormat::Tiff.decode_sheet(bytes)?.into_radiance()? {
        Radiance::Encoded(raster) => Radiance::Encoded(orientation.turn_raster(raster)),
        Radiance::Linear(light) => {
            let planes = light.into_planes().map(|plane| orientation.turn_plane(plane));
            Radiance::Linear(Rgb::new(planes).map_err(|error| DecodeError::Damaged {
                format: "TIFF",
                reason: error.to_string(),
            })?)
        }
    })
}

/// Whether a picture has a pixel that is not opaque.
#[must_use]
pub fn has_transparency(bytes: &[u8]) -> bool {
    if openexr::is_exr(bytes) || FileFormat::detect(bytes) == Some(FileFormat::Jpeg) {
        return false;
    }
    let Ok(Radiance::Encoded(raster)) = decode_radiance(bytes) else {
        return false;
    };
    match raster.alpha() {
        Some(Samples::U8(alpha)) => alpha.iter().any(|&alpha| alpha < u8::MAX),
        Some(Samples::U16(alpha)) => alpha.iter().any(|&alpha| alpha < u16::MAX),
        None => false,
    }
}

/// Whether a picture contains distances next to its colors, as an EXR file with R, G, B and Z.
#[must_use]
pub fn has_distances(bytes: &[u8]) -> bool {
    openexr::is_exr(bytes) && openexr::has_distances(bytes)
}
