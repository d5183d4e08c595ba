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

/// Columns and rows from the header.
pub(super) fn announced_sides(bytes: &[u8]) -> Option<(usize, usize)> {
    let field = |position: usize| {
        let field: [u8; 4] = bytes.get(position..position + 4)?.try_into().ok()?;
        Some(i32::from_le_bytes(field).unsigned_abs() as usize)
    };
    /// Length of the header of OS/2, with shorter fields.
    const CORE_BYTES: usize = 12;
    if field(14)? == CORE_BYTES {
        return Some((field(18)? & 0xffff, field(20)? & 0xffff));
    }
    Some((field(18)?, field(22)?))
}

pub(super) fn decode(bytes: &[u8]) -> Result<Sheet, DecodeError> {
    let (width, height) = announced_sides(bytes).ok_or_else(|| damaged("it has no header"))?;
    check_size(width, height)?;
    let mut decoder = BmpDecoder::new(BufReader::new(Cursor::new(bytes))).map_err(damaged)?;
    let palette = decoder.get_palette().map(<[[u8; 3]]>::to_vec);
    decoder.set_indexed_color(palette.is_some());
    let (width, height) = decoder.dimensions();
    let (width, height) = (width as usize, height as usize);
    check_size(width, height)?;
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
