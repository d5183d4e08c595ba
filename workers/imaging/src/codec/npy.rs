//! NumPy's array files (NPY 1.0 to 3.0) of two or three dimensions, C order.

use npyz::{DType, NpyFile, NpyHeader, Order, TypeChar};

use super::{DecodeError, check_size};
use crate::{Plane, Rgb};

/// An array as it stands in the file.
pub(super) struct Array {
    pub(super) width: usize,
    pub(super) height: usize,
    /// Length of the third dimension, if there is one.
    pub(super) channels: Option<usize>,
    pub(super) values: Values,
}

/// Values of an array.
pub(super) enum Values {
    Floats(Vec<f32>),
    Codes(Vec<u16>),
}

const MAGIC: &[u8] = b"\x93NUMPY";
/// Longest header: NumPy writes 128 bytes for the arrays that are taken here.
const MAX_HEADER_BYTES: usize = 64 << 10;

pub(super) fn is_npy(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

fn damaged(reason: impl ToString) -> DecodeError {
    DecodeError::Damaged {
        format: "NPY",
        reason: reason.to_string(),
    }
}

/// Decodes an array of f32, f64, u8 or u16.
pub(super) fn decode(bytes: &[u8]) -> Result<Array, DecodeError> {
    let header_bytes = match bytes {
        [_, _, _, _, _, _, 1, _, low, high, ..] => usize::from(u16::from_le_bytes([*low, *high])),
        [_, _, _, _, _, _, 2 | 3, _, a, b, c, d, ..] => u32::from_le_bytes([*a, *b, *c, *d]) as usize,
        _ => return Err(damaged("no header")),
    };
    if header_bytes > MAX_HEADER_BYTES {
        return Err(damaged(format!(
            "a header of {header_bytes} bytes, at most {MAX_HEADER_BYTES} are read"
        )));
    }
    let header = NpyHeader::from_reader(bytes).map_err(damaged)?;
    let (height, width, channels) = match *header.shape() {
        [height, width] => (height, width, None),
        [height, width, channels @ 1..=4] => (height, width, Some(channels as usize)),
        _ => {
            let found = format!("an array of shape {:?}", header.shape());
            return Err(DecodeError::Unsuitable {
                found,
                wanted: "shape [height, width] or [height, width, 3]",
            });
        }
    };
    let side = |length: u64| usize::try_from(length).unwrap_or(usize::MAX);
    let (width, height) = (side(width), side(height));
    check_size(width, height)?;
    if header.order() != Order::C {
        return Err(DecodeError::Unsuitable {
            found: "a Fortran-order array".into(),
            wanted: "C order",
        });
    }
    let kind = match header.dtype() {
        DType::Plain(kind) => (kind.type_char(), kind.size_field()),
        _ => {
            return Err(DecodeError::Unsuitable {
                found: "a structured array".into(),
                wanted: "plain numbers",
            });
        }
    };
    let expected =
        width * height * channels.unwrap_or(1) * usize::try_from(kind.1).unwrap_or(usize::MAX).min(16);
    let present = bytes.len().saturating_sub(header_bytes);
    if present < expected {
        return Err(damaged(format!(
            "{present} bytes of data where {expected} are announced"
        )));
    }
    let file = NpyFile::new(bytes).map_err(damaged)?;
    let values = match kind {
        (TypeChar::Float, 4) => Values::Floats(file.into_vec::<f32>().map_err(damaged)?),
        (TypeChar::Float, 8) => {
            let data = file.into_vec::<f64>().map_err(damaged)?;
            Values::Floats(data.into_iter().map(|value| value as f32).collect())
        }
        (TypeChar::Uint, 1) => {
            let data = file.into_vec::<u8>().map_err(damaged)?;
            Values::Codes(data.into_iter().map(u16::from).collect())
        }
        (TypeChar::Uint, 2) => Values::Codes(file.into_vec::<u16>().map_err(damaged)?),
        (kind, size) => {
            let found = format!("{kind:?} values of {size} bytes");
            return Err(DecodeError::Unsuitable {
                found,
                wanted: "float32, float64, uint8 or uint16",
            });
        }
    };
    Ok(Array {
        width,
        height,
        channels,
        values,
    })
}

/// An NPY file of shape [height, width, 3], f32, little endian.
#[must_use]
pub fn encode_npy_rgb(picture: &Rgb<f32>) -> Vec<u8> {
    let [r, g, b] = picture.planes().each_ref().map(Plane::data);
    let values = r.iter().zip(g).zip(b).flat_map(|((&r, &g), &b)| [r, g, b]);
    encode(
        &format!("({}, {}, 3)", picture.height(), picture.width()),
        values,
        3 * r.len(),
    )
}

/// An NPY file of shape [height, width], f32, little endian.
#[must_use]
pub fn encode_npy_plane(plane: &Plane<f32>) -> Vec<u8> {
    encode(
        &format!("({}, {})", plane.height(), plane.width()),
        plane.data().iter().copied(),
        plane.data().len(),
    )
}

fn encode(shape: &str, values: impl Iterator<Item = f32>, count: usize) -> Vec<u8> {
    const PREFIX_BYTES: usize = 10;
    let mut header = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': {shape}, }}");
    // The data begins at a multiple of 64 bytes, and the header ends with a line feed.
    while !(PREFIX_BYTES + header.len() + 1).is_multiple_of(64) {
        header.push(' ');
    }
    header.push('\n');
    let mut file = Vec::with_capacity(PREFIX_BYTES + header.len() + 4 * count);
    file.extend_from_slice(MAGIC);
    file.extend_from_slice(&[1, 0]);
    file.extend_from_slice(&(header.len() as u16).to_le_bytes());
    file.extend_from_slice(header.as_bytes());
    values.for_each(|value| file.extend_from_slice(&value.to_le_bytes()));
    file
}
