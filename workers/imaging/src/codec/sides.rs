//! Sides of a picture or an array from the header of its file.

use std::io::Cursor;

use zune_core::bytestream::ZCursor;

use super::bmp;
use super::npy::{self, Header};
use super::openexr;
use super::picture::FileFormat;
use super::tiff;

/// Columns and rows from the header of a PNG, JPEG, WebP, BMP, TIFF or NPY file, the latter of shape [height, width] or [height,
/// width, channels]; `None` for other bytes. Nothing is decoded, the sides may exceed the limits, and
/// the orientation tag is not applied.
#[must_use]
pub fn read_sides(bytes: &[u8]) -> Option<(usize, usize)> {
    if npy::is_npy(bytes) {
        return match Header::read(bytes).ok()?.shape[..] {
            [height, width] | [height, width, _] => Some((width, height)),
            _ => None,
        };
    }
    match FileFormat::detect(bytes)? {
        FileFormat::Png => {
            let mut decoder = png::Decoder::new(Cursor::new(bytes));
            let header = decoder.read_header_info().ok()?;
            Some((header.width as usize, header.height as usize))
        }
        FileFormat::Jpeg => {
            let mut decoder = zune_jpeg::JpegDecoder::new(ZCursor::new(bytes));
            decoder.decode_headers().ok()?;
            decoder.dimensions()
        }
        FileFormat::WebP => {
            let decoder = image_webp::WebPDecoder::new(Cursor::new(bytes)).ok()?;
            let (width, height) = decoder.dimensions();
            Some((width as usize, height as usize))
        }
        FileFormat::Bmp => bmp::announced_sides(bytes),
        FileFormat::Tiff => tiff::announced_sides(bytes),
    }
}

/// Number of pixels from the header of any decodable file; 0 for other bytes. The header may be wrong.
#[must_use]
pub fn announced_pixels(bytes: &[u8]) -> usize {
    let sides = read_sides(bytes).or_else(|| openexr::announced_sides(bytes));
    sides.map_or(0, |(width, height)| width.saturating_mul(height))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::codec::{encode_jpeg, encode_npy_plane, encode_npy_rgb, encode_png, encode_webp_lossless};
    use crate::{Plane, Rgb, Rgb8};

    #[test]
    fn the_sides_of_every_format_are_in_its_header() {
        let picture = Rgb8::from_fn(7, 5, |x, _| [x as u8; 3]);
        for bytes in [
            encode_png(&picture.clone().into()).unwrap(),
            encode_jpeg(&picture, 90).unwrap(),
            encode_webp_lossless(&picture).unwrap(),
            encode_npy_plane(&Plane::filled(7, 5, 0.5f32)),
            encode_npy_rgb(&Rgb::from_fn(7, 5, |_, _| [0.5f32; 3])),
        ] {
            assert_eq!(read_sides(&bytes), Some((7, 5)));
            for end in 0..bytes.len().min(12) {
                assert_eq!(read_sides(&bytes[..end]), None, "{end}");
            }
        }
        assert_eq!(read_sides(b"{}"), None);
        assert_eq!(announced_pixels(b"{}"), 0);
    }
}
