//! BMP files, with the indices of a palette.

use std::io::{BufReader, Cursor};

use ::image::ImageDecoder;
use ::image::codecs::bmp::BmpDecoder;

use super::sheet::{Sheet, SheetValues};
use super::{DecodeError, check_size};

pub(super) fn is_bmp(bytes: &[u8]) -> bool {
    bytes.starts_with(b"BM")
}

fn damaged(reason: impl ToString) -> DecodeError {
    DecodeError::Damaged {
        format: "BMP",
        reason: reason.to_string(),
    }
}

/// Length of the header of OS/2, with shorter fields.
const CORE_BYTES: usize = 12;

fn number_at(bytes: &[u8], position: usize) -> Option<u32> {
    let field: [u8; 4] = bytes.get(position..position + 4)?.try_into().ok()?;
    Some(u32::from_le_bytes(field))
}

/// Columns and rows from the header.
pub(super) fn announced_sides(bytes: &[u8]) -> Option<(usize, usize)> {
    let field =
        |position: usize| number_at(bytes, position).map(|side| (side as i32).unsigned_abs() as usize);
    if field(14)? == CORE_BYTES {
        return Some((field(18)? & 0xffff, field(20)? & 0xffff));
    }
    Some((field(18)?, field(22)?))
}

fn bits_of_pixel(bytes: &[u8]) -> Option<u16> {
    let is_core = number_at(bytes, 14)? as usize == CORE_BYTES;
    let position = if is_core { 24 } else { 28 };
    Some(u16::from_le_bytes(
        bytes.get(position..position + 2)?.try_into().ok()?,
    ))
}

/// Rows of uncompressed indices of less than a byte.
struct Packed {
    bits: usize,
    begin: usize,
    /// Whether the first row is the top one.
    is_downward: bool,
}

impl Packed {
    /// Of a file that has such indices.
    fn read(bytes: &[u8]) -> Option<Self> {
        let is_core = number_at(bytes, 14)? as usize == CORE_BYTES;
        let is_plain = is_core || number_at(bytes, 30)? == 0;
        let bits = usize::from(bits_of_pixel(bytes)?);
        (is_plain && matches!(bits, 1 | 2 | 4)).then_some(Self {
            bits,
            begin: number_at(bytes, 10)? as usize,
            is_downward: !is_core && (number_at(bytes, 22)? as i32) < 0,
        })
    }

    /// The index of each pixel, row by row from the top.
    fn unpack(&self, bytes: &[u8], width: usize, height: usize) -> Result<Vec<u8>, DecodeError> {
        let stride = (width * self.bits).div_ceil(32) * 4;
        let rows = bytes
            .get(self.begin..)
            .filter(|rows| rows.len() >= stride * height)
            .ok_or_else(|| damaged("its rows are cut off"))?;
        let mut indices = Vec::with_capacity(width * height);
        for y in 0..height {
            let row = if self.is_downward { y } else { height - 1 - y };
            let row = &rows[row * stride..][..stride];
            indices.extend((0..width).map(|x| {
                let bit = x * self.bits;
                let shift = 8 - self.bits - bit % 8;
                row[bit / 8] >> shift & ((1 << self.bits) - 1)
            }));
        }
        Ok(indices)
    }
}

pub(super) fn decode(bytes: &[u8]) -> Result<Sheet, DecodeError> {
    let (width, height) = announced_sides(bytes).ok_or_else(|| damaged("it has no header"))?;
    check_size(width, height)?;
    let mut decoder = BmpDecoder::new(BufReader::new(Cursor::new(bytes))).map_err(damaged)?;
    let mut palette = decoder.get_palette().map(<[[u8; 3]]>::to_vec);
    let (width, height) = decoder.dimensions();
    let (width, height) = (width as usize, height as usize);
    check_size(width, height)?;
    match (Packed::read(bytes), &palette) {
        (Some(packed), Some(_)) => {
            let data = packed.unpack(bytes, width, height)?;
            return Ok(Sheet {
                width,
                height,
                bands: 1,
                has_alpha: false,
                values: SheetValues::U8(data),
                palette,
            });
        }
        // The decoder returns indices of 8 bits, and colors for compressed shorter indices.
        _ if bits_of_pixel(bytes) == Some(8) => decoder.set_indexed_color(palette.is_some()),
        _ => palette = None,
    }
    let bands = usize::from(decoder.color_type().channel_count());
    let mut data = vec![0; width * height * bands];
    decoder.read_image(&mut data).map_err(damaged)?;
    Ok(Sheet {
        width,
        height,
        bands,
        has_alpha: bands == 4,
        values: SheetValues::U8(data),
        palette,
    })
}
