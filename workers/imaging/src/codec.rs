//! Codecs between bytes and pictures. They open no files.
//!
//! Decoding returns a value or an error for any bytes. Sides, pixels and the decoder's memory are checked against the
//! header before any allocation.

mod bmp;
mod color_profile;
mod decode;
mod encode;
mod jpeg;
mod layout;
mod npy;
mod openexr;
mod orientation;
mod picture;
mod scale;
mod sheet;
mod sides;
mod tiff;

pub use color_profile::find_foreign_profile;
pub use decode::{
    decode_mask, decode_picture, decode_plane, decode_radiance, has_distances, has_transparency,
};
pub use encode::{EncodeError, encode_jpeg, encode_png, encode_png_with_text, encode_webp_lossless};
pub use layout::{FileLayout, read_layout};
pub use npy::{NpyArray, NpyValues, decode_npy, encode_npy_pair, encode_npy_plane, encode_npy_rgb};
pub use orientation::Orientation;
pub use scale::downscale;
pub use sheet::{FilePlane, Radiance};
pub use sides::{announced_pixels, read_sides};

use crate::Plane;

/// Longest side of a picture: larger frames exceed the buffers of a worker slot.
pub const MAX_SIDE_PX: usize = 16_384;
/// Pixel limit of a picture: about twelve planes of f32 at this size fill 3 GiB.
pub const MAX_PIXELS: usize = 64_000_000;
/// Limit on a decoder's memory besides its output.
pub const MAX_DECODER_BYTES: usize = 256 << 20;

/// Bytes that cannot be decoded to a usable picture or plane.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum DecodeError {
    /// The first bytes match no known format.
    #[error("the file is neither {}", expected.join(" nor "))]
    UnknownFormat {
        /// The accepted formats.
        expected: &'static [&'static str],
    },
    /// A side of the picture is 0.
    #[error("the picture is empty: {width}×{height}")]
    Empty {
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// The size in the header exceeds the limits.
    #[error(
        "the picture is {width}×{height} but at most {MAX_SIDE_PX} pixels a side and {MAX_PIXELS} pixels are taken"
    )]
    TooLarge {
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
    },
    /// The bytes are truncated or damaged.
    #[error("the {format} file is damaged or cut off: {reason}")]
    Damaged {
        /// The format detected from the first bytes.
        format: &'static str,
        /// The decoder's message.
        reason: String,
    },
    /// The file is intact but has the wrong content.
    #[error("the file holds {found} but {wanted} is needed")]
    Unsuitable {
        /// Its content.
        found: String,
        /// The required content.
        wanted: &'static str,
    },
}

/// Checks header sides against the limits.
fn check_size(width: usize, height: usize) -> Result<(), DecodeError> {
    if width == 0 || height == 0 {
        return Err(DecodeError::Empty { width, height });
    }
    if width > MAX_SIDE_PX || height > MAX_SIDE_PX || width.saturating_mul(height) > MAX_PIXELS {
        return Err(DecodeError::TooLarge { width, height });
    }
    Ok(())
}

fn new_plane<T>(width: usize, height: usize, data: Vec<T>) -> Result<Plane<T>, DecodeError> {
    Plane::new(width, height, data).map_err(|error| DecodeError::Damaged {
        format: "picture",
        reason: error.to_string(),
    })
}
