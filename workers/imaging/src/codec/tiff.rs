//! TIFF files: the first picture, of gray, color or palette, integers or floats.

use std::borrow::Cow;
use std::io::Cursor;

use ::tiff::decoder::{Decoder, DecodingResult, Limits};
use ::tiff::tags::Tag;
use ::tiff::{ColorType, TiffError};

use super::orientation::find_short;
use super::sheet::{Sheet, SheetValues};
use super::{DecodeError, MAX_DECODER_BYTES, MAX_PIXELS, check_size};

const PHOTOMETRIC_TAG: u16 = 262;
const BLACK_IS_ZERO: u16 = 1;
const PALETTE: u16 = 3;
/// Bytes of the largest picture: four channels of 8 bytes.
const MAX_PICTURE_BYTES: usize = 32 * MAX_PIXELS;

pub(super) fn is_tiff(bytes: &[u8]) -> bool {
    matches!(bytes, [b'I', b'I', 42 | 43, 0, ..] | [b'M', b'M', 0, 42 | 43, ..])
}

fn damaged(reason: impl ToString) -> DecodeError {
    DecodeError::Damaged {
        format: "TIFF",
        reason: reason.to_string(),
    }
}

fn unsuitable(found: impl Into<String>) -> DecodeError {
    DecodeError::Unsuitable {
        found: found.into(),
        wanted: "a TIFF file of gray, color or palette",
    }
}

/// Columns and rows from the header.
pub(super) fn announced_sides(bytes: &[u8]) -> Option<(usize, usize)> {
    let mut decoder = Decoder::new(Cursor::new(bytes)).ok()?;
    let (width, height) = decoder.dimensions().ok()?;
    Some((width as usize, height as usize))
}

pub(super) fn decode(bytes: &[u8]) -> Result<Sheet, DecodeError> {
    let (bytes, has_palette) = with_readable_palette(bytes);
    let limits = {
        let mut limits = Limits::default();
        limits.decoding_buffer_size = MAX_PICTURE_BYTES;
        limits.intermediate_buffer_size = MAX_DECODER_BYTES;
        limits
    };
    let decoder = Decoder::new(Cursor::new(bytes.as_ref())).map_err(damaged)?;
    let mut decoder = decoder.with_limits(limits);
    let (width, height) = decoder.dimensions().map_err(damaged)?;
    let (width, height) = (width as usize, height as usize);
    check_size(width, height)?;
    let color = decoder.colortype().map_err(damaged)?;
    let (bands, has_alpha, bits) = match color {
        ColorType::Gray(bits) => (1, false, bits),
        ColorType::GrayA(bits) => (2, true, bits),
        ColorType::RGB(bits) => (3, false, bits),
        ColorType::RGBA(bits) => (4, true, bits),
        ColorType::Multiband {
            bit_depth,
            num_samples: 2,
        } => (2, true, bit_depth),
        other => return Err(unsuitable(format!("{other:?}"))),
    };
    let planar = decoder.find_tag_unsigned::<u16>(Tag::PlanarConfiguration);
    if bands > 1 && planar.map_err(damaged)? == Some(2) {
        return Err(unsuitable("separate planes of channels"));
    }
    let palette = match has_palette {
        true => Some(read_palette(&mut decoder)?),
        false => None,
    };
    let samples = width * height * bands;
    let image = decoder.read_image().map_err(|error| match error {
        TiffError::UnsupportedError(reason) => unsuitable(format!("{reason}")),
        error => damaged(error),
    })?;
    let values = match (bits, image) {
        (1 | 2 | 4, DecodingResult::U8(packed)) if bands == 1 => {
            SheetValues::U8(unpack_bits(&packed, width, height, bits)?)
        }
        (8 | 16 | 32 | 64, image) => widen(image),
        (bits, _) => return Err(unsuitable(format!("samples of {bits} bits"))),
    };
    let found = match &values {
        SheetValues::U8(values) => values.len(),
        SheetValues::U16(values) => values.len(),
        SheetValues::Wide(values) => values.len(),
        SheetValues::F32(values) => values.len(),
    };
    if found != samples {
        return Err(damaged(format!("it has {found} samples, not {samples}")));
    }
    Ok(Sheet {
        width,
        height,
        bands,
        has_alpha,
        values,
        palette,
    })
}

/// The file, with the indices of a palette declared as gray, which the decoder reads.
fn with_readable_palette(bytes: &[u8]) -> (Cow<'_, [u8]>, bool) {
    match find_short(bytes, PHOTOMETRIC_TAG) {
        Some(found) if found.value == PALETTE => {
            let mut copy = bytes.to_vec();
            let gray = if found.is_big_endian {
                BLACK_IS_ZERO.to_be_bytes()
            } else {
                BLACK_IS_ZERO.to_le_bytes()
            };
            copy[found.position..found.position + 2].copy_from_slice(&gray);
            (Cow::Owned(copy), true)
        }
        _ => (Cow::Borrowed(bytes), false),
    }
}

fn read_palette(decoder: &mut Decoder<Cursor<&[u8]>>) -> Result<Vec<[u8; 3]>, DecodeError> {
    let map = decoder.find_tag_unsigned_vec::<u16>(Tag::ColorMap);
    let map = map
        .map_err(damaged)?
        .ok_or_else(|| damaged("it has no palette"))?;
    let colors = map.len() / 3;
    let shade = |position: usize| (map[position] >> 8) as u8;
    Ok((0..colors)
        .map(|index| [shade(index), shade(colors + index), shade(2 * colors + index)])
        .collect())
}

/// Unpacks samples of fewer than 8 bits, whose rows begin at whole bytes.
pub(super) fn unpack_bits(
    packed: &[u8],
    width: usize,
    height: usize,
    bits: u8,
) -> Result<Vec<u8>, DecodeError> {
    let bits = usize::from(bits);
    let row_bytes = (width * bits).div_ceil(8);
    if packed.len() < row_bytes * height {
        return Err(damaged("rows are missing"));
    }
    let mut samples = Vec::with_capacity(width * height);
    for row in packed.chunks_exact(row_bytes).take(height) {
        for x in 0..width {
            let bit = x * bits;
            samples.push(row[bit / 8] >> (8 - bits - bit % 8) & ((1 << bits) - 1) as u8);
        }
    }
    Ok(samples)
}

fn widen(image: DecodingResult) -> SheetValues {
    fn widened<T: Into<i64>>(values: Vec<T>) -> SheetValues {
        SheetValues::Wide(values.into_iter().map(Into::into).collect())
    }
    match image {
        DecodingResult::U8(values) => SheetValues::U8(values),
        DecodingResult::U16(values) => SheetValues::U16(values),
        DecodingResult::U32(values) => widened(values),
        DecodingResult::U64(values) => SheetValues::Wide(
            values
                .into_iter()
                .map(|value| i64::try_from(value).unwrap_or(i64::MAX))
                .collect(),
        ),
        DecodingResult::I8(values) => widened(values),
        DecodingResult::I16(values) => widened(values),
        DecodingResult::I32(values) => widened(values),
        DecodingResult::I64(values) => SheetValues::Wide(values),
        DecodingResult::F16(values) => {
            SheetValues::F32(values.into_iter().map(|value| value.to_f32()).collect())
        }
        DecodingResult::F32(values) => SheetValues::F32(values),
        DecodingResult::F64(values) => {
            SheetValues::F32(values.into_iter().map(|value| value as f32).collect())
        }
    }
}
