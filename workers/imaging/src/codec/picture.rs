//! The decoders of picture files within the limits.

use std::io::Cursor;

use zune_core::bytestream::ZCursor;
use zune_core::colorspace::ColorSpace;
use zune_core::options::DecoderOptions;

use super::sheet::{Sheet, SheetValues};
use super::{DecodeError, MAX_DECODER_BYTES, bmp, check_size, jpeg, tiff};
use crate::{Channels, Raster, Samples};

/// Picture formats, detected by their first bytes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FileFormat {
    Png,
    Jpeg,
    WebP,
    Bmp,
    Tiff,
}

/// Decoded pixels, alpha last.
struct DecodedPixels {
    width: usize,
    height: usize,
    channels: Channels,
    has_alpha: bool,
    samples: Samples,
}

impl FileFormat {
    pub(super) fn detect(bytes: &[u8]) -> Option<Self> {
        match bytes {
            [0x89, b'P', b'N', b'G', ..] => Some(Self::Png),
            [0xff, 0xd8, 0xff, ..] => Some(Self::Jpeg),
            [b'R', b'I', b'F', b'F', _, _, _, _, b'W', b'E', b'B', b'P', ..] => Some(Self::WebP),
            _ if bmp::is_bmp(bytes) => Some(Self::Bmp),
            _ if tiff::is_tiff(bytes) => Some(Self::Tiff),
            _ => None,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Png => "PNG",
            Self::Jpeg => "JPEG",
            Self::WebP => "WebP",
            Self::Bmp => "BMP",
            Self::Tiff => "TIFF",
        }
    }

    fn damaged(self, reason: impl ToString) -> DecodeError {
        DecodeError::Damaged {
            format: self.name(),
            reason: reason.to_string(),
        }
    }

    pub(super) fn decode(self, bytes: &[u8]) -> Result<Raster, DecodeError> {
        let pixels = match self {
            Self::Png => decode_png(bytes),
            Self::Jpeg => decode_jpeg(bytes),
            Self::WebP => decode_webp(bytes),
            Self::Bmp => return bmp::decode(bytes)?.into_raster(),
            Self::Tiff => return tiff::decode(bytes)?.into_raster(),
        }?;
        pixels.into_raster().map_err(|error| self.damaged(error))
    }

    /// Decodes a file without loss to the samples that it stores: indices of a palette, fewer than 8 bits.
    pub(super) fn decode_sheet(self, bytes: &[u8]) -> Result<Sheet, DecodeError> {
        match self {
            Self::Png => decode_png_sheet(bytes),
            Self::WebP => decode_webp_sheet(bytes),
            Self::Bmp => bmp::decode(bytes),
            Self::Tiff => tiff::decode(bytes),
            Self::Jpeg => Err(lossy("JPEG")),
        }
    }
}

fn new_png_decoder(bytes: &[u8]) -> png::Decoder<Cursor<&[u8]>> {
    let limits = png::Limits {
        bytes: MAX_DECODER_BYTES,
    };
    let mut decoder = png::Decoder::new_with_limits(Cursor::new(bytes), limits);
    // Profiles and texts are not used, and may unpack to hundreds of megabytes.
    decoder.set_ignore_iccp_chunk(true);
    decoder.set_ignore_text_chunk(true);
    decoder
}

fn decode_png(bytes: &[u8]) -> Result<DecodedPixels, DecodeError> {
    use png::{BitDepth, ColorType};
    let damaged = |error: png::DecodingError| FileFormat::Png.damaged(error);
    let mut decoder = new_png_decoder(bytes);
    decoder.set_transformations(png::Transformations::EXPAND);
    let header = decoder.read_header_info().map_err(damaged)?;
    let (width, height) = (header.width as usize, header.height as usize);
    check_size(width, height)?;
    let mut reader = decoder.read_info().map_err(damaged)?;
    let (color, depth) = reader.output_color_type();
    let mut data = vec![0; reader.output_buffer_size().unwrap_or(0)];
    reader.next_frame(&mut data).map_err(damaged)?;
    let (channels, has_alpha) = match color {
        ColorType::Grayscale => (Channels::Gray, false),
        ColorType::GrayscaleAlpha => (Channels::Gray, true),
        ColorType::Rgb => (Channels::Rgb, false),
        ColorType::Rgba => (Channels::Rgb, true),
        ColorType::Indexed => return Err(FileFormat::Png.damaged("it has no palette")),
    };
    let samples = match depth {
        BitDepth::Sixteen => {
            let codes = data.as_chunks::<2>().0;
            Samples::U16(codes.iter().copied().map(u16::from_be_bytes).collect())
        }
        _ => Samples::U8(data),
    };
    Ok(DecodedPixels {
        width,
        height,
        channels,
        has_alpha,
        samples,
    })
}

fn lossy(format: &str) -> DecodeError {
    DecodeError::Unsuitable {
        found: format!("a {format} picture, whose compression changes numbers,"),
        wanted: "a lossless file such as PNG, TIFF or NPY",
    }
}

fn decode_png_sheet(bytes: &[u8]) -> Result<Sheet, DecodeError> {
    use png::{BitDepth, ColorType};
    let damaged = |error: png::DecodingError| FileFormat::Png.damaged(error);
    let mut decoder = new_png_decoder(bytes);
    decoder.set_transformations(png::Transformations::IDENTITY);
    let header = decoder.read_header_info().map_err(damaged)?;
    let (width, height) = (header.width as usize, header.height as usize);
    check_size(width, height)?;
    let mut reader = decoder.read_info().map_err(damaged)?;
    let (color, depth) = reader.output_color_type();
    let mut data = vec![0; reader.output_buffer_size().unwrap_or(0)];
    reader.next_frame(&mut data).map_err(damaged)?;
    let palette = reader.info().palette.as_ref();
    let palette = palette.filter(|_| color == ColorType::Indexed);
    let palette = palette.map(|colors| colors.as_chunks::<3>().0.to_vec());
    let values = match depth {
        BitDepth::Sixteen => {
            let codes = data.as_chunks::<2>().0;
            SheetValues::U16(codes.iter().copied().map(u16::from_be_bytes).collect())
        }
        BitDepth::Eight => SheetValues::U8(data),
        narrow => SheetValues::U8(tiff::unpack_bits(&data, width, height, narrow as u8)?),
    };
    Ok(Sheet {
        width,
        height,
        bands: color.samples(),
        has_alpha: matches!(color, ColorType::GrayscaleAlpha | ColorType::Rgba),
        values,
        palette,
    })
}

fn decode_webp_sheet(bytes: &[u8]) -> Result<Sheet, DecodeError> {
    let decoder = image_webp::WebPDecoder::new(Cursor::new(bytes));
    if decoder.is_ok_and(|mut decoder| decoder.is_lossy()) {
        return Err(lossy("lossy WebP"));
    }
    let pixels = decode_webp(bytes)?;
    let Samples::U8(values) = pixels.samples else {
        return Err(FileFormat::WebP.damaged("it has no codes of 8 bits"));
    };
    Ok(Sheet {
        width: pixels.width,
        height: pixels.height,
        bands: pixels.channels.count() + usize::from(pixels.has_alpha),
        has_alpha: pixels.has_alpha,
        values: SheetValues::U8(values),
        palette: None,
    })
}

fn decode_jpeg(bytes: &[u8]) -> Result<DecodedPixels, DecodeError> {
    let damaged = |error: zune_jpeg::errors::DecodeErrors| FileFormat::Jpeg.damaged(error);
    // Sides are checked below instead, so that the error reports them.
    let options = DecoderOptions::default()
        .set_strict_mode(false)
        .set_max_width(usize::MAX)
        .set_max_height(usize::MAX);
    let mut decoder = zune_jpeg::JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().map_err(damaged)?;
    let (width, height) = decoder.dimensions().unwrap_or_default();
    check_size(width, height)?;
    if !jpeg::is_whole(bytes) {
        return Err(FileFormat::Jpeg.damaged("it has no end"));
    }
    let (channels, color) = match decoder.input_colorspace() {
        Some(ColorSpace::Luma) => (Channels::Gray, ColorSpace::Luma),
        _ => (Channels::Rgb, ColorSpace::RGB),
    };
    decoder.set_options(options.jpeg_set_out_colorspace(color));
    let data = decoder.decode().map_err(damaged)?;
    Ok(DecodedPixels {
        width,
        height,
        channels,
        has_alpha: false,
        samples: Samples::U8(data),
    })
}

fn decode_webp(bytes: &[u8]) -> Result<DecodedPixels, DecodeError> {
    let damaged = |error: image_webp::DecodingError| FileFormat::WebP.damaged(error);
    let mut decoder = image_webp::WebPDecoder::new(Cursor::new(bytes)).map_err(damaged)?;
    let (width, height) = decoder.dimensions();
    let (width, height) = (width as usize, height as usize);
    check_size(width, height)?;
    let mut data = vec![0; decoder.output_buffer_size().unwrap_or(0)];
    decoder.read_image(&mut data).map_err(damaged)?;
    Ok(DecodedPixels {
        width,
        height,
        channels: Channels::Rgb,
        has_alpha: decoder.has_alpha(),
        samples: Samples::U8(data),
    })
}

impl DecodedPixels {
    fn into_raster(self) -> Result<Raster, crate::SizeError> {
        let (samples, alpha) = match (self.has_alpha, self.samples) {
            (false, samples) => (samples, None),
            (true, Samples::U8(codes)) => split_alpha(self.channels, &codes, Samples::U8),
            (true, Samples::U16(codes)) => split_alpha(self.channels, &codes, Samples::U16),
        };
        Raster::new(self.width, self.height, self.channels, samples, alpha)
    }
}

fn split_alpha<T: Copy>(
    channels: Channels,
    samples: &[T],
    wrap: fn(Vec<T>) -> Samples,
) -> (Samples, Option<Samples>) {
    let pixels = samples.chunks_exact(channels.count() + 1);
    let alpha = pixels.clone().map(|pixel| pixel[channels.count()]).collect();
    let color = pixels
        .flat_map(|pixel| pixel[..channels.count()].iter().copied())
        .collect();
    (wrap(color), Some(wrap(alpha)))
}
