//! NumPy's array files (NPY 1.0 to 3.0) of two or three dimensions, C order.

use npyz::{DType, NpyFile, NpyHeader, Order, TypeChar, TypeStr};

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
const MAX_HEADER_BYTES: usize = 4096;

pub(super) fn is_npy(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

fn damaged(reason: impl ToString) -> DecodeError {
    DecodeError::Damaged {
        format: "NPY",
        reason: reason.to_string(),
    }
}

fn unsuitable(found: impl Into<String>, wanted: &'static str) -> DecodeError {
    DecodeError::Unsuitable {
        found: found.into(),
        wanted,
    }
}

/// Decodes an array of f32, f64, u8 or u16, either byte order.
pub(super) fn decode(bytes: &[u8]) -> Result<Array, DecodeError> {
    let data_from = checked_header(bytes)?;
    let header = NpyHeader::from_reader(bytes).map_err(damaged)?;
    let (height, width, channels) = match *header.shape() {
        [height, width] => (height, width, None),
        [height, width, channels @ 1..=4] => (height, width, Some(channels as usize)),
        _ => {
            let found = format!("an array of shape {:?}", header.shape());
            return Err(unsuitable(found, "shape [height, width] or [height, width, 3]"));
        }
    };
    let side = |length: u64| usize::try_from(length).unwrap_or(usize::MAX);
    let (width, height) = (side(width), side(height));
    check_size(width, height)?;
    if header.order() != Order::C {
        return Err(unsuitable("an array in Fortran order", "C order"));
    }
    let DType::Plain(kind) = header.dtype() else {
        return Err(unsuitable("a structured array", "plain numbers"));
    };
    let count = width * height * channels.unwrap_or(1);
    let values = values(bytes, &kind, count, bytes.len() - data_from)?;
    Ok(Array {
        width,
        height,
        channels,
        values,
    })
}

/// Checks the header as far as its parser has to be kept from harm, and answers where the data begins.
fn checked_header(bytes: &[u8]) -> Result<usize, DecodeError> {
    let (prefix_bytes, header_bytes) = match bytes {
        [_, _, _, _, _, _, 1, _, low, high, ..] => (10, usize::from(u16::from_le_bytes([*low, *high]))),
        [_, _, _, _, _, _, 2 | 3, _, a, b, c, d, ..] => (12, u32::from_le_bytes([*a, *b, *c, *d]) as usize),
        _ => return Err(damaged("it has no header")),
    };
    if header_bytes > MAX_HEADER_BYTES {
        let found = format!("a header of {header_bytes} bytes");
        return Err(unsuitable(found, "one of at most 4096"));
    }
    let data_from = prefix_bytes + header_bytes;
    match bytes.get(prefix_bytes..data_from) {
        None => Err(damaged("its header is cut off")),
        Some(header) if is_nested(header) => Err(unsuitable("a structured array", "plain numbers")),
        Some(_) => Ok(data_from),
    }
}

/// Whether a header holds more than one dictionary with one tuple in it, which is all that an array of numbers needs.
/// The parser behind `npyz` tries every nested bracket twice: twenty levels take it seconds, two hundred for ever.
fn is_nested(header: &[u8]) -> bool {
    let count = |bracket: u8| header.iter().filter(|&&byte| byte == bracket).count();
    count(b'[') > 0 || count(b'(') > 1 || count(b'{') > 1
}

fn values(bytes: &[u8], kind: &TypeStr, count: usize, present: usize) -> Result<Values, DecodeError> {
    let value_bytes = match (kind.type_char(), kind.size_field()) {
        (TypeChar::Float, size @ (4 | 8)) | (TypeChar::Uint, size @ (1 | 2)) => size as usize,
        _ => {
            let found = format!("values of type {kind}");
            return Err(unsuitable(found, "float32, float64, uint8 or uint16"));
        }
    };
    let expected = count * value_bytes;
    if present < expected {
        return Err(damaged(format!(
            "it has {present} bytes of data where its header announces {expected}"
        )));
    }
    let file = NpyFile::new(bytes).map_err(damaged)?;
    let values = match (kind.type_char(), value_bytes) {
        (TypeChar::Float, 4) => file.into_vec().map(Values::Floats),
        (TypeChar::Float, _) => {
            let narrow = |data: Vec<f64>| data.into_iter().map(|value| value as f32).collect();
            file.into_vec().map(|data| Values::Floats(narrow(data)))
        }
        (_, 1) => {
            let wide = |data: Vec<u8>| data.into_iter().map(u16::from).collect();
            file.into_vec().map(|data| Values::Codes(wide(data)))
        }
        (_, _) => file.into_vec().map(Values::Codes),
    };
    values.map_err(damaged)
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
