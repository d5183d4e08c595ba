//! Decoding of pictures, range files and float radiance.

use std::io::Cursor;

use image::{ColorType, DynamicImage, ImageDecoder, ImageFormat, ImageReader, Limits};

use super::npy::{self, Array};
use super::{DecodeError, MAX_DECODER_BYTES, MAX_SIDE_PX, check_size, jpeg};
use crate::{Channels, Plane, Raster, Rgb, Samples};

const PICTURE_FORMATS: &[&str] = &["PNG", "JPEG", "WebP"];
const RADIANCE_FORMATS: &[&str] = &["PNG", "JPEG", "WebP", "NPY"];
const PLANE_FORMATS: &[&str] = &["PNG", "NPY"];

/// A plane as a file holds it.
#[derive(Debug, Clone, PartialEq)]
pub enum FilePlane {
    /// Integer codes; their unit is not in the file.
    Codes(Plane<u16>),
    /// Floats.
    Floats(Plane<f32>),
}

/// A colour picture as a file holds it.
#[derive(Debug, Clone, PartialEq)]
pub enum Radiance {
    /// Integer codes, sRGB unless said otherwise.
    Encoded(Raster),
    /// Linear light.
    Linear(Rgb<f32>),
}

/// Decodes a PNG, JPEG or WebP picture: 8 or 16 bit, gray or colour, palettes and fewer bits expanded, alpha apart.
/// Of an animation the first picture. Colour profiles and orientation tags are not applied.
///
/// # Errors
/// [`DecodeError`]: unknown format, sides beyond the limits (told from the header alone), damaged data, a file that was
/// cut off.
pub fn decode_picture(bytes: &[u8]) -> Result<Raster, DecodeError> {
    decode_or(bytes, PICTURE_FORMATS)
}

/// Decodes a picture; of bytes in no picture format the error says what else would have done.
fn decode_or(bytes: &[u8], expected: &'static [&'static str]) -> Result<Raster, DecodeError> {
    let format = picture_format(bytes).ok_or(DecodeError::UnknownFormat { expected })?;
    let name = match format {
        ImageFormat::Png => "PNG",
        ImageFormat::Jpeg => "JPEG",
        _ => "WebP",
    };
    let damaged = |error: image::ImageError| DecodeError::Damaged {
        format: name,
        reason: error.to_string(),
    };
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    // Of the sides nothing yet: they are checked below, so that the error tells them.
    let mut limits = Limits::no_limits();
    limits.max_alloc = Some(MAX_DECODER_BYTES);
    reader.limits(limits.clone());
    let mut decoder = reader.into_decoder().map_err(damaged)?;
    let (width, height) = decoder.dimensions();
    check_size(width as usize, height as usize)?;
    if format == ImageFormat::Jpeg && !jpeg::is_whole(bytes) {
        return Err(DecodeError::Damaged {
            format: name,
            reason: "it has no end".to_owned(),
        });
    }
    limits.max_image_width = Some(MAX_SIDE_PX as u32);
    limits.max_image_height = Some(MAX_SIDE_PX as u32);
    limits.max_alloc = Some(MAX_DECODER_BYTES + decoder.total_bytes());
    decoder.set_limits(limits).map_err(damaged)?;
    raster(DynamicImage::from_decoder(decoder).map_err(damaged)?)
}

fn picture_format(bytes: &[u8]) -> Option<ImageFormat> {
    match bytes {
        [0x89, b'P', b'N', b'G', ..] => Some(ImageFormat::Png),
        [0xff, 0xd8, 0xff, ..] => Some(ImageFormat::Jpeg),
        [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => Some(ImageFormat::WebP),
        _ => None,
    }
}

fn raster(picture: DynamicImage) -> Result<Raster, DecodeError> {
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let (channels, samples, alpha) = match picture {
        DynamicImage::ImageLuma8(p) => (Channels::Gray, Samples::U8(p.into_raw()), None),
        DynamicImage::ImageRgb8(p) => (Channels::Rgb, Samples::U8(p.into_raw()), None),
        DynamicImage::ImageLuma16(p) => (Channels::Gray, Samples::U16(p.into_raw()), None),
        DynamicImage::ImageRgb16(p) => (Channels::Rgb, Samples::U16(p.into_raw()), None),
        DynamicImage::ImageLumaA8(p) => apart(Channels::Gray, p.into_raw(), Samples::U8),
        DynamicImage::ImageRgba8(p) => apart(Channels::Rgb, p.into_raw(), Samples::U8),
        DynamicImage::ImageLumaA16(p) => apart(Channels::Gray, p.into_raw(), Samples::U16),
        DynamicImage::ImageRgba16(p) => apart(Channels::Rgb, p.into_raw(), Samples::U16),
        other => {
            return Err(unsuitable(
                other.color(),
                "an 8- or 16-bit gray or colour picture",
            ));
        }
    };
    Raster::new(width, height, channels, samples, alpha).map_err(|error| DecodeError::Damaged {
        format: "picture",
        reason: error.to_string(),
    })
}

fn unsuitable(found: ColorType, wanted: &'static str) -> DecodeError {
    DecodeError::Unsuitable {
        found: format!("{found:?} samples"),
        wanted,
    }
}

/// Splits interleaved samples into colour and alpha.
fn apart<T: Copy>(
    channels: Channels,
    samples: Vec<T>,
    wrap: fn(Vec<T>) -> Samples,
) -> (Channels, Samples, Option<Samples>) {
    let stride = channels.count() + 1;
    let alpha = samples
        .chunks_exact(stride)
        .map(|pixel| pixel[stride - 1])
        .collect();
    let colour = samples
        .chunks_exact(stride)
        .flat_map(|pixel| pixel[..stride - 1].iter().copied())
        .collect();
    (channels, wrap(colour), Some(wrap(alpha)))
}

/// Decodes a range file: an 8- or 16-bit gray PNG gives codes, a two-dimensional NPY array codes or floats.
///
/// # Errors
/// [`DecodeError`]: also when the file is a picture with colour, alpha or fewer bits, or an array of another shape.
pub fn decode_plane(bytes: &[u8]) -> Result<FilePlane, DecodeError> {
    if npy::is_npy(bytes) {
        return array_plane(npy::decode(bytes)?);
    }
    if picture_format(bytes) != Some(ImageFormat::Png) {
        return Err(DecodeError::UnknownFormat {
            expected: PLANE_FORMATS,
        });
    }
    let raster = decode_picture(bytes)?;
    let found = match (raster.channels(), raster.alpha(), png_depth(bytes)) {
        (Channels::Gray, None, Some(8 | 16)) => None,
        // Fewer bits were stretched to 8 on the way, so the codes would no longer be those of the file.
        (Channels::Gray, None, _) => Some("a picture of less than 8 bits"),
        (Channels::Gray, Some(_), _) => Some("a picture with alpha"),
        (Channels::Rgb, ..) => Some("a colour picture"),
    };
    if let Some(found) = found {
        return Err(DecodeError::Unsuitable {
            found: found.to_owned(),
            wanted: "one gray channel of 8 or 16 bits",
        });
    }
    let codes = match raster.samples() {
        Samples::U8(codes) => codes.iter().map(|&code| u16::from(code)).collect(),
        Samples::U16(codes) => codes.clone(),
    };
    Ok(FilePlane::Codes(plane(raster.width(), raster.height(), codes)?))
}

/// Bits of a sample, as the header of a PNG file says.
fn png_depth(bytes: &[u8]) -> Option<u8> {
    const PLACE: usize = 24;
    bytes.get(PLACE).copied()
}

fn array_plane(array: Array) -> Result<FilePlane, DecodeError> {
    let Array {
        width,
        height,
        channels,
        values,
    } = array;
    if let Some(channels) = channels {
        return Err(DecodeError::Unsuitable {
            found: format!("an array of shape [{height}, {width}, {channels}]"),
            wanted: "one of shape [height, width]",
        });
    }
    match values {
        npy::Values::Floats(data) => Ok(FilePlane::Floats(plane(width, height, data)?)),
        npy::Values::Codes(data) => Ok(FilePlane::Codes(plane(width, height, data)?)),
    }
}

/// Decodes a colour picture: PNG, JPEG or WebP as codes, an NPY float array of shape [height, width, 3] as linear
/// light.
///
/// # Errors
/// [`DecodeError`]: also for arrays of another shape or of integers.
pub fn decode_radiance(bytes: &[u8]) -> Result<Radiance, DecodeError> {
    if !npy::is_npy(bytes) {
        let picture = decode_or(bytes, RADIANCE_FORMATS)?;
        return Ok(Radiance::Encoded(picture));
    }
    let Array {
        width,
        height,
        channels,
        values,
    } = npy::decode(bytes)?;
    let unsuitable = |found: String| DecodeError::Unsuitable {
        found,
        wanted: "an array of floats of shape [height, width, 3]",
    };
    let data = match (channels, values) {
        (Some(3), npy::Values::Floats(data)) => data,
        (Some(3), npy::Values::Codes(_)) => return Err(unsuitable("an array of integers".to_owned())),
        (Some(n), _) => return Err(unsuitable(format!("an array of shape [{height}, {width}, {n}]"))),
        (None, _) => return Err(unsuitable(format!("an array of shape [{height}, {width}]"))),
    };
    let band = |c: usize| plane(width, height, data.iter().skip(c).step_by(3).copied().collect());
    Rgb::new([band(0)?, band(1)?, band(2)?])
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
