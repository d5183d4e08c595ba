//! Encoding of pictures.

use std::io::Cursor;

use image::codecs::jpeg::JpegEncoder;
use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::codecs::webp::WebPEncoder;
use image::{ExtendedColorType, ImageEncoder};

use crate::{Channels, Raster, Rgb8, Samples};

/// A picture that a format cannot hold.
#[derive(Debug, thiserror::Error)]
#[error("a picture of {width}×{height} cannot be written as {format}: {reason}")]
pub struct EncodeError {
    width: usize,
    height: usize,
    format: &'static str,
    reason: String,
}

fn failure(width: usize, height: usize, format: &'static str) -> impl Fn(image::ImageError) -> EncodeError {
    move |error| EncodeError {
        width,
        height,
        format,
        reason: error.to_string(),
    }
}

/// A PNG file: 8 or 16 bit, gray or colour, with alpha if the raster has it. Fast deflate with the `Up` filter:
/// several times quicker than choosing a filter for each row, for files a few hundredths larger.
///
/// # Errors
/// [`EncodeError`] when the picture is empty.
pub fn encode_png(raster: &Raster) -> Result<Vec<u8>, EncodeError> {
    let (width, height) = (raster.width(), raster.height());
    let with_alpha = raster.alpha().is_some();
    let (bytes, color) = match (raster.samples(), raster.alpha()) {
        (Samples::U8(codes), None) => (codes.clone(), true),
        (Samples::U8(codes), Some(alpha)) => (woven(codes, &alpha.to_u8(), raster.channels()), true),
        (Samples::U16(codes), None) => (native(codes), false),
        (Samples::U16(codes), Some(alpha)) => (native(&woven(codes, &wide(alpha), raster.channels())), false),
    };
    let color = match (raster.channels(), with_alpha, color) {
        (Channels::Gray, false, true) => ExtendedColorType::L8,
        (Channels::Gray, true, true) => ExtendedColorType::La8,
        (Channels::Rgb, false, true) => ExtendedColorType::Rgb8,
        (Channels::Rgb, true, true) => ExtendedColorType::Rgba8,
        (Channels::Gray, false, false) => ExtendedColorType::L16,
        (Channels::Gray, true, false) => ExtendedColorType::La16,
        (Channels::Rgb, false, false) => ExtendedColorType::Rgb16,
        (Channels::Rgb, true, false) => ExtendedColorType::Rgba16,
    };
    let mut file = Vec::with_capacity(bytes.len() / 2 + 1024);
    PngEncoder::new_with_quality(&mut file, CompressionType::Fast, FilterType::Up)
        .write_image(&bytes, width as u32, height as u32, color)
        .map_err(failure(width, height, "PNG"))?;
    Ok(file)
}

/// Colour and alpha interleaved again.
fn woven<T: Copy>(colour: &[T], alpha: &[T], channels: Channels) -> Vec<T> {
    let pixels = colour.chunks_exact(channels.count()).zip(alpha);
    pixels
        .flat_map(|(pixel, alpha)| pixel.iter().copied().chain([*alpha]))
        .collect()
}

fn wide(alpha: &Samples) -> Vec<u16> {
    match alpha {
        Samples::U8(codes) => codes.iter().map(|&code| u16::from(code) * 257).collect(),
        Samples::U16(codes) => codes.clone(),
    }
}

/// The encoder takes 16-bit samples as bytes in the machine's own order.
fn native(codes: &[u16]) -> Vec<u8> {
    codes.iter().flat_map(|code| code.to_ne_bytes()).collect()
}

/// A lossless WebP file.
///
/// # Errors
/// [`EncodeError`] when the picture is empty or a side exceeds 16384.
pub fn encode_webp_lossless(picture: &Rgb8) -> Result<Vec<u8>, EncodeError> {
    let (width, height) = (picture.width(), picture.height());
    let mut file = Cursor::new(Vec::new());
    WebPEncoder::new_lossless(&mut file)
        .write_image(
            picture.data(),
            width as u32,
            height as u32,
            ExtendedColorType::Rgb8,
        )
        .map_err(failure(width, height, "WebP"))?;
    Ok(file.into_inner())
}

/// A JPEG file of quality 1..=100.
///
/// # Errors
/// [`EncodeError`] when the picture is empty.
pub fn encode_jpeg(picture: &Rgb8, quality: u8) -> Result<Vec<u8>, EncodeError> {
    let (width, height) = (picture.width(), picture.height());
    let mut file = Vec::new();
    JpegEncoder::new_with_quality(&mut file, quality.clamp(1, 100))
        .write_image(
            picture.data(),
            width as u32,
            height as u32,
            ExtendedColorType::Rgb8,
        )
        .map_err(failure(width, height, "JPEG"))?;
    Ok(file)
}
