//! The layout of a file as an encoder of this workspace writes it: sides, samples, and every byte accounted for.
//!
//! Only headers and the lengths of chunks are read. A file with a valid layout may still have wrong pixels.

use super::npy::{self, Header};
use super::picture::FileFormat;
use super::sides::read_sides;

const PNG_SIGNATURE_BYTES: usize = 8;
/// Maximum bytes of a PNG's chunks other than its pixels: a few sentences.
const MAX_TEXT_BYTES: usize = 4096;
/// Deflate packs at most this many bytes into one.
const DEFLATE_RATIO: usize = 1032;
/// Bytes that deflate may add to incompressible pixels, besides a 64th of them.
const DEFLATE_OVERHEAD: usize = 4096;

/// Sides and samples of a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FileLayout {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Samples of a pixel.
    pub channels: usize,
    /// Bits of a sample.
    pub bits: usize,
}

/// Reads the layout of a PNG, JPEG, WebP or NPY file without decoding pixels.
///
/// # Errors
/// What is wrong: a truncated file, bytes after its end, or a variant that this workspace never writes.
pub fn read_layout(bytes: &[u8]) -> Result<FileLayout, String> {
    if npy::is_npy(bytes) {
        return read_npy(bytes);
    }
    match FileFormat::detect(bytes) {
        Some(FileFormat::Png) => read_png(bytes),
        Some(FileFormat::Jpeg) => read_jpeg(bytes),
        Some(FileFormat::WebP) => read_webp(bytes),
        _ => Err("it is neither PNG, JPEG, WebP nor NPY".to_owned()),
    }
}

fn read_png(bytes: &[u8]) -> Result<FileLayout, String> {
    let mut chunks = PngChunks {
        rest: bytes.get(PNG_SIGNATURE_BYTES..).unwrap_or_default(),
    };
    let header = chunks.next_chunk()?;
    let (b"IHDR", &[w0, w1, w2, w3, h0, h1, h2, h3, bits, color, 0, 0, 0]) = (header.kind, header.data)
    else {
        return Err("its header is not that of a PNG without interlacing".to_owned());
    };
    let channels = match color {
        0 => 1,
        2 => 3,
        3 => return Err("it has a palette".to_owned()),
        4 => 2,
        6 => 4,
        _ => return Err(format!("its color type is {color}")),
    };
    let layout = FileLayout {
        width: u32::from_be_bytes([w0, w1, w2, w3]) as usize,
        height: u32::from_be_bytes([h0, h1, h2, h3]) as usize,
        channels,
        bits: usize::from(bits),
    };
    let (mut pixels, mut others) = (0_usize, 0_usize);
    loop {
        let chunk = chunks.next_chunk()?;
        match chunk.kind {
            b"IEND" if chunk.data.is_empty() => break,
            b"IDAT" => pixels += chunk.data.len(),
            b"tEXt" | b"gAMA" | b"sRGB" | b"pHYs" => others += chunk.data.len(),
            kind => return Err(format!("it has a chunk `{}`", kind.escape_ascii())),
        }
    }
    if !chunks.rest.is_empty() {
        return Err(format!("{} bytes follow its end", chunks.rest.len()));
    }
    if others > MAX_TEXT_BYTES {
        return Err(format!(
            "it has {others} bytes of text; must be at most {MAX_TEXT_BYTES}"
        ));
    }
    check_pixels(layout, pixels)?;
    Ok(layout)
}

fn describe_truncation() -> String {
    "it is truncated".to_owned()
}

/// Whether deflate can pack the pixels of this layout into this number of bytes.
fn check_pixels(layout: FileLayout, stored: usize) -> Result<(), String> {
    let FileLayout {
        width,
        height,
        channels,
        bits,
    } = layout;
    let row = width.saturating_mul(channels).saturating_mul(bits).div_ceil(8);
    let raw = row.saturating_add(1).saturating_mul(height);
    let least = (raw / DEFLATE_RATIO).max(8);
    let most = raw.saturating_add(raw / 64).saturating_add(DEFLATE_OVERHEAD);
    if (least..=most).contains(&stored) {
        return Ok(());
    }
    Err(format!(
        "it stores {width}×{height} pixels in {stored} bytes; must be {least} to {most}"
    ))
}

struct PngChunk<'a> {
    kind: &'a [u8; 4],
    data: &'a [u8],
}

struct PngChunks<'a> {
    rest: &'a [u8],
}

impl<'a> PngChunks<'a> {
    /// The next chunk: its length, kind, data and checksum, which is not verified.
    fn next_chunk(&mut self) -> Result<PngChunk<'a>, String> {
        let (length, rest) = self
            .rest
            .split_first_chunk::<4>()
            .ok_or_else(describe_truncation)?;
        let (kind, rest) = rest.split_first_chunk::<4>().ok_or_else(describe_truncation)?;
        let length = u32::from_be_bytes(*length) as usize;
        let (data, rest) = rest.split_at_checked(length).ok_or_else(describe_truncation)?;
        let (_, rest) = rest.split_first_chunk::<4>().ok_or_else(describe_truncation)?;
        self.rest = rest;
        Ok(PngChunk { kind, data })
    }
}

/// Walks the segments of a JPEG file. Entropy-coded data ends at the next marker that is not a restart.
fn read_jpeg(bytes: &[u8]) -> Result<FileLayout, String> {
    let mut rest = bytes.get(2..).ok_or_else(describe_truncation)?;
    let mut layout = None;
    loop {
        let (&[first, kind], after) = rest.split_first_chunk::<2>().ok_or_else(describe_truncation)?;
        if first != 0xff {
            return Err("it has bytes between its segments".to_owned());
        }
        if kind == 0xd9 {
            if !after.is_empty() {
                return Err(format!("{} bytes follow its end", after.len()));
            }
            return layout.ok_or_else(|| "it has no picture".to_owned());
        }
        let (length, _) = after.split_first_chunk::<2>().ok_or_else(describe_truncation)?;
        let length = usize::from(u16::from_be_bytes(*length));
        let (segment, after) = after.split_at_checked(length).ok_or_else(describe_truncation)?;
        if let (0xc0..=0xc2, [_, _, bits, h0, h1, w0, w1, channels, ..]) = (kind, segment) {
            layout = Some(FileLayout {
                width: usize::from(u16::from_be_bytes([*w0, *w1])),
                height: usize::from(u16::from_be_bytes([*h0, *h1])),
                channels: usize::from(*channels),
                bits: usize::from(*bits),
            });
        }
        rest = match kind {
            0xda => skip_entropy_coded(after).ok_or_else(describe_truncation)?,
            _ if length < 2 => return Err("a segment of it is shorter than its length".to_owned()),
            _ => after,
        };
    }
}

fn skip_entropy_coded(bytes: &[u8]) -> Option<&[u8]> {
    let end = bytes
        .windows(2)
        .position(|pair| pair[0] == 0xff && !matches!(pair[1], 0 | 0xd0..=0xd7 | 0xff))?;
    bytes.get(end..)
}

fn read_webp(bytes: &[u8]) -> Result<FileLayout, String> {
    let length = bytes.get(4..8).and_then(|length| length.try_into().ok());
    let length = length.map_or(0, u32::from_le_bytes) as usize;
    if bytes.len().checked_sub(8) != Some(length) {
        return Err(format!(
            "it has {} bytes, its header counts {length}",
            bytes.len()
        ));
    }
    let (Some((width, height)), Some(b"VP8L")) = (read_sides(bytes), bytes.get(12..16)) else {
        return Err("it is not a lossless WebP picture".to_owned());
    };
    Ok(FileLayout {
        width,
        height,
        channels: 3,
        bits: 8,
    })
}

fn read_npy(bytes: &[u8]) -> Result<FileLayout, String> {
    let header = Header::read(bytes).map_err(|error| error.to_string())?;
    let [height, width, channels] = header.shape[..] else {
        return Err("its shape is not [height, width, channels]".to_owned());
    };
    if !header.is_float32_by_rows() {
        return Err("it is not little-endian float32 by rows".to_owned());
    }
    let values = [height, width, channels]
        .iter()
        .try_fold(4_usize, |product, &side| product.checked_mul(side));
    if values != Some(header.data_bytes()) {
        return Err(format!(
            "it has {} bytes of values for [{height}, {width}, {channels}]",
            header.data_bytes()
        ));
    }
    Ok(FileLayout {
        width,
        height,
        channels,
        bits: 32,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::codec::{
        encode_jpeg, encode_npy_pair, encode_npy_rgb, encode_png, encode_png_with_text, encode_webp_lossless,
    };
    use crate::{Plane, Rgb, Rgb8};

    fn picture() -> Rgb8 {
        Rgb8::from_fn(37, 25, |x, y| [(x * y) as u8, (x * 31) as u8, (y * 7) as u8])
    }

    fn layout(channels: usize, bits: usize) -> Result<FileLayout, String> {
        Ok(FileLayout {
            width: 37,
            height: 25,
            channels,
            bits,
        })
    }

    fn written() -> Vec<(Vec<u8>, Result<FileLayout, String>)> {
        let texts = [("Software", "Fathom"), ("Unit", "mm")];
        let light = Rgb::from_fn(37, 25, |x, y| [x as f32, y as f32, 0.5]);
        vec![
            (encode_png(&picture().into()).unwrap(), layout(3, 8)),
            (
                encode_png_with_text(&Plane::filled(37, 25, 7_u16).into(), &texts).unwrap(),
                layout(1, 16),
            ),
            (
                encode_png(&Plane::filled(37, 25, 7_u8).into()).unwrap(),
                layout(1, 8),
            ),
            (encode_jpeg(&picture(), 95).unwrap(), layout(3, 8)),
            (encode_webp_lossless(&picture()).unwrap(), layout(3, 8)),
            (encode_npy_rgb(&light), layout(3, 32)),
            (encode_npy_pair(&light, &light), layout(6, 32)),
        ]
    }

    #[test]
    fn files_of_the_encoders_have_a_layout_and_no_truncated_or_extended_one_does() {
        for (bytes, expected) in written() {
            assert_eq!(read_layout(&bytes), expected);
            for end in 0..bytes.len() {
                assert!(read_layout(&bytes[..end]).is_err(), "{expected:?} cut at {end}");
            }
            let mut long = bytes.clone();
            long.extend([0; 3]);
            assert!(read_layout(&long).is_err(), "{expected:?} with more bytes");
        }
    }

    #[test]
    fn pixels_that_do_not_fit_and_hidden_chunks_are_rejected() {
        let png = encode_png(&picture().into()).unwrap();
        let mut wide = png.clone();
        wide[16] = 0x20;
        assert!(read_layout(&wide).unwrap_err().contains("pixels in"));
        let mut hidden = png[..33].to_vec();
        hidden.extend([0, 0, 0, 2]);
        hidden.extend(b"zTXtxx....");
        hidden.extend(&png[33..]);
        assert_eq!(read_layout(&hidden), Err("it has a chunk `zTXt`".to_owned()));
        let text = "x".repeat(MAX_TEXT_BYTES + 1);
        let long = encode_png_with_text(&picture().into(), &[("Comment", &text)]).unwrap();
        assert!(read_layout(&long).unwrap_err().contains("bytes of text"));
    }
}
